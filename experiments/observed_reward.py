"""The reward that the robot observes against equation 2: how well the one ranks parameters as the other does."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass
from statistics import mean
from typing import Any

import numpy as np
from scipy.stats import spearmanr

from experiments.maker import ParallelExperiment
from experiments.record import Row
from sarah.episode.from_mapping import from_mapping
from sarah.episode.workers import Workers
from sarah.operation.settings import BOX, SHIPPED, OperationConfig, Parameters
from sarah.runs.session import SessionSpec
from sarah.simulation.engines import Engine, is_installed
from sarah.training.operate import SessionResult, run_session

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
class ObservedReward(ParallelExperiment):
    """Parameter sets from near the shipped one to anywhere, each on a robot of its own.

    :param sets: number of sets on each ground
    :param minutes: time that each is operated, in min
    """

    sets: int = 150
    minutes: float = 0.5

    def rows(self) -> Iterator[Row]:
        """A row for each ground and engine."""
        with Workers(self.workers) as workers:
            for engine in filter(is_installed, ENGINES):
                for ground, settings in GROUNDS.items():
                    robot = from_mapping(OperationConfig().robot, {"engine": engine, **settings})
                    config = OperationConfig(robot, minutes=self.minutes)
                    specs = [SessionSpec(drawn(seed), "none", seed, config) for seed in range(self.sets)]
                    jobs = [workers.submit(run_session, spec) for spec in specs]
                    yield {"ground": ground, "engine": engine, **_compared([job.result() for job in jobs])}


def drawn(seed: int) -> Parameters:
    """Parameters around the shipped ones.

    :param seed: seed of the draw
    """
    generator = random.Random(f"observed {seed}")
    deviation = DEVIATIONS[seed % len(DEVIATIONS)]
    return BOX.at_shares(share + deviation * generator.gauss(0.0, 1.0) for share in BOX.shares(SHIPPED))


def _compared(sessions: list[SessionResult]) -> Row:
    scores = np.round([session.mean_score() for session in sessions], DECIMALS)
    observed = np.round([mean(window.observed_reward for window in session.windows) for session in sessions], DECIMALS)
    generator = np.random.default_rng(0)
    drawn_again = (generator.integers(len(scores), size=len(scores)) for _ in range(RESAMPLES))
    resampled = [spearmanr(scores[rows], observed[rows]).statistic for rows in drawn_again]
    low, high = np.nanquantile(resampled, (0.025, 0.975))
    return {
        "sets": len(sessions),
        "fell": sum(session.falls > 0 for session in sessions),
        "below_0_1": int((scores < 0.1).sum()),
        "rank_correlation": float(spearmanr(scores, observed).statistic),
        "rank_correlation_low": float(low),
        "rank_correlation_high": float(high),
        "mean_difference": float((observed - scores).mean()),
    }
