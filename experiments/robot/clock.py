"""Can a learner use the time-outs as a clock?

Random parameters, and the fastest clocks that there are, with slow and with fast time-outs.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass

from pandas import DataFrame

from experiments.experiment import Experiment, product
from experiments.record import Row
from experiments.tables import table
from sarah.control.constants import ControllerConstants
from sarah.episode.episode import simulate
from sarah.episode.evaluation import SMALLEST_SENSOR_SHARE
from sarah.episode.result import EpisodeResult
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec

CLOCKS = ((0.05, 2.0, 2.0, 0.0, 0.0), (0.2, 0.0, 2.0, 0.0, 0.0), (1.0, 1.0, 1.0, 0.0, 0.0), (1.5, 0.5, 0.1, 0.0, 0.0))
"""The fastest clocks that there are: conditions that are never met, and the shortest time-outs."""
TIME_OUTS = (ControllerConstants().time_out_seconds, 0.3)
"""The project's own, and a faster one that lets clocks in, in s."""


@dataclass(frozen=True)
class Clock(Experiment):
    """Random P1 to P5 and clocks with two time-outs."""

    random_sets: int = 40  # number of random parameter sets
    time_limit: float = 30.0  # time limit of an episode, in s

    def cases(self) -> list[Row]:
        """Both time-outs."""
        return product(time_out_s=TIME_OUTS)

    def rows(self, time_out_s: float) -> Iterator[Row]:
        """How many sets score above 0.5, how many of them are clocks, and the best clock."""
        generator = random.Random(0)
        drawn = [tuple(generator.uniform(0.0, 2.0) for _ in range(5)) for _ in range(self.random_sets)]
        constants = ControllerConstants(time_out_seconds=time_out_s)
        config = EpisodeConfig(engine="pybullet", controller=constants, time_limit=self.time_limit)
        sets = enumerate((*drawn, *CLOCKS))
        results = [simulate(EpisodeSpec(parameters, seed, config=config)) for seed, parameters in sets]
        good = [result for result in results[: self.random_sets] if result.score > 0.5]
        yield {
            "sets_above_half": len(good),
            "clocks_above_half": sum(map(_is_clock, good)),
            "best_clock_score": max((result.score for result in results if _is_clock(result)), default=0.0),
        }


FULL = Clock()
QUICK = Clock(random_sets=1, time_limit=2.0)


def _is_clock(result: EpisodeResult) -> bool:
    """Whether time-outs rather than sensors ended the phases of an episode."""
    return min(result.shifts_by_sensors, result.lifts_by_sensors) < SMALLEST_SENSOR_SHARE


def answer(rows: DataFrame) -> str:
    """What the best clocks score."""
    slow, fast = (
        f"of {row.time_out_s} s the best clock scores {row.best_clock_score:.2f}" for row in rows.itertuples()
    )
    return f"Hardly: with time-outs {slow}, and these are the time-outs here. With time-outs {fast}."


def clocks(rows: DataFrame) -> str:
    """Sets and clocks that score above 0.5."""
    caption = (
        f"How many of {FULL.random_sets} random sets of P1 to P5 score above 0.5 in PyBullet, how many of these are "
        f"clocks, and the best score of any clock: one episode of {FULL.time_limit:.0f} s each."
    )
    return table(rows, list(rows), caption, time_out_s=".1f", score=".2f")
