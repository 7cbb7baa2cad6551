"""The tasks: one file each, and an entry here.

A task may import errors, robot, control, and from the episode its settings, push and reward.
"""

from typing import Any

from sarah.episode.tasks.balance import BALANCE, BalanceConfig
from sarah.episode.tasks.stepping import STEPPING
from sarah.episode.tasks.task import Task
from sarah.errors import ConfigurationError, unknown_name

TASKS: dict[str, Task[Any]] = {task.name: task for task in (STEPPING, BALANCE)}
"""Tasks by name."""


def task_named(name: str) -> Task[Any]:
    """Find a task.

    :param name: name of the task
    :raises ConfigurationError: if there is no such task; the message names all tasks
    """
    if name not in TASKS:
        raise ConfigurationError(unknown_name("task", name, TASKS))
    return TASKS[name]


__all__ = ["BALANCE", "STEPPING", "TASKS", "BalanceConfig", "Task", "task_named"]
