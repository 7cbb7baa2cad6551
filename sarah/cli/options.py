"""Parts that all commands share: options, settings of episodes, and one line for a user's mistake."""

from __future__ import annotations

import argparse
import contextlib
import dataclasses
import io
import os
import re
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar, get_args

import tyro

from sarah.episode.push import Push
from sarah.episode.settings import EpisodeConfig
from sarah.episode.tasks import STEPPING, TASKS
from sarah.errors import ConfigurationError, SarahError, unknown_name
from sarah.simulation.engines import Engine, default_engine
from sarah.simulation.physics import PHYSICS

if TYPE_CHECKING:
    from sarah.runs.run_episodes import RunEpisode

OptionsType = TypeVar("OptionsType")
USAGE_ERROR = 2
PYTHON_WORDS = {
    r"^Error parsing (\S+): invalid literal for int\(\) with base 10: (.*)": r"\1 must be a whole number, not \2",
    r"^Error parsing (\S+): could not convert string to float: (.*)": r"\1 must be a number, not \2",
    r"^Error parsing (\S+): Could not parse arguments (.*) into tuple type .*": r"\1 must be numbers, not \2",
    r"^Error parsing (\S+): Could not find valid parse for arguments: (.*)": r"\1 must be whole numbers, not \2",
    r"^Error parsing (\S+): no type matching (\S+) could be instantiated from (.*?)\.\s+Got errors.*": (
        r"\1 must be \2, not \3"
    ),
    r"^Error parsing [\w.]+: ": "",
}
"""Python's messages about bad values, and the messages that a user gets instead."""


def fail(command: str, message: str) -> NoReturn:
    """Print one line that says what is wrong, and exit.

    :param command: name of the command
    :param message: message, which becomes one line
    """
    print(f"{command}: error: {' '.join(message.split())}", file=sys.stderr)
    raise SystemExit(USAGE_ERROR)


def parse_options(
    options_type: type[OptionsType], command: str, arguments: Sequence[str], default: OptionsType
) -> OptionsType:
    """Make a command's options from its arguments; ``--help`` prints the help and exits.

    :param options_type: dataclass of the options; its docstring is the help
    :param command: name of the command
    :param arguments: arguments after the command's name
    :param default: options with their default values
    """
    errors = io.StringIO()
    try:
        with contextlib.redirect_stderr(errors):
            return tyro.cli(
                options_type,
                prog=command,
                args=list(arguments),
                config=(tyro.conf.FlagCreatePairsOff,),
                default=default,
            )
    except SystemExit as exit_request:
        if not exit_request.code:
            raise
        fail(command, _one_line(errors.getvalue()))


def _one_line(box: str) -> str:
    """Message in tyro's frame, with the name that tyro suggests."""
    # The title is dropped. A terminal without frames gets plain rules, and one of them comes first.
    text = " ".join(line.strip("╭╮╰╯│ ") for line in box.splitlines()[1:])
    message = next(section.strip() for section in re.split("[─-]{5,}", text) if section.strip())
    for pattern, words in PYTHON_WORDS.items():
        message = re.sub(pattern, words, message)
    meant = re.search(r"Perhaps you meant:\s+(--[\w.-]+)", text)
    return f"{message}, did you mean {meant[1]}?" if meant else message


def with_engine(episode: EpisodeConfig, engine: str | None) -> EpisodeConfig:
    """Episode settings with the physics engine that a command was given.

    :param episode: settings of episodes
    :param engine: value of --engine; if ``None``, the settings keep their engine
    """
    return episode if engine is None else dataclasses.replace(episode, engine=engine)  # type: ignore[arg-type]  # checked


def say_engine(config: EpisodeConfig, asked: str | None) -> None:
    """Print on standard error that MuJoCo simulates because PyBullet is missing, unless an engine was asked for.

    :param config: settings of the episodes
    :param asked: value of --engine, or ``None``
    """
    if asked is None and config.engine == default_engine() != "pybullet":
        print("PyBullet is not installed, so MuJoCo simulates", file=sys.stderr)


def run_command(command: str, main: Callable[[Sequence[str]], None]) -> None:
    """Run a command, and print one line without a traceback if it raises one of the package's exceptions.

    :param command: name of the command
    :param main: function that runs it with its arguments
    """
    try:
        main(sys.argv[1:])
        sys.stdout.flush()
    except SarahError as error:
        fail(command, str(error))
    except BrokenPipeError:  # the reader of the output has closed it, as in `| head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except OSError as error:
        fail(command, str(error))
    except KeyboardInterrupt:
        print(f"\n{command}: interrupted", file=sys.stderr)
        raise SystemExit(130) from None


def numbers(name: str, text: str) -> tuple[float, ...]:
    """Read numbers that are separated by commas.

    :param name: name of the option in messages
    :param text: text that a user gave
    :raises ConfigurationError: if one of them is not a number
    """
    try:
        return tuple(float(value) for value in text.split(","))
    except ValueError:
        raise ConfigurationError(f"{name} must be numbers separated by commas, not {text!r}") from None


def episodes_of(subject: str, episode: str | None) -> tuple[list[RunEpisode], RunEpisode]:
    """Episodes of a run folder or of parameters, and the one to show.

    :param subject: path of a run folder, or parameters separated by commas
    :param episode: episode of the run folder: ``learned``, ``best`` or an index; ``None`` for the first of these that
        exists
    :raises ConfigurationError: if there is no such run folder or episode
    """
    from sarah.runs.run_episodes import choose_episode, episode_of_parameters, episodes_of_run

    if Path(subject).is_dir():
        from sarah.runs.run_folder import RunFolder

        episodes = episodes_of_run(RunFolder.open(Path(subject), unfinished=True))
        return episodes, choose_episode(episodes, episode)
    if not subject.strip("+-.")[:1].isdigit():
        raise ConfigurationError(f"{subject} is neither a run folder nor numbers separated by commas")
    if episode is not None:
        raise ConfigurationError("--episode is for a run folder")
    given = episode_of_parameters(numbers("parameters", subject))
    return [given], given


def changed_episodes(
    config: EpisodeConfig,
    stepping: str | None,
    push_newtons: float | None,
    physics: str | None,
    randomisation: bool,
    engine: str | None = None,
) -> EpisodeConfig:
    """Episode settings with the changes that options ask for.

    :param config: settings of the episodes
    :param stepping: P1 to P5 for the task balance, separated by commas
    :param push_newtons: force of every push, in N
    :param physics: name of a setting in :data:`~sarah.simulation.physics.PHYSICS`
    :param randomisation: whether to keep the randomisation
    :param engine: name of the physics engine
    :raises ConfigurationError: if a value is not allowed, or if the task does not have the setting
    """
    config = with_engine(config, engine)
    changes: dict[str, Any] = {}
    if physics is not None:
        if physics not in PHYSICS:
            raise ConfigurationError(unknown_name("physics", physics, PHYSICS))
        changes["physics"] = PHYSICS[physics].at_control_rate(config.physics.control_rate)
    if not randomisation:
        changes["randomisation"] = dataclasses.replace(config.randomisation, enabled=False)
    if stepping is not None:
        check_has(config, "stepping", "stepping")
        changes["stepping"] = STEPPING.checked(numbers("stepping", stepping), "stepping")
    if push_newtons is not None:
        changes["push"] = pushed_by(config, push_newtons)
    return dataclasses.replace(config, **changes)


def pushed_by(config: EpisodeConfig, newtons: float) -> Push:
    """Push of some episode settings, with a fixed force.

    :param config: settings of the episodes
    :param newtons: force of every push, in N
    :raises ConfigurationError: if the task has no push
    """
    check_has(config, "push", "push-newtons")
    push: Push = getattr(config, "push")  # noqa: B009  # only some tasks' settings have it
    return dataclasses.replace(push, newtons=(newtons, newtons))


def check_has(config: EpisodeConfig, name: str, option: str) -> None:
    """Refuse an option whose setting a task does not have.

    :param config: settings of the task's episodes
    :param name: name of the setting
    :param option: name of the option, without dashes
    """
    if not hasattr(config, name):
        tasks = " or ".join(task.name for task in TASKS.values() if hasattr(task.episode, name))
        raise ConfigurationError(f"--{option} is for --task {tasks}")


def check_episode_options(arguments: Sequence[str], config: EpisodeConfig) -> None:
    """Refuse ``--episode.…`` options whose settings only another task has.

    :param arguments: all arguments of a command
    :param config: settings of the task's episodes
    """
    for argument in arguments:
        name = argument.removeprefix("--episode.").split(".")[0].replace("-", "_")
        if argument.startswith("--episode.") and any(hasattr(task.episode, name) for task in TASKS.values()):
            check_has(config, name, argument.removeprefix("--").split("=")[0])


def given_options(arguments: Sequence[str], *names: str) -> dict[str, str]:
    """Values of some options, which are needed before all options can be parsed.

    :param arguments: arguments of the command
    :param names: names of the options, without dashes
    :return: values by name; an option without its value is left out, for the real parser to report
    """
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False, exit_on_error=False)
    for name in names:
        parser.add_argument(f"--{name}", dest=name, default=argparse.SUPPRESS)
    try:
        return vars(parser.parse_known_args(arguments)[0])
    except argparse.ArgumentError:
        return {}


def episode_of(task: str, given: Mapping[str, str], episode: EpisodeConfig | None = None) -> EpisodeConfig:
    """Episode settings of the type that a task and an engine take.

    :param task: name of the task; an unknown one is ignored here, for the caller to report
    :param given: values of the options that were given, by name; ``engine`` and ``episode.engine`` are used
    :param episode: settings of any task's episodes; by default the task's own
    """
    if episode is None:
        episode = TASKS.get(task, STEPPING).episode
    elif task in TASKS and type(episode) is not type(TASKS[task].episode):
        episode = TASKS[task].config_of(episode)
    engine = given.get("engine", given.get("episode.engine"))
    return with_engine(episode, engine if engine in get_args(Engine) else None)
