"""Comparisons of learners on robots that no log has, and the goals."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Literal, NamedTuple

import numpy as np
from pandas import DataFrame

from sarah.reports.uncertainty import difference

FROZEN, CAREFUL, BEST, NEAREST = "frozen", "careful", "one set for all, frozen", "recognise, nearest"
HARD, EASY = 0.85, 0.92
"""Mean score of the frozen parameters below which a robot is hard, and from which on it is easy."""
KNOWN_KIND, OTHER_KIND, CHANGING = "known", "unknown", "changing"
"""Groups of robots: of kinds that the logs have, or are between; of other kinds; and those that change."""
GRADES = ("hard", "between", "easy", "other kinds")
"""Grades of robots that do not change."""


class Compared(NamedTuple):
    """What a learner is worth, or its difference from another one.

    :param mean: mean over the sessions
    :param low: lower end of the 95 % interval
    :param high: upper end
    :param sessions: number of sessions
    """

    mean: float
    low: float
    high: float
    sessions: int


class Goal(NamedTuple):
    """A goal, and what came out.

    :param goal: what is to be reached, in words
    :param at_least: lowest value that reaches it
    :param found: value that came out
    :param counts: what of it counts, its mean or the upper end of its interval
    """

    goal: str
    at_least: float
    found: Compared
    counts: Literal["mean", "high"] = "mean"

    @property
    def reached(self) -> str:
        """Whether it is reached, in a word; empty while nobody knows."""
        value = getattr(self.found, self.counts)
        return "" if math.isnan(value) else "yes" if value >= self.at_least else "no"


def graded(rows: DataFrame) -> DataFrame:
    """Rows of robots in MuJoCo, with a column that says how good the frozen shipped parameters are on each."""
    rows = rows[rows.engine == "mujoco"]
    frozen = rows[rows.learner == FROZEN].groupby("robot").score.mean()
    rows = rows[rows.robot.isin(frozen.index)]
    others = rows.group.replace(OTHER_KIND, GRADES[-1])
    return rows.assign(grade=others.mask(rows.group == KNOWN_KIND, rows.robot.map(frozen.map(_grade))))


def _grade(score: float) -> str:
    return "hard" if score < HARD else "easy" if score >= EASY else "between"


def compared(rows: DataFrame, column: str, learner: str = NEAREST, other: str | None = None) -> Compared:
    """Mean of a column, or mean difference from another learner on the same robots and seeds.

    The interval is Student's over the means of robots; of a single robot over its sessions.

    :param rows: rows of some robots
    :param column: column with scores
    :param learner: learner
    :param other: learner that it is compared with
    """
    wide = rows.pivot(index=["robot", "seed"], columns="learner", values=column)
    if not {learner, other or learner} <= set(wide):
        return Compared(np.nan, np.nan, np.nan, 0)
    values = (wide[learner] - (0.0 if other is None else wide[other])).dropna()
    if values.empty:
        return Compared(np.nan, np.nan, np.nan, 0)
    means = values.groupby("robot").mean()
    units = (values if len(means) == 1 else means).to_numpy()[:, None]
    return Compared(*difference(units, np.zeros_like(units)), len(values))


def goals(rows: DataFrame) -> Iterator[Goal]:
    """The goals, and what came out.

    :param rows: rows of the result
    """
    rows = graded(rows)
    hard, easy = (rows[rows.grade == grade] for grade in ("hard", "easy"))
    staying = rows[rows.group != CHANGING]
    yield Goal("hard robots, first minute", 0.87, compared(hard, "first_minute"))
    yield Goal("… less the careful learner", 0.05, compared(hard, "first_minute", other=CAREFUL))
    yield Goal("hard robots, first three minutes", 0.90, compared(hard, "first_3_min"))
    yield Goal("… less one set for all", 0.02, compared(hard, "first_3_min", other=BEST))
    of_robots = hard[hard.learner == NEAREST].groupby("robot").first_3_min.mean()
    yield Goal("… on the worst of these robots", 0.80, compared(hard[hard.robot == of_robots.idxmin()], "first_3_min"))
    yield Goal("… falls of the careful learner less its own", 0.0, compared(hard, "falls", CAREFUL, NEAREST))
    yield Goal("easy robots, ten minutes, less frozen ones", -0.005, compared(easy, "score", other=FROZEN))
    yield Goal("all robots, minutes 8 to 10, less the careful learner", -0.005, late(staying))
    of_each = {str(robot): late(its) for robot, its in staying.groupby("robot")}
    worst = min(of_each, key=lambda robot: (math.isnan(of_each[robot].high), of_each[robot].high))
    below = "; ".join(robot for robot, found in of_each.items() if found.high < 0.0) or "none"
    yield Goal(f"… on the worst robot, by the upper end (below zero on {below})", 0.0, of_each[worst], "high")
    for robot, its in rows[rows.group == OTHER_KIND].groupby("robot", sort=False):
        yield Goal(f"{robot}, less frozen ones", -0.01, compared(its, "score", other=FROZEN))
        yield Goal(f"{robot}, less the careful learner", -0.02, compared(its, "score", other=CAREFUL))
    changing = rows[rows.group == CHANGING]
    yield Goal(
        "the minute after a change, less the careful learner", 0.05, compared(changing, "minute_6", other=CAREFUL)
    )


def late(rows: DataFrame) -> Compared:
    """Difference from the careful learner in the last minutes.

    :param rows: rows of some robots
    """
    return compared(rows, "from_8_min", other=CAREFUL)


def verdicts(groups: Mapping[str, DataFrame]) -> str:
    """What the intervals say of the first three minutes against one set for all, in words.

    :param groups: rows of some robots by what they are called
    """
    found: dict[str, list[str]] = {}
    for name, its in groups.items():
        if len(its):
            one = compared(its, "first_3_min", other=BEST)
            word = "ahead" if one.low > 0.0 else "behind" if one.high < 0.0 else "neither (the interval includes zero)"
            found.setdefault(word, []).append(name)
    return "; ".join(f"{word} on {' and on '.join(names)}" for word, names in sorted(found.items()))
