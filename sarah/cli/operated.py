"""What a robot in operation has of the run folder, the session or the shipped parameters that it begins with."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro

from sarah.episode.push import Push, PushedConfig
from sarah.episode.reward import RewardForm, equation_2
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.operation.settings import SOFT_PUSHES
from sarah.runs.kinds import SESSION


@dataclass(frozen=True)
class RegularPush(Push):
    """A push whose time is not drawn, and no option."""

    at_seconds: Annotated[tuple[float, float], tyro.conf.Suppress] = Push.at_seconds


@dataclass(frozen=True)
class OperatedConfig(PushedConfig):
    """Settings whose options leave out what has no effect in an operation."""

    time_limit: Annotated[float, tyro.conf.Suppress] = PushedConfig.time_limit
    reward_form: Annotated[RewardForm, tyro.conf.Suppress] = PushedConfig.reward_form

    def as_pushed(self) -> PushedConfig:
        """The same settings, as a session holds them."""
        return PushedConfig(**{**vars(self), "push": Push(**vars(self.push))})


def settings_in_operation(config: EpisodeConfig, subject: str | None) -> OperatedConfig:
    """Settings of a robot in operation: those of the subject, with soft pushes, unless they are a session's own.

    :param config: settings of the subject's episodes
    :param subject: what the robot begins with
    """
    shared = {item.name: getattr(config, item.name) for item in dataclasses.fields(EpisodeConfig)}
    is_own = subject is not None and SESSION.owns(Path(subject))
    push = config.push if is_own and isinstance(config, PushedConfig) else config.scale.scaled(SOFT_PUSHES)
    return OperatedConfig(**shared, push=RegularPush(**vars(push)))


def times_of_session(path: Path) -> dict[str, Any]:
    """Times of windows, falls and pushes of a session, by the names of the options.

    :param path: folder of the session
    """
    from sarah.runs.session_folder import SessionFolder

    config = SessionFolder.open(path).spec().config
    names = ("settle_seconds", "measure_seconds", "fall_seconds", "push_seconds")
    return {name: getattr(config, name) for name in names}


def say_differences(name: str, subject: EpisodeSpec, robot: PushedConfig) -> None:
    """Print what a robot in operation does not have of its subject.

    :param name: what the robot begins with, as it was given
    :param subject: episode of it
    :param robot: settings of the robot in operation
    """
    from sarah.runs.episode_words import differences

    symmetric = dataclasses.replace(robot, reward_form="symmetric")  # whatever they say, which has no effect
    changes = list(differences(symmetric, subject.config))
    if subject.task.reward is not equation_2:
        changes.append(f"the reward of equation 2 instead of that of task {subject.task.name}")
    if changes:
        print(f"robot of {name}: all settings of its episodes, but", *changes, sep="\n  ", flush=True)
