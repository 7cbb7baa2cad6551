"""Settings, those of the algorithms too: what a file may say, and what is answered when it says something else."""

import dataclasses
import inspect
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from sarah import BalanceConfig, ControllerConstants, EpisodeConfig, Push, PyBulletPhysics, SessionSpec
from sarah.errors import ConfigurationError
from sarah.operation.settings import Change, OperationConfig
from sarah.robot.description import describe_robot
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
from sarah.runs.config_files import changed_alike, first_difference, read_config, write_config
from sarah.simulation.engines import default_engine


def read(text: str, folder: Path, kind: Any = TrainingConfig) -> Any:
    path = folder / "mine.yaml"
    path.write_text(text)
    return read_config(kind, path)


def test_what_a_file_does_not_name_keeps_its_default(tmp_path: Path) -> None:
    assert read("", tmp_path) == TrainingConfig()
    config = read("algo: sac\nepisode:\n  time_limit: 10\n", tmp_path)
    assert config == TrainingConfig(algo="sac", episode=EpisodeConfig(time_limit=10.0))
    assert config.episode.engine == default_engine()
    for text, agent in (
        ("agent: {tau: 0.1}", NAFSettings(tau=0.1)),
        ("{agent: {learning_rate: 3e-4, layers: [8]}, algo: td3}", TD3Settings(3e-4, layers=(8,))),
        ("{algo: sac, agent: {ent_coef: auto}}", SACSettings()),
        ("agent: {preset: paper, mu_layers: [4, 4]}", NAFSettings(preset="paper", mu_layers=(4, 4))),
        ("{algo: random, agent: {}}", AgentSettings()),
    ):
        assert read(text, tmp_path).agent == agent


BEFORE_SIZES = (
    "{physics: {rate: 400}, engine: mujoco, randomisation: {mass_deviation: 0.02}, terrain: {roughness: [0.0, 0.0]}, "
    "controller: {pad_threshold: 30.0}, payload: 0.0, dimensions: {thigh_length: 0.2, shank_length: 0.2}, "
    "time_limit: 20.0, reward_form: symmetric}\n"
)
"""Settings of a robot of another size as a version wrote them in which nothing went with the size."""


def test_files_from_before_sizes_keep_their_robot(tmp_path: Path) -> None:
    training = read(f"episode: {BEFORE_SIZES}", tmp_path).episode
    session = read(f"config: {{robot: {BEFORE_SIZES}}}", tmp_path, SessionSpec).config.robot
    for found, usual in ((training, EpisodeConfig()), (session, OperationConfig().robot)):
        assert describe_robot(found.dimensions).efforts == describe_robot().efforts
        drawn = dataclasses.replace(usual.randomisation, mass_deviation=0.02)
        own = dataclasses.replace(usual, engine="mujoco", randomisation=drawn, time_limit=20.0)
        assert found == dataclasses.replace(own, dimensions=found.dimensions)


def test_what_a_task_and_an_engine_have_of_their_own_is_read(tmp_path: Path) -> None:
    config = read(
        "{task: balance, episode: {stepping: [0.1, 0.2, 0.3, 0.4, 0.5], push: {newtons: [50, 60], degrees: [0, 0]}, "
        "engine: pybullet, physics: {added_plate_inertia: 0.001}, controller: {time_out_seconds: 0.3}}}",
        tmp_path,
    )
    assert config.episode == BalanceConfig(
        stepping=(0.1, 0.2, 0.3, 0.4, 0.5),
        push=Push(newtons=(50.0, 60.0), degrees=(0.0, 0.0)),
        engine="pybullet",
        physics=PyBulletPhysics(added_plate_inertia=0.001),
        controller=ControllerConstants(time_out_seconds=0.3),
    )
    write_config(config, tmp_path / "again.yaml")
    assert read_config(TrainingConfig, tmp_path / "again.yaml") == config
    assert "added_plate_inertia" in (tmp_path / "again.yaml").read_text()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("episods: 5", "unknown key 'episods', did you mean 'episodes'"),
        ("episode: {physics: {raet: 500}}", "unknown key 'episode.physics.raet', did you mean 'episode.physics.rate'"),
        ("episodes: many", "episodes must be a whole number, not 'many'"),
        ("task: walking", "unknown task 'walking'"),
        ("episode: {randomisation: {enabled: off}}", "enabled must be true or false, not 'off'"),
        ("task: [balance]", "task must be a text, not ['balance']"),
        ("algo: 3", "algo must be a text, not 3"),
        ("episode: 5", "episode must hold keys and values, not 5"),
        ("[1, 2]", "the file must hold keys and values"),
        ("episode: {time_limit: 1}", "time_limit must be above the 1 s of standing, not 1.0"),
        ("episode: {engine: mujco}", "engine 'mujco', did you mean 'mujoco'?"),
        ("episode: {reward_form: printd}", "unknown episode.reward_form 'printd', did you mean 'printed'"),
        ("episode: {physics: {rate: 333}}", "must be a multiple of the control rate, 100 Hz, such as 400, not 333"),
        ("episode: {randomisation: {friction: [0.9]}}", "must be one number, or a list of 2 for a range, not [0.9]"),
        ("episode: {randomisation: {friction: [1.0, 0.7]}}", "friction must be between 0 and 5 and in rising order"),
        ("episode: {dimensions: [0.3]}", "dimensions must hold names and values"),
        ("episode: {dimensions: {thigh_length: long}}", "dimensions.thigh_length must be a number, not 'long'"),
        ("episode: {push: {newtons: [50, 60]}}", "episode.push is for task balance"),
        ("task: stepping\nepisode: {stepping: [1, 1, 1, 1, 1]}", "episode.stepping is for task balance"),
        ("episode: {engine: mujoco, physics: {added_plate_inertia: 1}}", "unknown key 'episode.physics.added_plate_in"),
        ("{task: balance, episode: {time_limit: 3, push: {at_seconds: [3, 4]}}}", "before the time_limit of 3 s"),
        ("a: [", "is not YAML"),
        ("agent: {learning_rat: 1}", "unknown key 'agent.learning_rat', did you mean 'agent.learning_rate'"),
        ("{algo: td3, agent: {elite_share: 1}}", "unknown key 'agent.elite_share'"),
        ("{algo: gp, agent: {layers: [1]}}", "unknown key 'agent.layers' (allowed: none)"),
        ("{algo: td4, agent: {layers: [1]}}", "unknown algo 'td4', did you mean 'td3'?"),
        ("agent: 5", "agent must hold keys and values, not 5"),
        ("agent: {v_layers: 5}", "agent.v_layers must be a list, not 5"),
        ("agent: {preset: papr}", "unknown agent.preset 'papr', did you mean 'paper'? (allowed: noisy, one-step,"),
        ("agent: {activation: tan}", "unknown agent.activation 'tan', did you mean 'tanh'?"),
        ("agent: {device: gpu}", "agent.device must be 'cpu', 'cuda', 'cuda:' and a number, or 'auto', not 'gpu'"),
        ("{algo: sac, agent: {ent_coef: aut}}", "unknown agent.ent_coef 'aut', did you mean 'auto'?"),
        ("{algo: sac, agent: {ent_coef: -1}}", "agent.ent_coef must be between 0 and 100, not -1.0"),
    ],
)
def test_mistakes_are_named_in_one_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(ConfigurationError) as caught:
        read(text, tmp_path)
    assert message in str(caught.value) and "mine.yaml" in str(caught.value) and "\n" not in str(caught.value)
    with pytest.raises(ConfigurationError, match=r"cannot read .*nothing.yaml: No such file"):
        read_config(TrainingConfig, tmp_path / "nothing.yaml")


def test_changes_of_one_are_made_alike_in_another() -> None:
    before, replace = EpisodeConfig(), dataclasses.replace
    after = replace(before, payload=3.0, physics=replace(before.physics, rate=800))
    other = replace(before, time_limit=9.0, physics=replace(before.physics, solver_iterations=9))
    changed = changed_alike(other, before, after)
    assert changed == replace(other, payload=3.0, physics=replace(other.physics, rate=800))
    with pytest.raises(dataclasses.FrozenInstanceError):
        changed.payload = 0.0  # type: ignore[misc]


def test_settings_from_python_are_checked_as_those_of_a_file() -> None:
    training, change, session, naf = (cast(Any, k) for k in (TrainingConfig, Change, SessionSpec, NAFSettings))
    for make, words in (
        (lambda: training(episodes=10.5), "episodes must be a whole number, not 10.5"),
        (lambda: naf(mu_layers=16), "agent.mu_layers must be a list, not 16"),
        (lambda: change("x", {}), "change.minute must be a number, not 'x'"),
        (lambda: session(seed=1.5), "seed must be a whole number, not 1.5"),
    ):
        with pytest.raises(ConfigurationError, match=words):
            make()
    config = training(episodes=np.int64(30), agent=naf(learning_rate=np.float32(0.5)))
    assert type(config.episodes) is int and type(config.agent.learning_rate) is float


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
