"""The pattern generator is meant to be driven by its sensors: with fast time-outs a learner can use it as a clock."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass

from experiments.maker import ParallelExperiment
from experiments.record import Row
from sarah.control.constants import ControllerConstants
from sarah.episode.evaluation import SMALLEST_SENSOR_SHARE
from sarah.episode.result import EpisodeResult
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.workers import Workers

CLOCKS = ((0.05, 2.0, 2.0, 0.0, 0.0), (0.2, 0.0, 2.0, 0.0, 0.0), (1.0, 1.0, 1.0, 0.0, 0.0), (1.5, 0.5, 0.1, 0.0, 0.0))
"""The fastest clocks that there are: conditions that are never met, and the shortest time-outs."""
TIME_OUTS = (ControllerConstants().time_out_seconds, 0.3)
"""The project's own, and a faster one that lets clocks in, in s."""


@dataclass(frozen=True)
class Clock(ParallelExperiment):
    """Random parameters, and the fastest clocks that there are, with slow and with fast time-outs.

    :param random_sets: number of random parameter sets
    :param time_limit: time limit of an episode, in s
    """

    random_sets: int = 40
    time_limit: float = 30.0

    def rows(self) -> Iterator[Row]:
        """A row for each time-out."""
        generator = random.Random(0)
        drawn = [tuple(generator.uniform(0.0, 2.0) for _ in range(5)) for _ in range(self.random_sets)]
        with Workers(self.workers) as workers:
            for seconds in TIME_OUTS:
                constants = ControllerConstants(time_out_seconds=seconds)
                config = EpisodeConfig(engine="pybullet", controller=constants, time_limit=self.time_limit)
                specs = [
                    EpisodeSpec(parameters, seed, config=config) for seed, parameters in enumerate((*drawn, *CLOCKS))
                ]
                results = list(workers.simulate_all(specs))
                good = [result for result in results[: self.random_sets] if result.score > 0.5]
                yield {
                    "time_out_s": seconds,
                    "random_sets": self.random_sets,
                    "sets_above_half": len(good),
                    "clocks_above_half": sum(map(is_clock, good)),
                    "best_clock_score": max((result.score for result in results if is_clock(result)), default=0.0),
                }


def is_clock(result: EpisodeResult) -> bool:
    """Whether time-outs rather than sensors ended the phases of an episode.

    :param result: result of the episode
    """
    return min(result.shifts_by_sensors, result.lifts_by_sensors) < SMALLEST_SENSOR_SHARE
