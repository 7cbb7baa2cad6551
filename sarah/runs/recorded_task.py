"""A task of a user's file, as a run folder records it: enough to read the folder, and nothing that runs.

task.py      the file, as it was
task.json    names, boxes and baseline of the task, which figures and tables need
"""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any, NoReturn

from sarah.control.parameters import Parameter
from sarah.episode.tasks import SETTINGS_TYPES, Task, TaskFile
from sarah.errors import ConfigurationError, RunFolderError, SarahError
from sarah.files import read_text, replace_text

SOURCE, DESCRIPTION = "task.py", "task.json"


class RecordedTask(Task[Any]):
    """A task whose file is not run. It cannot simulate, here or in a worker."""

    def __reduce__(self) -> NoReturn:
        """Refuse to travel to a worker, which would run the file."""
        refuse_to_simulate(self)


def refuse_to_simulate(task: Task[Any]) -> NoReturn:
    """Say how a task is given that has to be run.

    :param task: task of a run folder
    :raises ConfigurationError: always
    """
    raise ConfigurationError(
        f"task {task.name!r} is in a file of its own, which is not run unasked: name it with --task {task.reference}"
    )


def record_task(task: Task[Any], folder: Path) -> None:
    """Write a task of a file into a run folder; nothing is written for a task of this package.

    :param task: task of the training
    :param folder: path of the run folder
    """
    if task.file is None:
        return
    content = {
        "file": task.file.name,
        "attribute": task.file.attribute,
        "settings": type(task.episode).__name__,
        "name": task.name,
        "title": task.title,
        "parameters": [dataclasses.asdict(parameter) for parameter in task.parameters],
        "baseline": task.baseline,
        "baseline_label": task.baseline_label,
        "neutral": task.neutral,
        "best_reward": task.best_reward,
        "must_step": task.must_step,
    }
    replace_text(folder / SOURCE, task.file.text)
    replace_text(folder / DESCRIPTION, json.dumps(content, indent=2) + "\n")


def recorded_task(folder: Path) -> Task[Any] | None:
    """Read the task that :func:`record_task` wrote, without running its file.

    :param folder: path of the run folder
    :return: the task, which cannot simulate; nothing if the run folder has a task of this package
    :raises RunFolderError: if the description or the file is missing or damaged
    """
    path = folder / DESCRIPTION
    if not path.exists():
        return None
    try:
        content = json.loads(read_text(path))
        parameters = tuple(Parameter(**parameter) for parameter in content.pop("parameters"))
        file = TaskFile(content.pop("file"), content.pop("attribute"), read_text(folder / SOURCE))
        episode = SETTINGS_TYPES[content.pop("settings")]()
        baseline, neutral = tuple(content.pop("baseline")), content.pop("neutral")
        task: Task[Any]

        def refuse(*arguments: Any) -> NoReturn:
            refuse_to_simulate(task)

        task = RecordedTask(
            parameters=parameters,
            episode=episode,
            controller_parameters=refuse,
            baseline=baseline,
            neutral=neutral and tuple(neutral),
            reward=refuse,
            ending=refuse,
            draw_push=refuse,
            disturbances=refuse,
            file=file,
            **content,
        )
        return task
    except (OSError, ValueError, LookupError, TypeError, AttributeError, RecursionError, SarahError) as error:
        reason = getattr(error, "strerror", None) or " ".join(str(error).split())[:200]
        raise RunFolderError(f"the task of {folder} cannot be read: {reason}") from error
