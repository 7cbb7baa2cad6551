"""The curves of trainings from their run folders, ready to be drawn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sarah.episode.tasks import Task
from sarah.errors import RunFolderError
from sarah.runs.run_record import RunRecord
from sarah.training.plan import plan_of

OUTCOMES = ("return", "steps_per_second", "x", "y")
"""Columns of ``episodes.csv`` that figures of outcomes show."""


@dataclass(frozen=True)
class RunCurves:
    """The episodes of all runs of one algorithm.

    :param algorithm: name of the algorithm
    :param columns: columns of ``episodes.csv`` as numbers, each of shape (runs, episodes)
    :param warm_up: number of random episodes at first
    :param learning: number of episodes before the trials of the recommendation
    :param recommended: columns of ``recommendations.csv``, if there is one run; otherwise empty
    """

    algorithm: str
    columns: dict[str, np.ndarray]
    warm_up: int
    learning: int
    recommended: dict[str, np.ndarray]


def read_curves(runs: Sequence[RunRecord], task: Task) -> list[RunCurves]:
    """Read the curves of each algorithm.

    :param runs: records of trainings of one task
    :param task: the task
    :raises RunFolderError: if a run folder has no episodes, or damaged ones
    """
    by_algorithm: dict[str, list[RunRecord]] = {}
    for run in runs:
        by_algorithm.setdefault(run.config.algo, []).append(run)
    return [_curves(algorithm, own, task) for algorithm, own in by_algorithm.items()]


def _curves(algorithm: str, runs: Sequence[RunRecord], task: Task) -> RunCurves:
    names = (*OUTCOMES, *task.parameter_names)
    for run in runs:
        if not run.episodes:
            raise RunFolderError(f"{run.folder.path} has no episodes to draw")
    tables = [run.columns(run.episodes, names) for run in runs]
    shortest = min(len(run.episodes) for run in runs)
    columns = {name: np.array([table[name][:shortest] for table in tables]) for name in names}
    plans = [plan_of(run.config) for run in runs]
    learning = min(shortest, *(plan.stages[-1].begin + plan.stages[-1].learning for plan in plans))
    first = min(learning, max(plan.start.warm_up for plan in plans))
    recommended: dict[str, np.ndarray] = {}
    if len(runs) == 1:
        rows = runs[0].columns(runs[0].recommendations, ("episodes", *task.parameter_names))
        recommended = {name: np.array(values) for name, values in rows.items()}
    return RunCurves(algorithm, columns, first, learning, recommended)
