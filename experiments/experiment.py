"""What every experiment is: a dataclass whose fields are its options, with cases that are computed one by one."""

from __future__ import annotations

import itertools
import os
import time
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from experiments.record import Row
from sarah.episode.evaluation import Evaluation
from sarah.episode.workers import Workers
from sarah.reports.robustness import wilson_interval

EPISODE = ("sarah/control", "sarah/episode", "sarah/robot", "sarah/scenery", "sarah/simulation", "urdf")
"""Folders that decide what an episode returns."""
TRAINING = (*EPISODE, "agents", "sarah/envs", "sarah/recorded", "sarah/runs", "sarah/training")
"""Folders that decide what a training learns."""


@dataclass(frozen=True, kw_only=True)
class Experiment(ABC):
    """Options of an experiment."""

    workers: int = os.cpu_count() or 1  # number of worker processes; with 0, this process does the work
    depends_on: ClassVar[tuple[str, ...]] = EPISODE
    """Folders of the project that decide the rows."""

    @property
    def options(self) -> str:
        """Options that rows depend on, in words."""
        return ", ".join(f"{name}={value}" for name, value in vars(self).items() if name not in ("workers", "runs"))

    @staticmethod
    def clock() -> float:
        """Clock by which it is said how long cases take, in s: others on the machine do not disturb it."""
        return time.process_time()

    @abstractmethod
    def cases(self) -> Sequence[Row]:
        """What tells the rows apart, in order: values of their first columns. A case may have several rows."""

    @abstractmethod
    def rows(self, *values: Any, **case: Any) -> Iterable[Row]:
        """The other columns of a case's rows, computed in this process. They depend on no other case.

        A subclass names the columns of its cases.
        """

    def outcomes(self, cases: Sequence[Row]) -> Iterator[tuple[list[Row], float]]:
        """Rows of some cases and the time that they took, in s: in order, each as soon as it is known."""
        with Workers(self.workers) as workers:
            jobs = [workers.submit(_outcome, self, case) for case in cases]
            yield from (job.result() for job in jobs)


def _outcome(experiment: Experiment, case: Row) -> tuple[list[Row], float]:
    start = experiment.clock()
    rows: list[Row] = [{**case, **row} for row in experiment.rows(**case)]
    return rows, experiment.clock() - start


def product(**values: Iterable[Any]) -> list[Row]:
    """Cases for all combinations of values by column, the last column changing first."""
    return [dict(zip(values, combination, strict=True)) for combination in itertools.product(*values.values())]


def survival(found: Evaluation) -> Row:
    """Columns of the survival of some episodes with its 95 % interval (Wilson)."""
    return survival_of(found.survivors, found.episodes)


def survival_of(survivors: int, episodes: int) -> Row:
    """The same for a number of survivors."""
    low, high = wilson_interval(survivors, episodes)
    columns = ("episodes", "survival", "survival_low", "survival_high")
    return dict(zip(columns, (episodes, survivors / episodes, low, high), strict=True))
