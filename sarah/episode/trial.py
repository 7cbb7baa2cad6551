"""The trial of a task from a file, which finds its mistakes before a training begins."""

from __future__ import annotations

from dataclasses import replace

from sarah.control.pattern_generator import STAND_SECONDS
from sarah.episode.episode import simulate
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.task_answers import disturbances_of
from sarah.episode.tasks import Task
from sarah.errors import TaskError

TRIED_SEEDS = 20
"""Number of seeds whose disturbances are asked for in a trial."""
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
    _try_disturbances(task, config)


def _try_disturbances(task: Task, config: EpisodeConfig) -> None:
    ends = [tuple(getattr(parameter, end) for parameter in task.parameters) for end in ("low", "high")]
    numbers = [disturbances_of(EpisodeSpec(task.baseline, seed, task, config)) for seed in range(TRIED_SEEDS)]
    if numbers[0] != disturbances_of(EpisodeSpec(task.baseline, 0, task, config)):
        raise TaskError(f"{task.reference}: disturbances must depend on its argument only")
    if any(numbers[0] != disturbances_of(EpisodeSpec(end, 0, task, config)) for end in ends):
        raise TaskError(f"{task.reference}: disturbances must not depend on the parameters, which are what is learned")
    counts = sorted({len(each) for each in numbers if each is not None})
    if len(counts) > 1:
        raise TaskError(
            f"{task.reference}: disturbances must return as many numbers for every episode, "
            f"not {counts[0]} and {counts[-1]}"
        )
