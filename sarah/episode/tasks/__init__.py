"""The tasks: each is a file here, which is found. A task of your own can be a file anywhere.

A task may import errors, robot, control, and from the episode its settings, push, disturbances,
ending, reward, tick and shipped parameters.
"""

import copyreg
from collections.abc import Iterable
from dataclasses import fields
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from typing import Any

from sarah.episode.tasks.balance import BALANCE, BalanceConfig
from sarah.episode.tasks.stepping import STEPPING
from sarah.episode.tasks.task import Task, TaskFile
from sarah.episode.tasks.task_file import SETTINGS_TYPES, read_task, task_of_text
from sarah.errors import ConfigurationError, check_type, unknown_name


def tasks_in(folders: Iterable[str]) -> dict[str, Task[Any]]:
    """Tasks of this package, by name: the paper's two, and those of all modules.

    :param folders: paths of the folders with the modules
    """
    tasks: list[Task[Any]] = [STEPPING, BALANCE]
    for module in iter_modules(folders):
        values = vars(import_module(f"{__name__}.{module.name}")).values()
        tasks += [value for value in values if isinstance(value, Task)]
    return {task.name: task for task in tasks}


TASKS = tasks_in(__path__)
"""Tasks of this package, by name."""


def task_named(task: str | Task[Any]) -> Task[Any]:
    """Find a task of this package.

    :param task: name of the task; a task is returned as it is
    :raises ConfigurationError: if there is no such task; the message names all tasks
    """
    if isinstance(task, Task):
        return task
    if not isinstance(task, str) or task not in TASKS:
        file = str(task) if ".py:" in str(task) else "my_task.py:JUMP"
        hint = f"; that of a file is loaded by --task {file} or sarah.load_task" if ":" in str(task) else ""
        raise ConfigurationError(unknown_name("task", str(task), TASKS) + hint)
    return TASKS[task]


def load_task(reference: str) -> Task[Any]:
    """Find a task of this package by its name, or load one from a file of yours, which runs the file.

    :param reference: name of a task, such as ``"stepping"``; or path of a file and name of the task in it, such as
        ``"my_task.py:JUMP"``
    :raises ConfigurationError: if there is no such task, or if the file has a mistake
    """
    check_type("task", reference, str)
    path, colon, attribute = reference.rpartition(":")
    if colon and path.endswith(".py"):
        task = read_task(Path(path), attribute)
        if task.name in TASKS:
            raise ConfigurationError(f"{reference}: the name {task.name!r} is that of a task of this package")
        return task
    if reference.endswith(".py"):
        raise ConfigurationError(f"name the task in {reference} too, as in {reference}:TASK")
    return task_named(reference)


def is_portable(task: Task[Any]) -> bool:
    """Whether any process can have the same task: it is this package's, or a file's; a script's own is not.

    :param task: the task
    """
    return task.file is not None or TASKS.get(task.name) is task


def _pickled(task: Task[Any]) -> tuple[Any, tuple[Any, ...]]:
    """What makes the same task: its name in this package, or the text of its file. Workers need nothing else."""
    if task.file is not None:
        return task_of_text, (task.file.name, task.file.attribute, task.file.text)
    if is_portable(task):
        return task_named, (task.name,)
    return Task, tuple(getattr(task, item.name) for item in fields(task))


copyreg.pickle(Task, _pickled)

__all__ = [
    "BALANCE",
    "SETTINGS_TYPES",
    "STEPPING",
    "TASKS",
    "BalanceConfig",
    "Task",
    "TaskFile",
    "is_portable",
    "load_task",
    "task_named",
    "task_of_text",
]
