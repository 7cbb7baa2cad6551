"""Does V exceed what rewards allow on a double pendulum, and which part of NAF keeps it below?"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import ClassVar

from pandas import DataFrame

from experiments.experiment import Experiment, product
from experiments.naf.learners import AS_GU, NO_PARTS, V_IN_TARGETS, course
from experiments.naf.standard_tasks import over_seeds
from experiments.record import Row
from experiments.shapes import groups
from experiments.tables import shown, so_far, table

TASK = "InvertedDoublePendulum-v5"
LIMIT = 1.0
"""V over its bound that no true value exceeds."""
KINDS = ("NAF", V_IN_TARGETS, NO_PARTS, AS_GU)


@dataclass(frozen=True)
class DoublePendulum(Experiment):
    """Trainings with W in the targets and with V, which is then held by the other parts of NAF or by nothing."""

    depends_on: ClassVar[tuple[str, ...]] = ("agents",)
    steps: int = 6_000  # of a training
    seeds: int = 3  # number of trainings of each algorithm
    episodes: int = 5  # of an evaluation
    evaluations: int = 3  # along a training, the last at its end

    def cases(self) -> list[Row]:
        """Each training, all algorithms of a seed one after the other."""
        return product(seed=range(self.seeds), algorithm=KINDS)

    def rows(self, seed: int, algorithm: str) -> Iterable[Row]:
        """The course of a training."""
        return course(algorithm, TASK, seed, self.steps, self.evaluations, self.episodes)


FULL = DoublePendulum()
QUICK = DoublePendulum(steps=120, seeds=1, episodes=1, evaluations=1)


def ends(rows: DataFrame) -> DataFrame:
    """A row for each training: the return at its end, and the highest ratio in all of it."""
    trainings = rows.groupby(["seed", "algorithm"], sort=False)
    return trainings.agg({"steps": "last", "return": "last", "v_over_bound": "max"}).reset_index()


def answer(rows: DataFrame) -> str:
    """In how many trainings V exceeds what rewards allow, and what is learned by then."""
    found = groups(ends(rows), "algorithm")
    said = [
        f"{int((of.v_over_bound > LIMIT).sum())} of {so_far(len(of), FULL.seeds)} trainings of {name!r} "
        f"(median return {shown(of['return'].median(), '.0f')})"
        for name, of in found.items()
    ]
    return f"On {TASK}, V exceeds what rewards allow within {FULL.steps:,} steps in {'; in '.join(said)}."


def returns(rows: DataFrame) -> str:
    """The seeds of each algorithm."""
    columns = ["algorithm", "seeds", "return", "return_low", "return_high", "v_over_bound"]
    caption = (
        f"Return on {TASK} after {FULL.steps:,} steps: median, lowest and highest seed. V over its bound is the "
        f"highest in all of a training and all seeds; {LIMIT:.0f} is the limit."
    )
    return table(over_seeds(ends(rows), "algorithm"), columns, caption, **{"return": ".0f", "v_over_bound": ".2f"})
