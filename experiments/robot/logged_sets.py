"""What are the parameters of one robot worth on another?

The best set of every robot in the result ``logged_robots`` runs on another robot of every kind. The rows are windows
too: ``sarah-train --offline results/logged_robots.csv results/logged_sets.csv`` learns from both.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from pandas import DataFrame, Series

from experiments import record
from experiments.experiment import TRAINING, Experiment
from experiments.record import Row
from experiments.robot.logged_robots import FIRST_LOGGED_SEED, ROBOTS, tried, window_rows
from experiments.robot.recognised import HARD
from experiments.tables import shown, table
from sarah.control.parameters import Parameters
from sarah.operation.settings import SHIPPED
from sarah.recognition.learning import best_set
from sarah.recognition.logs import read_logs
from sarah.reports.uncertainty import difference

FIRST_SEED = FIRST_LOGGED_SEED + 500
MINUTES, WINDOW_SECONDS = 3.0, 6.0
"""Time in which a robot's first minutes are compared, in min, and duration of a window, in s."""


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


def _worth(rows: DataFrame, column: str = "observed_reward") -> DataFrame:
    """What each set is worth on each robot: a row for each robot, a column for each kind whose set it is."""
    tried = rows[rows.log == "sets"]
    wide = DataFrame([group[column].to_numpy() for _, group in tried.groupby("kind", sort=False)])
    return wide.set_axis(tried.kind.unique()).set_axis(list(ROBOTS), axis=1)


def _shipped(rows: DataFrame, column: str = "observed_reward") -> Series[float]:
    """What the shipped set is worth on each robot."""
    found: Series[float] = rows[rows.log == "shipped"].groupby("kind", sort=False)[column].mean()
    return found


def answer(rows: DataFrame) -> str:
    """How little the set of a robot says of what it is worth on another one."""
    wide = _worth(rows)
    own = [wide.loc[kind, kind] for kind in wide.index]
    means = wide.mean()
    best, lowest = means.idxmax(), wide[means.idxmax()].min()
    return (
        f"On another robot of its kind a set is worth {shown(float(np.mean(own)), '.2f')} on average, and on the kind "
        f"that it suits least {shown(float(wide.min().mean()), '.2f')}. One set suits nearly all: that of "
        f"{best} is worth {shown(means.max(), '.2f')} on average, and at least {shown(lowest, '.2f')}."
    )


def room(rows: DataFrame) -> str:
    """How much there is to gain over one set for all in the first minutes, whoever chooses among these sets."""
    wide, shipped = _worth(rows, "score"), _shipped(rows, "score")
    hard = wide[shipped < HARD]
    one_for_all, own = hard[wide.mean().idxmax()], Series({kind: hard.loc[kind, kind] for kind in hard.index})
    windows = round(MINUTES * 60.0 / WINDOW_SECONDS)
    chosen, known = ((shipped[hard.index] + (windows - 1) * one) / windows for one in (hard.max(axis=1), own))
    gains = [difference((one - one_for_all).to_numpy()[:, None], np.zeros((len(hard), 1))) for one in (chosen, known)]
    (most, *of_most), (mean, *of_mean) = [[shown(value, "+.3f") for value in gain] for gain in gains]
    return (
        f"On the {len(hard)} kinds where the shipped set scores below {HARD}, the best set of each scores "
        f"{shown(hard.max(axis=1).mean(), '.3f')}. This flatters it, because the window that is counted also chose it. "
        f"One set for all scores {shown(one_for_all.mean(), '.3f')}. A robot that begins with a window of the shipped "
        f"set, and then runs the best one, is {most} ({' to '.join(of_most)}) ahead after {MINUTES:g} minutes. With "
        f"the set that another robot of its kind had found best, the difference is {mean} ({' to '.join(of_mean)})."
    )


def kinds(rows: DataFrame) -> str:
    """What sets are worth on each kind."""
    wide = _worth(rows)
    shipped = _shipped(rows)
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
