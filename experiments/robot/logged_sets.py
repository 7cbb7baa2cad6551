"""What are the parameters of one robot worth on another?

The best set of every robot in the result ``logged_robots`` runs on another robot of every kind. The rows are windows
too: ``sarah-train --offline results/logged_robots.csv results/logged_sets.csv`` learns from both.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from pandas import DataFrame

from experiments import record
from experiments.experiment import TRAINING, Experiment
from experiments.record import Row
from experiments.robot.logged_robots import FIRST_LOGGED_SEED, ROBOTS, tried, window_rows
from experiments.tables import shown, table
from sarah.control.parameters import Parameters
from sarah.operation.settings import SHIPPED
from sarah.recognition.learning import best_set
from sarah.recognition.logs import read_logs

FIRST_SEED = FIRST_LOGGED_SEED + 500


@dataclass(frozen=True)
class LoggedSets(Experiment):
    """Logs of other robots of the same kinds."""

    depends_on = (*TRAINING, "sarah/operation")
    kinds: int = len(ROBOTS)  # number of kinds
    sets: int = len(ROBOTS)  # number of sets that are tried: those of the first robots
    windows: int = 3  # number of windows with the shipped set

    def cases(self) -> list[Row]:
        """A robot of every kind."""
        return [{"robot": f"{kind}, another"} for kind in list(ROBOTS)[: self.kinds]]

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
QUICK = LoggedSets(kinds=1, sets=1, windows=1)


def _own(rows: DataFrame) -> DataFrame:
    """Rewards of each set on each robot: a row for each robot, a column for each kind whose set it is."""
    tried = rows[rows.log == "sets"]
    wide = DataFrame([group.observed_reward.to_numpy() for _, group in tried.groupby("kind", sort=False)])
    return wide.set_axis(tried.kind.unique()).set_axis(list(ROBOTS), axis=1)


def answer(rows: DataFrame) -> str:
    """How little the set of a robot says of what it is worth on another one."""
    wide = _own(rows)
    own = [wide.loc[kind, kind] for kind in wide.index]
    means = wide.mean()
    best, lowest = means.idxmax(), wide[means.idxmax()].min()
    return (
        f"On another robot of its kind a set is worth {shown(float(np.mean(own)), '.2f')} on average, and on the kind "
        f"that it suits least {shown(float(wide.min().mean()), '.2f')}. One set suits nearly all: that of "
        f"{best} is worth {shown(means.max(), '.2f')} on average, and at least {shown(lowest, '.2f')}."
    )


def kinds(rows: DataFrame) -> str:
    """What sets are worth on each kind."""
    wide = _own(rows)
    shipped = rows[rows.log == "shipped"].groupby("kind", sort=False).observed_reward.mean()
    found = DataFrame(
        {
            "kind": wide.index,
            "shipped": [shipped[kind] for kind in wide.index],
            "its own": [wide.loc[kind, kind] for kind in wide.index],
            "best for all": wide[wide.mean().idxmax()].to_numpy(),
            "worst": wide.min(axis=1).to_numpy(),
        }
    )
    caption = "Observed rewards on another robot of each kind: a window with the best set of each logged robot."
    columns = [str(column) for column in found.columns]
    return table(found, columns, caption, **dict.fromkeys(columns[1:], ".2f"))
