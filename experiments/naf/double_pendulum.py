"""Does V exceed what rewards allow on a double pendulum, as published and as it is here?"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import ClassVar

from pandas import DataFrame

from experiments.experiment import Experiment, product
from experiments.naf.learners import PUBLISHED, course
from experiments.record import Row
from experiments.shapes import groups
from experiments.tables import share_of, shown, so_far, span, table

TASK = "InvertedDoublePendulum-v5"
LIMIT = 1.0
"""V over its bound that no true value exceeds."""


@dataclass(frozen=True)
class DoublePendulum(Experiment):
    """Trainings with V in the targets and with W."""

    depends_on: ClassVar[tuple[str, ...]] = ("agents",)
    steps: int = 6_000  # of a training
    seeds: int = 3  # number of trainings of each algorithm
    episodes: int = 5  # of an evaluation
    evaluations: int = 3  # along a training, the last at its end

    def cases(self) -> list[Row]:
        """Each training, both algorithms of a seed one after the other."""
        return product(seed=range(self.seeds), algorithm=["NAF", PUBLISHED])

    def rows(self, seed: int, algorithm: str) -> Iterable[Row]:
        """The course of a training."""
        return course(algorithm, TASK, seed, self.steps, self.evaluations, self.episodes)


FULL = DoublePendulum()
QUICK = DoublePendulum(steps=120, seeds=1, episodes=1, evaluations=1)


def ends(rows: DataFrame) -> DataFrame:
    """The last row of each training."""
    return rows.groupby(["seed", "algorithm"], sort=False).tail(1)


def answer(rows: DataFrame) -> str:
    """In how many trainings V exceeds what rewards allow, and what is learned by then."""
    found = groups(ends(rows), "algorithm")
    naf, published = found["NAF"], found[PUBLISHED]
    above = share_of(int((published.v_over_bound > LIMIT).sum()), len(published), "trainings")
    seeds = so_far(min(len(naf), len(published)), FULL.seeds)
    medians = [shown(of["return"].median(), ".0f") for of in (published, naf)]
    return (
        f"On {TASK} as published, V exceeds what rewards allow within {FULL.steps:,} steps in {above}: it comes to "
        f"{span(published.v_over_bound, '.2f')} times its bound. With W in the targets it comes to at most "
        f"{shown(naf.v_over_bound.max(), '.2f')} times its bound. The median return is {medians[0]} as published, and "
        f"{medians[1]} with W (seeds: {seeds})."
    )


def returns(rows: DataFrame) -> str:
    """Each training at its end."""
    columns = ["algorithm", "seed", "steps", "return", "v_over_bound"]
    found = ends(rows).sort_values(["algorithm", "seed"])
    caption = f"Return on {TASK} at the end of each training, and V over its bound so far, of which 1 is the limit."
    return table(found, columns, caption, **{"return": ".0f", "v_over_bound": ".2f"})
