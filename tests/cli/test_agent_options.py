"""Settings of the algorithm on the command line: set and shown."""

from collections.abc import Callable
from pathlib import Path

import pytest
from terminal import run

from sarah.episode.settings import EpisodeConfig
from sarah.runs.agent_settings import NAFSettings, TD3Settings
from sarah.runs.config import TrainingConfig
from sarah.runs.config_files import write_config
from sarah.runs.run_folder import RunFolder


def test_options_set_the_agent_and_a_file_repeats_it(begun: Callable[[str], TrainingConfig]) -> None:
    config = begun("sarah-train --agent.preset paper --agent.mu-layers 8 --agent.learning-rate 1e-4")
    assert config.agent == NAFSettings(preset="paper", mu_layers=(8,), learning_rate=1e-4)
    config = begun("sarah-train --algo td3 --agent.layers 8 8 --agent.learning-starts 8")
    assert config.agent == TD3Settings(layers=(8, 8), learning_starts=8)
    write_config(config, Path("td3.yaml"))
    assert begun("sarah-train --config td3.yaml") == config
    again = begun("sarah-train --config td3.yaml --agent.gradient-steps 9").agent
    assert again == TD3Settings(layers=(8, 8), learning_starts=8, gradient_steps=9)


def test_the_command_line_changes_the_file(begun: Callable[[str], TrainingConfig]) -> None:
    Path("mine.yaml").write_text("agent: {tau: 0.1, v_layers: [4], preset: paper, l_layers: [4]}")
    same = begun("sarah-train --config mine.yaml --agent.preset paper --agent.l-layers 5").agent
    assert same == NAFSettings(preset="paper", tau=0.1, v_layers=(4,), l_layers=(5,))
    assert begun("sarah-train --config mine.yaml --agent.preset one-step").agent == NAFSettings(tau=0.1)
    assert begun("sarah-train --config mine.yaml --algo td3").agent == TD3Settings()


@pytest.mark.parametrize(
    ("arguments", "shown", "hidden"),
    [
        ("--help", ("--agent.elite-share", "(0 to 1; default: ", "{one-step,paper}"), "--agent.layers"),
        ("--algo td3 --help", ("--agent.layers", "--agent.policy-delay"), "--agent.elite-share"),
        ("--algo=cma-es --help", ("--agent.population",), "--agent.learning-rate"),
        ("--algo random --help", ("--episode.time-limit",), "--agent."),
    ],
)
def test_the_help_shows_the_settings_of_the_algorithm(
    arguments: str, shown: tuple[str, ...], hidden: str, tmp_path: Path
) -> None:
    process = run("sarah-train", *arguments.split(), cwd=tmp_path)
    assert process.returncode == 0
    assert all(text in process.stdout for text in shown) and hidden not in process.stdout


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("--algo naf", "algo is 'random' in this training, not 'naf': leave it out"),
        ("--task balance", "task is 'stepping' in this training, not 'balance': leave it out"),
        ("--slots 2", "slots is 4 in this training, not 2: leave it out"),
        ("--engine mujoco", "not 'mujoco'"),
        ("--episode.engine mujoco", "not 'mujoco'"),
        ("--episode.time-limit 9", "episode.time_limit is 30.0 in this"),
        ("--out x", "leave --out, --config and --from out"),
        ("--episodes 200", "it can be extended once it is finished: leave --episodes out"),
    ],
)
def test_a_run_is_not_resumed_with_other_settings(
    options: str, message: str, answer: Callable[[str], str], tmp_path: Path
) -> None:
    RunFolder.create(tmp_path / "mine", TrainingConfig(algo="random", episode=EpisodeConfig(engine="pybullet")))
    assert message in answer(f"sarah-train --resume mine {options}")
