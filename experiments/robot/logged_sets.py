"""What are the parameters of one robot worth on another?

The best set of every robot in the result ``logged_robots`` runs on another robot of every kind. The rows are windows
too: ``sarah-train --offline results/logged_robots.csv results/logged_sets.csv`` learns from both.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from experiments import record
from experiments.experiment import TRAINING, Experiment
from experiments.record import Row
from experiments.robot.logged_robots import FIRST_LOGGED_SEED, ROBOTS, tried, window_rows
from sarah.control.parameters import Parameters
from sarah.operation.settings import SHIPPED
from sarah.recognition.learning import best_set
from sarah.recognition.logs import read_logs

FIRST_SEED = FIRST_LOGGED_SEED + 500


@dataclass(frozen=True)
class LoggedSets(Experiment):
    """Logs of other robots of the same kinds."""

    depends_on = (*TRAINING, "sarah/operation")
    sets: int = len(ROBOTS)  # number of sets that are tried: those of the first robots
    windows: int = 3  # number of windows with the shipped set

    def cases(self) -> list[Row]:
        """A robot of every kind."""
        return [{"robot": f"{kind}, another"} for kind in ROBOTS]

    def rows(self, robot: str) -> Iterator[Row]:
        """Its windows."""
        kind = robot.removesuffix(", another")
        config, seed = ROBOTS[kind].config(10.0), FIRST_SEED + list(ROBOTS).index(kind)
        for log, sets in (("shipped", [SHIPPED] * self.windows), ("sets", best_sets()[: self.sets])):
            yield from ({"kind": kind, **row} for row in window_rows(log, tried(config, seed, sets)))


def best_sets() -> list[Parameters]:
    """The best set of each logged robot."""
    return [best_set(robot) for robot in read_logs([record.RESULTS / "logged_robots.csv"])]


FULL = LoggedSets()
QUICK = LoggedSets(sets=1, windows=1)
