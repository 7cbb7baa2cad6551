"""One number is both ends of a range, wherever ranges are given."""

from pathlib import Path

import pytest

import sarah
from sarah.cli.episode_options import EpisodeOptions
from sarah.cli.options import parse_options
from sarah.cli.train import TrainOptions
from sarah.errors import ConfigurationError
from sarah.runs.agent_settings import NAFSettings
from sarah.runs.config import TrainingConfig
from sarah.runs.config_files import read_config
from sarah.simulation.randomisation import Randomisation

PUSHED = EpisodeOptions(episode=sarah.PushedConfig())


@pytest.mark.parametrize(
    ("words", "ends"),
    [
        ("--episode.push.newtons 80", (80.0, 80.0)),
        ("--episode.push.newtons=80", (80.0, 80.0)),
        ("--episode.push.newtons 75 125", (75.0, 125.0)),
        ("--episode.push.newtons 80 --episode.push.degrees 0 90", (80.0, 80.0)),
        ("--episode.push.newtons 80 --engine pybullet", (80.0, 80.0)),
        ("--episode.push.newtons 1e1 2e1", (10.0, 20.0)),
    ],
)
def test_on_the_command_line(words: str, ends: tuple[float, float]) -> None:
    options = parse_options(EpisodeOptions, "sarah-eval", words.split(), PUSHED)
    assert options.episode.push.newtons == ends  # type: ignore[attr-defined]


def test_with_underscores_and_deep_within() -> None:
    words = ["--episode.push.at_seconds", "3", "--episode.randomisation.actuator_bandwidth", "40"]
    episode = parse_options(EpisodeOptions, "sarah-eval", words, PUSHED).episode
    assert episode.push.at_seconds == (3.0, 3.0)  # type: ignore[attr-defined]
    assert episode.randomisation.actuator_bandwidth == (40.0, 40.0)
    words = ["--episode.terrain.slope-degrees", "0", "5", "--episode.terrain.direction-degrees", "90"]
    terrain = parse_options(EpisodeOptions, "sarah-eval", words, PUSHED).episode.terrain
    assert terrain == sarah.Terrain(slope_degrees=(0.0, 5.0), direction_degrees=(90.0, 90.0))
    train = parse_options(TrainOptions, "sarah-train", ["--agent.exploration-std", "0.2"], TrainOptions())
    assert train.training.agent.exploration_std == (0.2, 0.2)  # type: ignore[attr-defined]


def test_in_python_and_in_a_file(tmp_path: Path) -> None:
    assert sarah.Push(newtons=80, degrees=[0, 90]) == sarah.Push((80.0, 80.0), (0.0, 90.0))  # type: ignore[arg-type]
    assert Randomisation(friction=0.8).friction == (0.8, 0.8)
    assert NAFSettings(elite_std=0.2).elite_std == (0.2, 0.2)  # type: ignore[arg-type]
    path = tmp_path / "mine.yaml"
    path.write_text(
        "task: balance\nepisode: {push: {newtons: 80}, randomisation: {friction: 0.8}, terrain: {slope_degrees: 3}}\n"
    )
    episode = read_config(TrainingConfig, path).episode
    assert episode.push.newtons == (80.0, 80.0) and episode.randomisation.friction == (0.8, 0.8)  # type: ignore[attr-defined]
    assert episode.terrain.slope_degrees == (3.0, 3.0)


@pytest.mark.parametrize("newtons", [True, "80", None, (1.0,), [1, 2, 3], {"low": 1}, float("nan")])
def test_what_is_no_range_is_refused(newtons: object) -> None:
    with pytest.raises(ConfigurationError, match=r"push\.newtons must be between 0 and 10000 N"):
        sarah.Push(newtons=newtons)  # type: ignore[arg-type]
