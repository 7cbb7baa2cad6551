"""The curves of trainings from their run folders, ready to be drawn."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from sarah.episode.tasks import Task
from sarah.errors import RunFolderError
from sarah.number import finite_number
from sarah.runs.run_episodes import LONGEST_REASON
from sarah.runs.run_folder import RunFolder
from sarah.training.plan import plan_of

OUTCOMES = ("return", "steps_per_second", "x", "y")
"""Columns of ``episodes.csv`` that figures of outcomes show."""
Rows = dict[str, list[float]]
Read = TypeVar("Read")


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


def read_curves(runs: Sequence[RunFolder], task: Task) -> list[RunCurves]:
    """Read the curves of each algorithm.

    :param runs: run folders of trainings of one task
    :param task: the task
    :raises RunFolderError: if a run folder has no episodes, or damaged ones
    """
    by_algorithm: dict[str, list[RunFolder]] = {}
    for run in runs:
        by_algorithm.setdefault(run.config().algo, []).append(run)
    return [_curves(algorithm, own, task) for algorithm, own in by_algorithm.items()]


def _curves(algorithm: str, runs: Sequence[RunFolder], task: Task) -> RunCurves:
    names = (*OUTCOMES, *task.parameter_names)
    tables = [_readable(run, lambda run=run: _numbers(run.episodes(), names)) for run in runs]  # type: ignore[misc]
    for run, table in zip(runs, tables, strict=True):
        if not table["return"]:
            raise RunFolderError(f"{run.path} has no episodes to draw")
    shortest = min(len(table["return"]) for table in tables)
    columns = {name: np.array([table[name][:shortest] for table in tables]) for name in names}
    plans = [plan_of(run.config()) for run in runs]
    learning = min(shortest, *(plan.stages[-1].begin + plan.stages[-1].learning for plan in plans))
    first = min(learning, max(plan.start.warm_up for plan in plans))
    recommended: dict[str, np.ndarray] = {}
    if len(runs) == 1:
        noted = ("episodes", *task.parameter_names)
        rows = _readable(runs[0], lambda: _numbers(runs[0].recommendations(), noted))
        recommended = {name: np.array(values) for name, values in rows.items()}
    return RunCurves(algorithm, columns, first, learning, recommended)


def _readable(run: RunFolder, read: Callable[[], Read]) -> Read:
    """Read a table of a run folder, and name the folder if it is damaged."""
    try:
        return read()
    except (KeyError, TypeError, ValueError) as error:
        reason = repr(error)[:LONGEST_REASON]
        raise RunFolderError(f"the episodes of {run.path} cannot be read: {reason}") from error


def _numbers(rows: Iterable[dict[str, str]], names: Sequence[str]) -> Rows:
    columns: Rows = {name: [] for name in names}
    for row in rows:
        for name in names:
            columns[name].append(finite_number(row[name]))
    return columns
