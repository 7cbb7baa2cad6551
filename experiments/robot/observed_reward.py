"""Does the reward that the robot observes rank parameters as equation 2 does?"""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass
from statistics import mean
from typing import Any

import numpy as np
from pandas import DataFrame
from scipy.stats import spearmanr

from experiments.experiment import EPISODE, Experiment, product
from experiments.record import Row
from experiments.tables import span, table
from sarah.episode.from_mapping import from_mapping
from sarah.operation.settings import BOX, SHIPPED, OperationConfig, Parameters
from sarah.runs.session import SessionSpec
from sarah.simulation.engines import Engine
from sarah.training.operate import run_session

GROUNDS: dict[str, dict[str, Any]] = {
    "flat": {},
    "slope of 4 degrees": {"terrain": {"slope_degrees": 4.0, "direction_degrees": (0.0, 360.0)}},
    "slope of 8 degrees": {"terrain": {"slope_degrees": 8.0, "direction_degrees": (0.0, 360.0)}},
}
ENGINES: tuple[Engine, ...] = ("pybullet", "mujoco")
DEVIATIONS = (0.05, 0.15, 0.4)
"""Standard deviations of the sets around the shipped one, as shares of each range: near, wider, and anywhere."""
DECIMALS = 3
"""Decimals of the scores that are ranked: below them, sets of robots that do not step differ by nothing that counts."""
RESAMPLES = 1000


@dataclass(frozen=True)
class ObservedReward(Experiment):
    """Parameter sets from near the shipped one to anywhere, each on a robot of its own.

    :param sets: number of sets on each ground
    :param minutes: time that each is operated, in min
    """

    depends_on = (*EPISODE, "sarah/operation")
    sets: int = 150
    minutes: float = 0.5

    def cases(self) -> list[Row]:
        """Each ground in each engine."""
        return product(engine=ENGINES, ground=GROUNDS)

    def rows(self, engine: Engine, ground: str) -> Iterator[Row]:
        """How well one reward ranks the sets as the other does, with a bootstrap's interval over the sets."""
        robot = from_mapping(OperationConfig().robot, {"engine": engine, **GROUNDS[ground]})
        config = OperationConfig(robot, minutes=self.minutes)
        sessions = [run_session(SessionSpec(_drawn(seed), "none", seed, config)) for seed in range(self.sets)]
        scores = np.round([one.mean_score() for one in sessions], DECIMALS)
        observed = np.round([mean(window.observed_reward for window in one.windows) for one in sessions], DECIMALS)
        generator = np.random.default_rng(0)
        drawn_again = [generator.integers(self.sets, size=self.sets) for _ in range(RESAMPLES)]
        resampled = [spearmanr(scores[sets], observed[sets]).statistic for sets in drawn_again]
        low, high = np.nanquantile(resampled, (0.025, 0.975))
        yield {
            "sets": self.sets,
            "fell": sum(one.falls > 0 for one in sessions),
            "below_a_tenth": int((scores < 0.1).sum()),
            "rank_correlation": float(spearmanr(scores, observed).statistic),
            "rank_correlation_low": float(low),
            "rank_correlation_high": float(high),
            "mean_difference": float((observed - scores).mean()),
        }


def _drawn(seed: int) -> Parameters:
    """Parameters around the shipped ones."""
    generator = random.Random(f"observed {seed}")
    deviation = DEVIATIONS[seed % len(DEVIATIONS)]
    return BOX.at_shares(share + deviation * generator.gauss(0.0, 1.0) for share in BOX.shares(SHIPPED))


FULL = ObservedReward()
QUICK = ObservedReward(sets=4, minutes=0.1)


def answer(rows: DataFrame) -> str:
    """How well the observed reward ranks."""
    return (
        f"Nearly: on level ground and on slopes Spearman's rank correlation between the two is "
        f"{span(rows.rank_correlation, '.3f')}."
    )


def ranked(rows: DataFrame) -> str:
    """The rank correlations."""
    caption = (
        f"Rank correlation with its 95 % interval and mean difference between the observed reward and equation 2, of "
        f"{FULL.sets} sets of P1 to P5 and V1 to V4, with pushes of up to 50 N; how many of them fell, and how many "
        f"scored below a tenth."
    )
    shown_columns = [column for column in rows if column != "sets"]
    return table(rows, shown_columns, caption, rank_correlation=".3f", mean_difference=".3f")
