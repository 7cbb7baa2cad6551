"""Settings of the algorithms: presets, what is refused, and how files name them."""

import dataclasses
import inspect
from pathlib import Path
from typing import Any

import pytest

from sarah.errors import ConfigurationError
from sarah.runs.agent_settings import (
    AGENT_SETTINGS,
    PRESETS,
    AgentSettings,
    EvolutionSettings,
    NAFSettings,
    SACSettings,
    TD3Settings,
    settings_of,
)
from sarah.runs.config import ALGORITHMS, TrainingConfig
from sarah.runs.config_files import first_difference, read_config, write_config


def test_every_algorithm_has_settings() -> None:
    for algo in ALGORITHMS:
        assert TrainingConfig(algo=algo).agent == settings_of(algo)()


def test_a_preset_is_a_source_of_defaults() -> None:
    paper = NAFSettings(preset="paper", l_layers=(40,))
    assert (paper.v_layers, paper.l_layers, paper.activation, paper.squash_mu) == ((256,) * 3, (40,), "sigmoid", False)
    assert (paper.temperature, paper.elite_share, paper.min_curvature) == (0.0, 0.0, 0.0)
    rest = {item.name for item in dataclasses.fields(NAFSettings)} - set(PRESETS["paper"]) - {"preset"}
    assert all(getattr(paper, name) == getattr(NAFSettings(), name) for name in rest)
    assert set(PRESETS["paper"]) == set(PRESETS["one-step"]) == set(PRESETS["noisy"])
    # Another one leaves what it does not decide
    changed = NAFSettings(learning_rate=1e-4, mu_layers=(8,)).with_preset("paper")
    assert changed == NAFSettings(preset="paper", learning_rate=1e-4)
    assert dataclasses.replace(changed, l_layers=(3,)) == NAFSettings(preset="paper", learning_rate=1e-4, l_layers=(3,))


def test_settings_of_another_algorithm_are_refused() -> None:
    for algo, agent, own in (("naf", TD3Settings(), "NAFSettings"), ("gp", EvolutionSettings(), "AgentSettings")):
        words = f"agent must be the {own} of algo '{algo}', not {type(agent).__name__}"
        with pytest.raises(ConfigurationError, match=words):
            TrainingConfig(algo=algo, agent=agent)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"preset": "papr"}, "unknown agent.preset 'papr', did you mean 'paper'? (allowed: noisy, one-step, paper)"),
        ({"activation": "tan"}, "unknown agent.activation 'tan', did you mean 'tanh'?"),
        ({"device": "gpu"}, "agent.device must be 'cpu', 'cuda', 'cuda:' and a number, or 'auto', not 'gpu'"),
    ],
)
def test_unknown_names_are_refused(settings: dict[str, Any], message: str) -> None:
    with pytest.raises(ConfigurationError) as caught:
        NAFSettings(**settings)
    assert str(caught.value).startswith(message)


@pytest.mark.parametrize(
    ("algo", "settings"),
    [
        ("naf", {"preset": "paper", "exploration_std": (0.1, 0.4), "shared_layers": (5, 6, 7), "device": "cuda:1"}),
        ("naf", {"v_layers": (), "learning_rate": 1e-9}),
        ("sac", {"ent_coef": 0.1}),
    ],
)
def test_a_file_gives_them_back(algo: str, settings: dict[str, Any], tmp_path: Path) -> None:
    config = TrainingConfig(algo=algo, agent=settings_of(algo)(**settings))
    write_config(config, tmp_path / "config.yaml")
    assert read_config(TrainingConfig, tmp_path / "config.yaml") == config


def read(text: str, folder: Path) -> AgentSettings:
    path = folder / "mine.yaml"
    path.write_text(text)
    return read_config(TrainingConfig, path).agent


def test_what_a_file_does_not_name_is_its_algorithms_default(tmp_path: Path) -> None:
    assert read("agent: {tau: 0.1}", tmp_path) == NAFSettings(tau=0.1)
    assert read("{agent: {learning_rate: 3e-4, layers: [8]}, algo: td3}", tmp_path) == TD3Settings(3e-4, layers=(8,))
    assert read("{algo: sac, agent: {ent_coef: auto}}", tmp_path) == SACSettings()
    assert read("agent: {preset: paper, mu_layers: [4, 4]}", tmp_path) == NAFSettings(preset="paper", mu_layers=(4, 4))
    assert read("{algo: random, agent: {}}", tmp_path) == AgentSettings()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("agent: {learning_rat: 1}", "unknown key 'agent.learning_rat', did you mean 'agent.learning_rate'"),
        ("{algo: td3, agent: {elite_share: 1}}", "unknown key 'agent.elite_share'"),
        ("{algo: gp, agent: {layers: [1]}}", "unknown key 'agent.layers' (allowed: none)"),
        ("{algo: td4, agent: {layers: [1]}}", "unknown algo 'td4', did you mean 'td3'?"),
        ("agent: 5", "agent must hold keys and values, not 5"),
        ("agent: {v_layers: 5}", "agent.v_layers must be a list, not 5"),
        ("agent: {learning_rate: 3e9}", "agent.learning_rate must be between 1e-09 and 1, not 3000000000.0"),
        ("{algo: sac, agent: {ent_coef: aut}}", "unknown agent.ent_coef 'aut', did you mean 'auto'?"),
        ("{algo: sac, agent: {ent_coef: -1}}", "agent.ent_coef must be between 0 and 100, not -1.0"),
    ],
)
def test_mistakes_in_a_file_are_named_in_one_line(text: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError) as caught:
        read(text, tmp_path)
    assert message in str(caught.value) and "\n" not in str(caught.value)


def test_the_first_difference_is_found_in_them() -> None:
    config = TrainingConfig()
    other = dataclasses.replace(config, agent=NAFSettings(tau=0.5))
    assert first_difference(config, other) == ("agent.tau", 0.02, 0.5)
    assert first_difference(config, TrainingConfig(algo="sac")) == ("algo", "naf", "sac")


def test_every_setting_has_its_help() -> None:
    for settings in {*AGENT_SETTINGS.values()}:
        documented = " ".join(inspect.getdoc(kind) or "" for kind in settings.__mro__)
        for item in dataclasses.fields(settings):
            assert f":param {item.name}: " in documented
