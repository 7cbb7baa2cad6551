"""What timings share: they run in this process, one after the other."""

from __future__ import annotations

import time
from dataclasses import dataclass
from statistics import median

import tyro

from experiments.experiment import Experiment
from experiments.record import Row


@dataclass(frozen=True, kw_only=True)
class Timing(Experiment):
    """Options of a timing, which runs in this process."""

    workers: tyro.conf.Suppress[int] = 0

    @staticmethod
    def clock() -> float:
        """Clock by which it is said how long cases take, in s: that on the wall, as they wait for other processes."""
        return time.perf_counter()


def spread(name: str, values: list[float]) -> Row:
    """Columns of a median, and of the smallest and the largest value.

    :param name: name of the column
    :param values: of the rounds
    """
    return {name: median(values), f"{name}_low": min(values), f"{name}_high": max(values)}
