"""What every experiment is: a dataclass whose fields are its options, and which makes the rows of a result."""

from __future__ import annotations

import dataclasses
import os
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

from experiments.record import Row
from sarah.episode.evaluation import Evaluation
from sarah.episode.push import Push
from sarah.episode.settings import EpisodeConfig
from sarah.episode.tasks import TASKS
from sarah.episode.workers import Workers
from sarah.reports.robustness import wilson_interval


class Experiment(Protocol):
    """Something that makes the rows of a result."""

    def rows(self) -> Iterator[Row]:
        """The rows, each as soon as it is known; all of them have the same columns."""


@dataclass(frozen=True, kw_only=True)
class ParallelExperiment:
    """Options of an experiment whose episodes or trainings run in worker processes.

    :param workers: number of worker processes on this machine; with 0, this process does the work. No row depends on it
    """

    workers: int = os.cpu_count() or 1


class RowByRowExperiment(ParallelExperiment, ABC):
    """An experiment of hours whose rows do not depend on each other: interrupted, it goes on after the last row."""

    @abstractmethod
    def keys(self) -> Sequence[Row]:
        """What tells the rows apart: the first columns of each, in order."""

    @abstractmethod
    def row(self, *key: Any) -> Row:
        """The other columns of a row, made in this process.

        :param key: values of its first columns
        """

    def rows(self, known: Sequence[Row] = ()) -> Iterator[Row]:
        """A row for each key, one for each worker at a time.

        :param known: the first rows, if they are there already
        """
        with Workers(self.workers) as workers:
            asked = [(key, workers.submit(self.row, *key.values())) for key in self.keys()[len(known) :]]
            for key, job in asked:
                yield {**key, **job.result()}


@dataclass(frozen=True)
class Maker:
    """What makes a result.

    :param question: sentence that its rows answer
    :param experiment: the experiment in its full size
    :param quick: options that differ in a size that takes seconds, and shows only that the experiment runs
    :param of_robot: whether its rows depend on physics, controller and robot, whose fingerprint is then kept
    """

    question: str
    experiment: Experiment
    quick: Mapping[str, Any] = field(default_factory=dict)
    of_robot: bool = True

    @property
    def quick_experiment(self) -> Experiment:
        """The experiment in a size that takes seconds, in this process."""
        here = {"workers": 0} if isinstance(self.experiment, ParallelExperiment) else {}
        return dataclasses.replace(self.experiment, **here, **self.quick)  # type: ignore[type-var]


def settings_of(task: str, newtons: tuple[float, float], **shared: Any) -> EpisodeConfig:
    """Settings of a task's episodes, with pushes if the task has some.

    :param task: name of the task
    :param newtons: range of the pushes' force, in N
    :param shared: settings that all tasks have
    """
    if TASKS[task].has_push:
        shared["push"] = Push(newtons=newtons)
    return dataclasses.replace(TASKS[task].episode, **shared)


def survival(found: Evaluation) -> Row:
    """Columns of a survival with its 95 % interval.

    :param found: episodes
    """
    low, high = wilson_interval(found.survivors, found.episodes)
    return {
        "episodes": found.episodes,
        "survival": found.survival_rate,
        "survival_low": low,
        "survival_high": high,
    }
