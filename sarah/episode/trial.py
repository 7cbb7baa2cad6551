"""The trial of a task of a file: its mistakes are found before a training begins."""

from __future__ import annotations

from dataclasses import replace

from sarah.control.pattern_generator import STAND_SECONDS
from sarah.episode.episode import simulate
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import Task
from sarah.errors import TaskError

TRIAL_SECONDS = 0.5
"""Time that the pattern generator runs in a trial, in s."""


def try_task(task: Task, config: EpisodeConfig) -> None:
    """Simulate the beginning of an episode twice with the functions of a file; there is nothing to try in this package.

    :param task: task that is to be learned
    :param config: settings of its episodes
    :raises TaskError: if one of its functions raises, returns what it must not, or remembers what it did before
    """
    if task.file is None:
        return
    short = replace(config, time_limit=STAND_SECONDS + TRIAL_SECONDS)
    first, again = (simulate(EpisodeSpec(task.baseline, 0, task, short)) for _ in range(2))
    if first != again:
        raise TaskError(
            f"{task.reference}: the same episode has given {first.episode_return:g} and then {again.episode_return:g}; "
            "its functions must depend on their arguments only"
        )
