"""Settings that ``sarah-train`` is given as a file of ``--config``, and as a run folder of ``--from``."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sarah.cli.episode_options import for_given_robot, given_dimensions
from sarah.cli.training_defaults import BALANCE_TRAINING
from sarah.episode.tasks import BALANCE, STEPPING, BalanceConfig, Task
from sarah.errors import ConfigurationError
from sarah.runs.config import TrainingConfig
from sarah.runs.config_files import read_config, read_section

if TYPE_CHECKING:
    from sarah.runs.run_folder import RunFolder


def settings_of_file(path: Path, task: Task[Any] | None, arguments: Sequence[str]) -> TrainingConfig:
    """Settings of a file, with its own task unless another one is given.

    :param path: path of the YAML file
    :param task: task of --task
    :param arguments: arguments of the command, whose dimensions come beside those of the file
    """
    dimensions = given_dimensions(arguments)
    if task is None:
        return read_config(TrainingConfig, path, dimensions=dimensions)
    try:
        own = read_config(TrainingConfig, path, task if task.file is not None else None, dimensions)
    except ConfigurationError:  # its own task may be that of another file
        own = read_config(TrainingConfig, path, task, dimensions)
    return dataclasses.replace(own, task=task, episode=task.config_of(own.episode))


def settings_on_stepping(path: Path, file: Path | None, arguments: Sequence[str]) -> BalanceConfig:
    """Settings of a Second Training's episodes: all of a First Training's, with its P1 to P5, and the usual push.

    :param path: path of the First Training's run folder
    :param file: YAML file whose settings go before them
    :param arguments: arguments of the command; the push is for the robot whose dimensions they give
    """
    run = _first_training(path)
    robot = run.config().episode
    usual = BALANCE_TRAINING.episode.for_robot(for_given_robot(robot, arguments).dimensions)
    changes = {name: getattr(usual, name) for name in ("push", "time_limit")}
    episode = BALANCE.config_of(robot, stepping=run.parameters(), **changes)
    return episode if file is None else read_section(episode, file, "episode")


def say_differences(path: Path, episode: BalanceConfig) -> None:
    """Print the settings that a Second Training does not have from a First one.

    :param path: path of the First Training's run folder
    :param episode: settings of the Second Training's episodes
    """
    from sarah.runs.episode_words import differences

    run = _first_training(path)
    changes = list(differences(episode, run.config().episode))
    if episode.stepping != run.parameters():
        here, there = (", ".join(f"{value:g}" for value in values) for values in (episode.stepping, run.parameters()))
        changes.insert(0, f"stepping {here} instead of {there}")
    print(f"from {path}: P1 to P5 and all settings of its episodes, but", *changes, sep="\n  ", flush=True)


def _first_training(path: Path) -> RunFolder:
    from sarah.runs.run_folder import RunFolder

    run = RunFolder.open(path)
    learned = run.config().task
    if learned is not STEPPING:
        raise ConfigurationError(
            f"{path} learned {learned.name!r}, but --from needs the run folder of a training of {STEPPING.name!r}"
        )
    return run
