"""How does NAF do on standard tasks, next to DDPG, TD3 and SAC?

Returns along trainings, with the defaults of each class.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter
from pandas import DataFrame

from experiments.experiment import Experiment
from experiments.naf.learners import course
from experiments.record import Row
from experiments.shapes import groups, line_panels
from experiments.tables import shown, table

RECENT = 3
"""Number of evaluations that are the end of a training: one alone says little, as returns swing."""
OTHERS = ("DDPG", "TD3", "SAC")


class Trainings(NamedTuple):
    """Trainings on a task."""

    steps: int  # of each
    seeds: int  # of each algorithm
    episodes: int  # of an evaluation
    algorithms: tuple[str, ...]


TASKS = {
    "Pendulum-v1": Trainings(10_000, 10, 20, ("NAF", "NAF, noise of 0.5", "DDPG", "TD3", "SAC")),
    "InvertedPendulum-v5": Trainings(5_000, 5, 20, ("NAF", "DDPG", "TD3", "SAC")),
    "HalfCheetah-v5": Trainings(100_000, 5, 5, ("NAF", "DDPG")),
    "Hopper-v5": Trainings(100_000, 5, 5, ("NAF", "NAF, noise of 0.9", "DDPG")),
    "Walker2d-v5": Trainings(100_000, 5, 5, ("NAF", "DDPG")),
    "Reacher-v5": Trainings(100_000, 5, 5, ("NAF", "DDPG")),
    "Swimmer-v5": Trainings(100_000, 5, 5, ("NAF", "DDPG")),
}
"""Which algorithms run where."""


@dataclass(frozen=True)
class StandardTasks(Experiment):
    """Trainings of algorithms on tasks of gymnasium."""

    depends_on: ClassVar[tuple[str, ...]] = ("agents",)
    steps: int | None = None  # of a training; by default those of its task
    seeds: int | None = None  # number of trainings of each algorithm; by default that of the task
    episodes: int | None = None  # of an evaluation; by default those of the task
    evaluations: int = 10  # along a training, the last at its end

    def cases(self) -> list[Row]:
        """Each training, the first seed of all tasks first."""
        cases = [
            {"task": task, "algorithm": algorithm, "seed": seed}
            for task, of in TASKS.items()
            for algorithm in of.algorithms
            for seed in range(self.seeds or of.seeds)
        ]
        return sorted(cases, key=lambda case: case["seed"])

    def rows(self, task: str, algorithm: str, seed: int) -> Iterable[Row]:
        """The course of a training."""
        of = TASKS[task]
        steps, episodes = self.steps or of.steps, self.episodes or of.episodes
        return course(algorithm, task, seed, steps, self.evaluations, episodes)


FULL = StandardTasks()
QUICK = StandardTasks(steps=120, seeds=1, episodes=1, evaluations=1)


def ends(rows: DataFrame) -> DataFrame:
    """A row for each training: means of its last evaluations."""
    trainings = rows.groupby(["task", "algorithm", "seed"], sort=False)
    last = trainings.tail(RECENT).groupby(["task", "algorithm", "seed"], sort=False)
    return last.agg({"return": "mean", "v_over_bound": "max"}).reset_index()


def over_seeds(rows: DataFrame, *columns: str) -> DataFrame:
    """Median return of the seeds of each group, and the lowest and the highest; the largest V over its bound."""
    return (
        rows.groupby(list(columns), sort=False)
        .agg(
            seeds=("seed", "nunique"),
            **{"return": ("return", "median"), "return_low": ("return", "min"), "return_high": ("return", "max")},
            v_over_bound=("v_over_bound", "max"),
        )
        .reset_index()
    )


def answer(rows: DataFrame) -> str:
    """How NAF does next to each of the other algorithms, and how near V comes to its bound."""
    found = groups(over_seeds(ends(rows), "task", "algorithm").set_index("task"), "algorithm")
    sentences = [_compared(found["NAF"], found[other], other) for other in OTHERS if other in found]
    ratios = found["NAF"].v_over_bound
    nearest = f"V comes to {shown(ratios.max(), '.2f')} of its bound at most, on {ratios.idxmax()}."
    return " ".join([*sentences, nearest])


def _compared(naf: DataFrame, others: DataFrame, name: str) -> str:
    """How NAF does next to another algorithm, as a sentence."""
    naf = naf.loc[others.index]
    above, below = naf.return_low > others.return_high, naf.return_high < others.return_low
    verdicts = {
        f"every seed of NAF ends above every seed of {name}": above,
        f"every seed of NAF ends below every seed of {name}": below,
        f"the ranges of the seeds of NAF and {name} overlap": ~(above | below),
    }
    parts = (f"{verdict} on {', '.join(others.index[where])}" for verdict, where in verdicts.items() if where.any())
    text = "; ".join(parts)
    return f"{text[0].upper()}{text[1:]}."


def figure(rows: DataFrame) -> Figure:
    """Return along the longest trainings: median and range of the seeds."""
    tasks = [task for task, of in TASKS.items() if of.steps == 100_000]
    plain = rows[rows["task"].isin(tasks) & rows.algorithm.isin(["NAF", *OTHERS])]
    courses = over_seeds(plain, "task", "algorithm", "steps")
    drawn = line_panels(courses, "task", "steps", "return", "algorithm")
    for axis in drawn.axes:
        axis.xaxis.set_major_formatter(EngFormatter(sep=""))
    return drawn


def returns(rows: DataFrame) -> str:
    """Returns at the end of the trainings."""
    found = over_seeds(ends(rows), "task", "algorithm")
    found["steps"] = [TASKS[task].steps for task in found["task"]]
    columns = ["task", "algorithm", "steps", "seeds", "return", "return_low", "return_high", "v_over_bound"]
    caption = f"Mean return of a training's last {RECENT} evaluations: median, lowest and highest seed."
    return table(found, columns, caption, **{"return": ".1f", "v_over_bound": ".2f"})
