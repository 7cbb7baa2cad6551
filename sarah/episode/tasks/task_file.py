"""Tasks from files of the user's: one file is all there is to a task, so workers and run folders can have it whole."""

from __future__ import annotations

import dataclasses
import sys
import traceback
from functools import lru_cache
from pathlib import Path
from types import ModuleType
from typing import Any

from sarah.episode.push import PushedConfig
from sarah.episode.settings import EpisodeConfig
from sarah.episode.tasks.balance import BalanceConfig
from sarah.episode.tasks.task import Task, TaskFile
from sarah.errors import ConfigurationError, SarahError, TaskError, unknown_name
from sarah.files import read_text

SETTINGS_TYPES: dict[str, type[EpisodeConfig]] = {
    kind.__name__: kind for kind in (EpisodeConfig, PushedConfig, BalanceConfig)
}
"""Types of settings that the episodes of such a task can have: run folders are read without its file."""


def read_task(path: Path, attribute: str) -> Task[Any]:
    """Read a file, run it, and return a task that it defines.

    :param path: path of the file
    :param attribute: name of the task in the file
    :raises ConfigurationError: naming file, line and mistake, or the tasks that the file has
    """
    try:
        text = read_text(path)
    except OSError as error:
        raise ConfigurationError(f"cannot read {path}: {error.strerror or error}") from error
    return task_of_text(path.name, attribute, text.removeprefix("\ufeff"))


@lru_cache
def task_of_text(name: str, attribute: str, text: str) -> Task[Any]:
    """Run the text of a file, once in a process, and return a task that it defines.

    :param name: name of the file
    :param attribute: name of the task in the file
    :param text: text of the file
    :raises ConfigurationError: naming file, line and mistake, or the tasks that the file has
    """
    file = TaskFile(name, attribute, text)
    tasks = {key: value for key, value in vars(_module(file)).items() if isinstance(value, Task)}
    if attribute not in tasks:
        raise ConfigurationError(unknown_name(f"task in {name}", attribute, tasks))
    task = tasks[attribute]
    if type(task.episode) not in SETTINGS_TYPES.values():
        kinds = ", ".join(SETTINGS_TYPES)
        raise TaskError(f"{file.reference}: its episode must be one of {kinds}, not {type(task.episode).__name__}")
    return dataclasses.replace(task, file=file)


def _module(file: TaskFile) -> ModuleType:
    """The module that the text makes. It stays in ``sys.modules``, where dataclasses look for theirs."""
    module = ModuleType(f"sarah_task_{file.digest}")
    module.__file__ = file.name
    sys.modules[module.__name__] = module
    try:
        exec(compile(file.text, file.name, "exec"), vars(module))
    except (Exception, SystemExit) as error:
        is_missing = isinstance(error, ModuleNotFoundError)
        hint = "; a task's file can import installed packages only" if is_missing else ""
        raise TaskError(mistake(file.name, error) + hint) from error
    return module


def mistake(name: str, error: BaseException) -> str:
    """Message about an exception that a user's file raised, with the line in that file.

    :param name: name of the file
    :param error: exception
    """
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == name]
    line = getattr(error, "lineno", None) if isinstance(error, SyntaxError) else lines[-1] if lines else None
    words = error.msg if isinstance(error, SyntaxError) else _text_of(error)
    kind = "" if isinstance(error, SarahError) else f"{type(error).__name__}: "
    return f"{name}{f', line {line}' if line else ''}: {kind}{words}"


def _text_of(error: BaseException) -> str:
    try:
        return " ".join(str(error).split()) or type(error).__name__
    except Exception:  # also this is the user's code
        return "an exception without a message"
