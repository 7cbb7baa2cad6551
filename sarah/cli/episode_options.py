"""Settings of the episodes of what a command looks at.

``--episode.…`` options begin from the settings of the subject. Which options there are depends on its task and engine,
so the subject is looked up before the options are parsed.
"""

from __future__ import annotations

import argparse
import contextlib
import dataclasses
import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_args

import tyro

from sarah.cli.options import named_task, parse_options, without_dimensions
from sarah.cli.subjects import episode_of, is_there
from sarah.cli.value_rules import named_numbers
from sarah.episode.push import NO_PUSH, PushedConfig
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import FIRST_EVALUATION_SEED, EpisodeSpec
from sarah.episode.tasks import BALANCE, STEPPING, TASKS
from sarah.errors import ConfigurationError, unknown_name
from sarah.ranges import Within, check_ranges
from sarah.runs.recorded_task import RecordedTask, refuse_to_simulate
from sarah.simulation.engines import Engine
from sarah.simulation.physics import PHYSICS, named_physics

SET_TWICE = (
    ("--engine", "--episode.engine"),
    ("--physics", "--episode.physics.rate"),
    ("--physics", "--episode.physics.solver-iterations"),
    ("--physics", "--episode.physics.added-plate-inertia"),
)
"""Short options, each with an option of the episode's settings that it would overrule."""
DIRECTIONS = ("episode.push.degrees", "episode.push.sagittal-share")
"""Options that say where pushes point."""


@dataclass(frozen=True)
class EpisodeOptions:
    """Options of every command that simulates what it looks at.

    :param task: task of the numbers, or of a run folder whose task is that of a file, such as my_task.py:JUMP. By
        default five numbers are P1 to P5, and four are V1 to V4
    :param physics: ``standard``, or ``reference``: 1 kHz and 100 solver iterations; by default as in the training
    :param episode: settings of the episodes; by default those of the run folder, or the task's own
    """

    task: Annotated[str | None, tyro.conf.arg(metavar="TASK")] = None
    physics: Annotated[str | None, tyro.conf.arg(metavar="STR")] = None
    episode: EpisodeConfig = EpisodeConfig()

    def __post_init__(self) -> None:
        """Refuse numbers outside their ranges."""
        check_ranges("", self)

    def applied_to(self, spec: EpisodeSpec) -> EpisodeSpec:
        """Specification of an episode with the settings that the options ask for.

        :param spec: specification of the episode
        :raises ConfigurationError: if there is no such physics, or if the task is that of a file that was not named
        """
        if isinstance(spec.task, RecordedTask):
            refuse_to_simulate(spec.task)
        config = self.episode
        if self.physics is not None:
            if self.physics not in PHYSICS:
                raise ConfigurationError(unknown_name("physics", self.physics, PHYSICS))
            chosen = named_physics(self.physics, config.scale, config.physics.control_rate)
            config = dataclasses.replace(config, physics=chosen)
        if isinstance(config, PushedConfig) and not spec.task.has_push and config.push.newtons == NO_PUSH.newtons:
            config = spec.task.config_of(config)
        if isinstance(config, PushedConfig) and config.push.newtons != NO_PUSH.newtons:
            config.check_for_training()  # nor would anybody see a push after the end
        return dataclasses.replace(spec, config=config)


@dataclass(frozen=True)
class UnseenOptions(EpisodeOptions):
    """Options of commands that simulate on seeds which no training has seen.

    :param episodes: number of episodes; for tables, at each force, on each ground or in each engine
    :param first_seed: seed of the first episode; the others follow. No training has seen the default: trainings draw
        seeds from 2^31 up, and their summaries begin at 0
    :param workers: number of processes on this machine that simulate; with 0, this process does. It changes no result
    :param scheduler: address of a Dask scheduler whose workers simulate instead, such as tcp://10.0.0.1:8786
    """

    episodes: Annotated[int, Within(1, 1_000_000)] = 20
    first_seed: Annotated[int, Within(0, 2**32 - 1)] = FIRST_EVALUATION_SEED
    workers: int = 0
    scheduler: Annotated[str | None, tyro.conf.arg(metavar="ADDRESS")] = None

    @property
    def seeds(self) -> range:
        """Seeds of the episodes."""
        return range(self.first_seed, self.first_seed + self.episodes)


OptionsType = TypeVar("OptionsType", bound=EpisodeOptions)
ConfigType = TypeVar("ConfigType", bound=EpisodeConfig)


def parse_episode_options(
    command: str,
    arguments: Sequence[str],
    default: OptionsType,
    subject: str | None = None,
    adapted: Callable[[EpisodeConfig, str | None], EpisodeConfig] = lambda config, _: config,
) -> OptionsType:
    """Make a command's options, whose settings of episodes are those of its subject unless an option changes them.

    :param command: name of the command
    :param arguments: arguments after the command's name
    :param default: options with their default values
    :param subject: what to look at, if the arguments name several
    :param adapted: function that makes the command's settings of those of what it looks at, and of its name
    """
    given = given_options(arguments, "task", "which", "engine", "episode.engine", *DIRECTIONS)
    task = named_task(given.get("task"))
    subject = subject or _subject_among(arguments, default, given)
    shown = episode_of(subject, given.get("which"), task).spec.config if subject else (task or STEPPING).episode
    own = adapted(shown, subject)
    if type(own) is EpisodeConfig:  # any robot can be pushed, whether its task has a push or not
        own = PushedConfig(**vars(own), push=own.scale.scaled(NO_PUSH))
    is_recorded = subject is not None and Path(subject).is_dir()
    episode = with_given(own, arguments, given, is_recorded)
    return parse_options(type(default), command, arguments, dataclasses.replace(default, episode=episode))


def _subject_among(arguments: Sequence[str], default: EpisodeOptions, given: Mapping[str, str]) -> str | None:
    """What to look at, found by parsing with the settings of all tasks.

    Where that fails, or help is wanted, the first argument that could be it will do.
    """
    without = None if "task" in given else getattr(default, "subject", None)
    if {"-h", "--help"} & set(arguments):
        return next(filter(is_there, arguments), without)
    every = dataclasses.replace(default, episode=_with_given_engine(BALANCE.episode, given))
    try:
        with contextlib.redirect_stderr(io.StringIO()):
            options: Any = parse_options(type(default), "", arguments, every)
    except ConfigurationError:  # the real parser will say so
        return without
    except SystemExit:  # and so it will here, unless the subject has options that no other has
        return next(filter(is_there, arguments), without)
    subjects = getattr(options, "subjects", None)
    subject: str | None = subjects[0] if subjects else getattr(options, "subject", None)
    return subject if subject is not None and is_there(subject) else None


def with_given(
    episode: EpisodeConfig,
    arguments: Sequence[str],
    given: Mapping[str, str],
    is_recorded: bool = False,
    is_directed: bool = True,
) -> EpisodeConfig:
    """Episode settings of the type, for the robot and with the directions of pushes that a command was given.

    :param episode: settings of episodes
    :param arguments: all arguments of the command
    :param given: values of the options that were given, by name; those of engines and :data:`DIRECTIONS` are used
    :param is_recorded: whether the settings are those of a folder or a file, and stay as they are with another robot
    :param is_directed: whether all pushes point where the command was asked to push
    :raises ConfigurationError: for options whose settings only another task has, or that a short option sets as well
    :raises DescriptionError: if there is no such dimension, or if it is not near its default
    """
    episode = _with_given_engine(episode, given)
    _check_episode_options(arguments, episode)
    if not is_recorded:
        episode = for_given_robot(episode, arguments)
    return _with_given_directions(episode, given) if is_directed else episode


def _check_episode_options(arguments: Sequence[str], config: EpisodeConfig) -> None:
    """Refuse ``--episode.…`` options whose settings only another task has, or that a short option sets as well."""
    names = [argument.partition("=")[0].replace("_", "-") for argument in arguments]
    varied = [name for name in names if name.startswith("--episode.randomisation.")]
    if "--no-randomisation" in names and varied:
        raise ConfigurationError(f"--no-randomisation leaves {varied[0]} without effect: give one of them")
    for short, long in SET_TWICE:
        if short in names and long in names:
            raise ConfigurationError(f"{short} and {long} set the same: give one of them")
    for name in names:
        setting = name.removeprefix("--episode.").partition(".")[0].replace("-", "_")
        having = [task.name for task in TASKS.values() if hasattr(task.episode, setting)]
        if name.startswith("--episode.") and having and not hasattr(config, setting):
            raise ConfigurationError(f"{name} is for --task {' or '.join(having)}")


def given_options(arguments: Sequence[str], *names: str) -> dict[str, str]:
    """Values of some options, which are needed before all options can be parsed.

    :param arguments: arguments of the command
    :param names: names of the options, without dashes
    :return: values by name; an option without its value is left out, for the real parser to report
    """
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False, exit_on_error=False)
    for name in names:
        spellings = dict.fromkeys((f"--{name}", f"--{name.replace('-', '_')}"))
        parser.add_argument(*spellings, dest=name, default=argparse.SUPPRESS)
    try:
        return vars(parser.parse_known_args(arguments)[0])
    except argparse.ArgumentError:
        return {}


def _with_given_engine(episode: EpisodeConfig, given: Mapping[str, str]) -> EpisodeConfig:
    """Episode settings of the type that the engine takes which a command was given."""
    engine: Any = given.get("engine", given.get("episode.engine"))
    if engine not in get_args(Engine):  # the real parser reports others
        return episode
    return dataclasses.replace(episode, engine=engine)


def given_dimensions(arguments: Sequence[str]) -> dict[str, float]:
    """Dimensions of the robot that a command was given, by name; none where the real parser refuses them.

    :param arguments: arguments of the command
    """
    try:
        return named_numbers(without_dimensions(arguments)[1])
    except ValueError:
        return {}


def for_given_robot(episode: ConfigType, arguments: Sequence[str]) -> ConfigType:
    """Episode settings for the robot whose dimensions a command was given: much goes with its length and its mass.

    :param episode: settings of episodes
    :param arguments: arguments of the command
    :raises DescriptionError: if there is no such dimension, or if it is not near its default
    """
    given = given_dimensions(arguments)
    return episode.for_robot({**episode.dimensions, **given}) if given else episode


def _with_given_directions(episode: EpisodeConfig, given: Mapping[str, str]) -> EpisodeConfig:
    """Episode settings whose pushes all point where a command was asked to push."""
    degrees, share = DIRECTIONS
    if not isinstance(episode, PushedConfig) or degrees not in given or share in given:
        return episode
    return dataclasses.replace(episode, push=dataclasses.replace(episode.push, sagittal_share=0.0))
