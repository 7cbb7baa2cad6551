"""Where does NAF stand among four algorithms on MuJoCo tasks, and what do its parts do there?

The defaults of each class; NAF without its parts; TD3 and DDPG with settings of NAF; one long run of each algorithm.

Sizes follow from speed: on one core of our machine NAF makes 130 steps per second, and DDPG, TD3 and SAC make 65 to 75.
With 15,000 steps the comparison of the four takes six core hours on five tasks and one and a half on Ant, NAF's parts
two, and the trainings with NAF's settings three. The runs of 300,000 steps take four more hours for one seed each, so
they come last.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter
from pandas import DataFrame, Series

from experiments.experiment import Experiment
from experiments.interquartile import improvement, interquartile_mean
from experiments.naf.learners import COMPARED, WITH_NAFS_SETTINGS, WITHOUT, course
from experiments.record import Row
from experiments.shapes import groups, line_panels
from experiments.tables import shown, so_far, table, turned_table

RECENT = 3
"""Number of evaluations that are the end of a training: one alone says little, as returns swing."""
FIVE = ("HalfCheetah-v5", "Hopper-v5", "Walker2d-v5", "Reacher-v5", "Swimmer-v5")
"""Tasks with two to six actions, on which an earlier version was tried."""
EIGHT_ACTIONS = ("Ant-v5",)
TASKS = (*FIVE, *EIGHT_ACTIONS)
PART_TASKS = ("HalfCheetah-v5", "Hopper-v5")
"""One where the earlier version did well, and one where it did not."""
SETTINGS_TASKS = (*PART_TASKS, "Reacher-v5")
SHORT = {"Reacher-v5": 5}
"""How many times as many evaluation episodes a task has whose episodes are short, and differ by their goal."""
STEPS = 15_000
SEEDS = range(5)
LONG_STEPS = 300_000
LONG_SEED = 5
ABOVE, BELOW = "above", "below"


class Trainings(NamedTuple):
    """Trainings of the same length."""

    tasks: tuple[str, ...]
    algorithms: tuple[str, ...]
    steps: int = STEPS
    seeds: Sequence[int] = SEEDS


TRAININGS = (
    Trainings(FIVE, ("NAF", "TD3", "SAC")),
    Trainings(FIVE, ("DDPG",)),
    Trainings(PART_TASKS, tuple(WITHOUT)),
    Trainings(SETTINGS_TASKS, tuple(WITH_NAFS_SETTINGS)),
    Trainings(EIGHT_ACTIONS, tuple(COMPARED)),
    Trainings(("HalfCheetah-v5",), tuple(COMPARED), LONG_STEPS, (LONG_SEED,)),
)
"""The most telling first; within each, the first seed of all tasks first."""


@dataclass(frozen=True)
class MujocoTasks(Experiment):
    """Trainings on tasks with two to eight actions."""

    depends_on: ClassVar[tuple[str, ...]] = ("agents",)
    tasks: tuple[str, ...] = TASKS  # names of the tasks
    steps: int | None = None  # of a training; by default those of its kind
    seeds: int | None = None  # number of trainings of each kind; by default all
    episodes: int = 5  # of an evaluation
    evaluations: int = 10  # along a training, the last at its end

    def cases(self) -> list[Row]:
        """Each training."""
        return [
            {"task": task, "algorithm": algorithm, "seed": seed}
            for of in TRAININGS
            for seed in of.seeds[: self.seeds]
            for task in of.tasks
            if task in self.tasks
            for algorithm in of.algorithms
        ]

    def rows(self, task: str, algorithm: str, seed: int) -> Iterable[Row]:
        """The course of a training."""
        steps = self.steps or (LONG_STEPS if seed == LONG_SEED else STEPS)
        return course(algorithm, task, seed, steps, self.evaluations, self.episodes * SHORT.get(task, 1))


FULL = MujocoTasks()
QUICK = MujocoTasks(tasks=("Reacher-v5",), steps=120, seeds=1, episodes=1, evaluations=1)


def ends(rows: DataFrame) -> DataFrame:
    """A row for each training: means of its last evaluations."""
    trainings = rows.groupby(["task", "algorithm", "seed"], sort=False)
    last = trainings.tail(RECENT).groupby(["task", "algorithm", "seed"], sort=False)
    return last.agg({"steps": "max", "return": "mean", "v_over_bound": "max"}).reset_index()


def answer(rows: DataFrame) -> str:
    """How NAF does next to each of the other algorithms, and how near V comes to its bound."""
    found = ends(rows[rows.seed.isin(SEEDS)])
    naf = found[found.algorithm == "NAF"]
    nearest = naf.sort_values("v_over_bound").iloc[-1]
    compared = {other: _compared(naf, found[found.algorithm == other], other) for other in COMPARED if other != "NAF"}
    sentences = [said for said in compared.values() if said]
    if sentences:
        sentences[0] = f"After {STEPS:,} steps {sentences[0]}"
    if few := [other for other, said in compared.items() if not said]:
        sentences.append(f"Seeds are missing so far to compare {', '.join(few)}.")
    ratio = f"V comes to {shown(nearest.v_over_bound, '.2f')} of its bound at most, on {nearest['task']}."
    return " ".join([*sentences, ratio])


def _compared(naf: DataFrame, others: DataFrame, name: str) -> str:
    """Where NAF is above another algorithm and where below, and how likely a seed is above."""
    pairs = _pairs(naf, others)
    if not pairs:
        return ""
    listed = ", and ".join(f"{verdict} {name} on {', '.join(where)}" for verdict, where in _verdicts(pairs).items())
    chance = improvement(*zip(*pairs.values(), strict=True))
    middle, *ends_of_it = (shown(value, ".2f") for value in chance)
    return (
        f"NAF is {listed}. A seed of NAF is above one of {name} with a probability of {middle} "
        f"({' to '.join(ends_of_it)})."
    )


def _pairs(naf: DataFrame, others: DataFrame) -> dict[str, tuple[Series, Series]]:
    """Returns of the seeds of NAF and of another algorithm by task, of those tasks where no seed is missing."""
    ones, of_others = (
        {task: of["return"] for task, of in groups(all_seeds, "task").items() if len(of) >= len(SEEDS)}
        for all_seeds in (naf, others)
    )
    return {task: (ones[task], of_others[task]) for task in TASKS if task in ones and task in of_others}


def _verdicts(pairs: dict[str, tuple[Series, Series]]) -> dict[str, list[str]]:
    """Tasks by whether the interval of NAF is above that of the other algorithm or below."""
    verdicts: dict[str, list[str]] = {}
    for task, pair in pairs.items():
        (_, low, high), (_, other_low, other_high) = map(interquartile_mean, pair)
        verdict = ABOVE if low > other_high else BELOW if high < other_low else "not told apart from"
        verdicts.setdefault(verdict, []).append(task)
    return verdicts


def parts_answer(rows: DataFrame) -> str:
    """From which of its variants NAF is told apart."""
    return _told_apart(rows, WITHOUT)


def settings_answer(rows: DataFrame) -> str:
    """From which of the algorithms with its settings NAF is told apart."""
    return _told_apart(rows, WITH_NAFS_SETTINGS)


def _told_apart(rows: DataFrame, names: Iterable[str]) -> str:
    """What NAF is above and what below, of those of which no seed is missing on some task."""
    found = ends(rows[rows.seed.isin(SEEDS)])
    by_name = {name: _pairs(found[found.algorithm == "NAF"], found[found.algorithm == name]) for name in names}
    verdicts = {name: _verdicts(pairs) for name, pairs in by_name.items() if pairs}
    told = [
        f"{verdict} '{name}' on {', '.join(of[verdict])}"
        for verdict in (ABOVE, BELOW)
        for name, of in verdicts.items()
        if verdict in of
    ]
    if not verdicts:
        return ""
    if not told:
        return "NAF is told apart from none of them."
    return f"NAF is {', '.join(told)}. Otherwise it is not told apart from them."


def figure(rows: DataFrame) -> Figure:
    """Return along the trainings: interquartile mean of the seeds and its interval."""
    plain = rows[rows.algorithm.isin(COMPARED) & rows.seed.isin(SEEDS)]
    drawn = line_panels(_means(plain, "steps"), "task", "steps", "return", "algorithm")
    for axis in drawn.axes:
        axis.xaxis.set_major_formatter(EngFormatter(sep=""))
        axis.tick_params(axis="x", labelsize="x-small")  # the panels are narrow
    return drawn


def _means(rows: DataFrame, *more: str) -> DataFrame:
    """Interquartile means of the returns of each task and algorithm, in their order.

    :param more: further columns that tell the means apart
    """
    found: list[Row] = []
    keys = ["task", "algorithm", *more]
    for values, of in groups(rows, *keys).items():
        mean, *interval = interquartile_mean(of["return"])
        low, high = interval if len(of) >= len(SEEDS) else (math.nan, math.nan)
        about = {**dict(zip(keys, values, strict=True)), "seeds": so_far(len(of), len(SEEDS))}
        ratio = of.v_over_bound.max()
        found.append({**about, "return": mean, "return_low": low, "return_high": high, "v_over_bound": ratio})
    orders = {"task": TASKS, "algorithm": (*COMPARED, *WITHOUT, *WITH_NAFS_SETTINGS)}
    return DataFrame(found).sort_values(
        keys, key=lambda column: column.map(orders[column.name].index) if column.name in orders else column
    )


def four_algorithms(rows: DataFrame) -> str:
    """The four algorithms on all tasks."""
    return _table(rows, COMPARED, TASKS)


def parts(rows: DataFrame) -> str:
    """NAF without its own parts."""
    return _table(rows, WITHOUT, PART_TASKS, beside=("NAF",))


def same_settings(rows: DataFrame) -> str:
    """The other algorithms with settings of NAF."""
    return _table(rows, WITH_NAFS_SETTINGS, SETTINGS_TASKS, beside=COMPARED)


def _table(rows: DataFrame, algorithms: Collection[str], tasks: Collection[str], beside: Collection[str] = ()) -> str:
    """Ends of trainings: interquartile means over seeds.

    :param beside: further algorithms, which alone make no table
    """
    found = ends(rows[rows.algorithm.isin([*algorithms, *beside]) & rows["task"].isin(tasks) & rows.seed.isin(SEEDS)])
    if not found.algorithm.isin(algorithms).any():
        return "*Still to be made.*"
    columns = ["task", "algorithm", "seeds", "return", "return_low", "return_high", "v_over_bound"]
    caption = (
        f"Mean return of the last {RECENT} evaluations in {STEPS:,} steps: interquartile mean and its 95 % interval."
    )
    return table(_means(found), columns, caption, **{"return": ".1f", "v_over_bound": ".2f"})


def long_runs(rows: DataFrame) -> str:
    """The course of one long run of each algorithm."""
    long = rows[rows.seed == LONG_SEED]
    if not len(long):
        return f"The runs of {LONG_STEPS:,} steps are still to be made."
    task, highest = long["task"].iloc[0], long.v_over_bound.max()
    caption = f"Return along one long run of each algorithm on {task}. V comes to {highest:.2f} of its bound at most."
    return turned_table(long.sort_values("steps", kind="stable"), ["steps"], "algorithm", "return", caption, ".0f")
