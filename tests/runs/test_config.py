"""Settings: what a file may say, and what is answered when it says something else."""

import dataclasses
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from sarah.control.constants import ControllerConstants
from sarah.episode.push import Push
from sarah.episode.settings import EpisodeConfig
from sarah.episode.tasks import BalanceConfig
from sarah.errors import ConfigurationError
from sarah.operation.settings import Change, OperationConfig
from sarah.robot.description import describe_robot
from sarah.runs.agent_settings import NAFSettings
from sarah.runs.config import TrainingConfig
from sarah.runs.config_files import changed_alike, read_config, write_config
from sarah.runs.session import SessionSpec
from sarah.simulation.engines import default_engine
from sarah.simulation.physics import PyBulletPhysics


def test_what_a_file_does_not_name_keeps_its_default(tmp_path: Path) -> None:
    path = tmp_path / "config.yaml"
    path.write_text("algo: sac\nepisode:\n  time_limit: 10\n")
    config = read_config(TrainingConfig, path)
    assert config == TrainingConfig(algo="sac", episode=EpisodeConfig(time_limit=10.0))
    assert config.episode.engine == default_engine()
    path.write_text("")
    assert read_config(TrainingConfig, path) == TrainingConfig()


BEFORE_SIZES = (
    "{physics: {rate: 400}, engine: mujoco, randomisation: {mass_deviation: 0.02}, terrain: {roughness: [0.0, 0.0]}, "
    "controller: {pad_threshold: 30.0}, payload: 0.0, dimensions: {thigh_length: 0.2, shank_length: 0.2}, "
    "time_limit: 20.0, reward_form: symmetric}\n"
)
"""Settings of a robot of another size as a version wrote them in which nothing went with the size."""


def test_files_from_before_sizes_keep_their_robot(tmp_path: Path) -> None:
    path = tmp_path / "config.yaml"
    path.write_text(f"episode: {BEFORE_SIZES}")
    training = read_config(TrainingConfig, path).episode
    path.write_text(f"config: {{robot: {BEFORE_SIZES}}}")
    session = read_config(SessionSpec, path).config.robot
    for read, usual in ((training, EpisodeConfig()), (session, OperationConfig().robot)):
        assert describe_robot(read.dimensions).efforts == describe_robot().efforts
        drawn = dataclasses.replace(usual.randomisation, mass_deviation=0.02)
        own = dataclasses.replace(usual, engine="mujoco", randomisation=drawn, time_limit=20.0)
        assert read == dataclasses.replace(own, dimensions=read.dimensions)


def test_what_a_task_and_an_engine_have_of_their_own_is_read(tmp_path: Path) -> None:
    path = tmp_path / "config.yaml"
    path.write_text(
        "{task: balance, episode: {stepping: [0.1, 0.2, 0.3, 0.4, 0.5], push: {newtons: [50, 60], degrees: [0, 0]}, "
        "engine: pybullet, physics: {added_plate_inertia: 0.001}, controller: {time_out_seconds: 0.3}}}"
    )
    assert read_config(TrainingConfig, path).episode == BalanceConfig(
        stepping=(0.1, 0.2, 0.3, 0.4, 0.5),
        push=Push(newtons=(50.0, 60.0), degrees=(0.0, 0.0)),
        engine="pybullet",
        physics=PyBulletPhysics(added_plate_inertia=0.001),
        controller=ControllerConstants(time_out_seconds=0.3),
    )
    write_config(read_config(TrainingConfig, path), tmp_path / "again.yaml")
    assert read_config(TrainingConfig, tmp_path / "again.yaml") == read_config(TrainingConfig, path)
    assert "added_plate_inertia" in (tmp_path / "again.yaml").read_text()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("episods: 5", "unknown key 'episods', did you mean 'episodes'"),
        ("episode: {physics: {raet: 500}}", "unknown key 'episode.physics.raet', did you mean 'episode.physics.rate'"),
        ("episodes: many", "episodes must be a whole number, not 'many'"),
        ("episodes: 0", "episodes must be between 1 and 1000000, not 0"),
        ("seed: -1", "seed must be between 0 and 2147483647, not -1"),
        ("slots: 0", "slots must be between 1 and 10000, not 0"),
        ("task: walking", "unknown task 'walking'"),
        ("episode: {time_limit: 1:30}", "episode.time_limit must be a number, not '1:30'"),
        ("episode: {randomisation: {enabled: off}}", "enabled must be true or false, not 'off'"),
        ("task: [balance]", "task must be a text, not ['balance']"),
        ("algo: td33", "unknown algo 'td33', did you mean 'td3'"),
        ("algo: 3", "algo must be a text, not 3"),
        ("episode: 5", "episode must hold keys and values, not 5"),
        ("[1, 2]", "the file must hold keys and values"),
        ("episode: {time_limit: .inf}", "time_limit must be a number, not '.inf'"),
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
    ],
)
def test_mistakes_are_named_in_one_line(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(text)
    with pytest.raises(ConfigurationError) as caught:
        read_config(TrainingConfig, path)
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
    """And may be numbers of numpy."""
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
