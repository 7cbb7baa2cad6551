"""Options: settings of the algorithm, set and shown, and one number that is both ends of a range."""

from pathlib import Path

import pytest
from terminal import Answer, Begin, done

import sarah
from sarah.cli.episode_options import EpisodeOptions
from sarah.cli.options import parse_options
from sarah.cli.train import TrainOptions
from sarah.episode.settings import EpisodeConfig
from sarah.errors import ConfigurationError
from sarah.runs.agent_settings import NAFSettings, TD3Settings
from sarah.runs.config import TrainingConfig
from sarah.runs.config_files import read_config, settings_by_key, write_config
from sarah.runs.run_folder import RunFolder


def test_options_set_the_agent_and_a_file_repeats_it(begun: Begin) -> None:
    config = begun("sarah-train --agent.preset paper --agent.mu-layers 8 --agent.learning-rate 1e-4")
    assert config.agent == NAFSettings(preset="paper", mu_layers=(8,), learning_rate=1e-4)
    config = begun("sarah-train --algo td3 --agent.layers 8 8 --agent.learning-starts 8")
    assert config.agent == TD3Settings(layers=(8, 8), learning_starts=8)
    write_config(config, Path("td3.yaml"))
    assert begun("sarah-train --config td3.yaml") == config
    again = begun("sarah-train --config td3.yaml --agent.gradient-steps 9").agent
    assert again == TD3Settings(layers=(8, 8), learning_starts=8, gradient_steps=9)


def test_the_command_line_changes_the_file(begun: Begin) -> None:
    Path("mine.yaml").write_text("agent: {tau: 0.1, v_layers: [4], preset: paper, l_layers: [4]}")
    same = begun("sarah-train --config mine.yaml --agent.preset paper --agent.l-layers 5").agent
    assert same == NAFSettings(preset="paper", tau=0.1, v_layers=(4,), l_layers=(5,))
    assert begun("sarah-train --config mine.yaml --agent.preset one-step").agent == NAFSettings(tau=0.1)
    assert begun("sarah-train --config mine.yaml --algo td3").agent == TD3Settings()


HELP = {
    "--help": (("--agent.elite-share", "(0 to 1; default: ", "{one-step,noisy,paper}"), "--agent.layers"),
    "--algo td3 --help": (("--agent.layers", "--agent.policy-delay"), "--agent.elite-share"),
    "--algo=cma-es --help": (("--agent.population",), "--agent.learning-rate"),
    "--algo random --help": (("--episode.time-limit",), "--agent."),
}


@pytest.mark.parametrize("arguments", HELP)
def test_the_help_shows_the_settings_of_the_algorithm(arguments: str, tmp_path: Path) -> None:
    shown, hidden = HELP[arguments]
    process = done("sarah-train", *arguments.split(), cwd=tmp_path)
    assert all(text in process.stdout for text in shown) and hidden not in process.stdout


REFUSED = {
    "--algo naf": "algo is 'random' in this training, not 'naf': leave it out",
    "--task balance": "task is 'stepping' in this training, not 'balance': leave it out",
    "--slots 2": "slots is 4 in this training, not 2: leave it out",
    "--engine mujoco": "not 'mujoco'",
    "--episode.time-limit 9": "episode.time_limit is 30.0 in this",
    "--out x": "leave --out, --config and --from out",
    "--episodes 200": "it can be extended once it is finished: leave --episodes out",
}


def test_a_run_is_not_resumed_with_other_settings(answer: Answer, tmp_path: Path) -> None:
    RunFolder.create(tmp_path / "mine", TrainingConfig(algo="random", episode=EpisodeConfig(engine="pybullet")))
    for options, message in REFUSED.items():
        assert message in answer(f"sarah-train --resume mine {options}")


PUSHED = EpisodeOptions(episode=sarah.PushedConfig())


RANGES: dict[str, dict[str, list[float]]] = {
    "--episode.push.newtons 80": {"push.newtons": [80.0, 80.0]},
    "--episode.push.newtons=80": {"push.newtons": [80.0, 80.0]},
    "--episode.push.newtons 1e1 2e1": {"push.newtons": [10.0, 20.0]},
    "--episode.push.newtons 80 --engine pybullet": {"push.newtons": [80.0, 80.0]},
    "--episode.push.at_seconds 3 --episode.push.degrees 0 90": {"push.at_seconds": [3, 3], "push.degrees": [0, 90]},
    "--episode.randomisation.actuator_bandwidth 40": {"randomisation.actuator_bandwidth": [40.0, 40.0]},
    "--episode.terrain.slope-degrees 0 5": {"terrain.slope_degrees": [0.0, 5.0]},
}


@pytest.mark.parametrize("words", RANGES)
def test_one_number_is_a_range_on_the_command_line(words: str) -> None:
    episode = parse_options(EpisodeOptions, "sarah-eval", words.split(), PUSHED).episode
    assert RANGES[words].items() <= settings_by_key(episode).items()
    train = parse_options(TrainOptions, "sarah-train", ["--agent.exploration-std", "0.2"], TrainOptions())
    assert train.training.agent.exploration_std == (0.2, 0.2)  # type: ignore[attr-defined]


def test_in_python_and_in_a_file(tmp_path: Path) -> None:
    assert sarah.Push(newtons=80, degrees=[0, 90]) == sarah.Push((80.0, 80.0), (0.0, 90.0))  # type: ignore[arg-type]
    assert NAFSettings(elite_std=0.2).elite_std == (0.2, 0.2)  # type: ignore[arg-type]
    (tmp_path / "mine.yaml").write_text("task: balance\nepisode: {push: {newtons: 80}, terrain: {slope_degrees: 3}}\n")
    episode = read_config(TrainingConfig, tmp_path / "mine.yaml").episode
    assert episode.push.newtons == (80.0, 80.0)  # type: ignore[attr-defined]
    assert episode.terrain.slope_degrees == (3.0, 3.0)


@pytest.mark.parametrize("newtons", [True, "80", None, (1.0,), [1, 2, 3], {"low": 1}, float("nan")])
def test_what_is_no_range_is_refused(newtons: object) -> None:
    with pytest.raises(ConfigurationError, match=r"push\.newtons must be between 0 and 10000 N"):
        sarah.Push(newtons=newtons)  # type: ignore[arg-type]
