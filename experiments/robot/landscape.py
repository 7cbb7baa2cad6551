"""What does each parameter do?

One of P1 to P5 at a time around (0.4, 1, 0.1, 1, 1), and one of V1 to V4 around (1, 0, 0, 0) under pushes of 100 N.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

from matplotlib.figure import Figure
from pandas import DataFrame

from experiments.experiment import Experiment
from experiments.record import Row
from experiments.robot.conditions import TIME_LIMIT
from experiments.robot.engines import NEWTONS, settings
from experiments.shapes import groups, line_panels
from experiments.tables import span, table, turned_table
from sarah.episode.evaluation import evaluate
from sarah.episode.tasks import TASKS
from sarah.reports.transfer import ENGINES
from sarah.simulation.engines import Engine

COST = 0.05
"""Loss of score that a good value may have, in the engine where its score is lower."""

CENTRES = {"stepping": (0.4, 1.0, 0.1, 1.0, 1.0), "balance": (1.0, 0.0, 0.0, 0.0)}
VALUES = {
    "stepping": (0.0, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0, 1.5, 2.0),
    "balance": (-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 2.0),
}
"""Values of every parameter by task, while the others keep those of the centre."""
EPISODES = {"stepping": 3, "balance": 12}
SECONDS = {"stepping": 12.0, "balance": TIME_LIMIT}


@dataclass(frozen=True)
class Landscape(Experiment):
    """One parameter at a time, in both engines."""

    points: int = 10  # number of values of each parameter
    time_limit: float | None = None  # time limit of an episode, in s; by default 12 s, and 10 s with pushes

    def cases(self) -> list[Row]:
        """Each parameter in each engine."""
        names = [(task, name) for task in CENTRES for name in TASKS[task].parameter_names]
        return [{"task": task, "parameter": name, "engine": engine} for task, name in names for engine in ENGINES]

    def rows(self, task: str, parameter: str, engine: Engine) -> Iterator[Row]:
        """A row for each value."""
        centre, index = CENTRES[task], TASKS[task].parameter_names.index(parameter)
        config = settings(task, engine, self.time_limit or SECONDS[task])
        for value in VALUES[task][: self.points]:
            parameters = (*centre[:index], value, *centre[index + 1 :])
            found = evaluate(task, parameters, config, range(EPISODES[task]))
            yield {"value": value, "score": found.median("score"), "survival": found.survival_rate}


FULL = Landscape()
QUICK = Landscape(points=1, time_limit=1.1)


def good_values(rows: DataFrame) -> tuple[dict[str, str], dict[str, str]]:
    """Good values of each parameter, in words: first of those with few, then of those with many."""
    few: dict[str, str] = {}
    many: dict[str, str] = {}
    for name, group in groups(rows, "parameter").items():
        worse = group.groupby("value").score.min()  # of the engines
        good = worse >= worse.max() - COST
        stretches = [part.index.to_series() for _, part in good[good].groupby((~good).cumsum())]
        told = few if good.mean() < 0.5 else many
        told[str(name)] = " and ".join(span(stretch, "g") for stretch in stretches)
    return few, many


def answer(rows: DataFrame) -> str:
    """Which values are good."""
    few, many = (" and ".join(", ".join(told).rsplit(", ", 1)) for told in good_values(rows))
    return f"The score depends most on {few}, which have few good values. {many} hardly matter over a wide range."


def good(rows: DataFrame) -> str:
    """The good values of each parameter."""
    few, many = good_values(rows)
    found = DataFrame(sorted((few | many).items()), columns=["parameter", "good values"])
    caption = f"Values whose score, in the engine where it is lower, is at most {COST} below the best."
    return table(found, list(found.columns), caption)


def _along(task: str, rows: DataFrame) -> Figure:
    """Score along each parameter of a task, in both engines."""
    return line_panels(rows[rows.task == task], "parameter", "value", "score", "engine", height=0.28, sharey=True)


figure_stepping, figure_balance = partial(_along, "stepping"), partial(_along, "balance")


def balance(rows: DataFrame) -> str:
    """Survival by V1 to V4."""
    caption = (
        f"Survival of {EPISODES['balance']} pushes of {NEWTONS:.0f} N at 1 to 4 s with the shipped P1 to P5. A robot "
        f"that reaches {SECONDS['balance']:g} s counts as having survived."
    )
    return turned_table(rows[rows.task == "balance"], ["value"], ["parameter", "engine"], "survival", caption)
