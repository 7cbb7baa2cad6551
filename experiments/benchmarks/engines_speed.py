"""Times whole episodes in each physics engine, from building the world to the result.

The engines take turns, so that whatever else the machine does slows both; the ratio is the median of the rounds'.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass
from statistics import median

from experiments.record import Row
from sarah.episode.episode import simulate
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks.balance import TRAINED_STEPPING
from sarah.simulation.engines import Engine


@dataclass(frozen=True)
class EnginesSpeed:
    """Processor time of an episode in MuJoCo against that in PyBullet.

    :param rounds: number of episodes in each engine, after one that warms up
    :param time_limit: time limit of an episode, in s
    """

    rounds: int = 10
    time_limit: float = 30.0

    def rows(self) -> Iterator[Row]:
        """One row."""
        ratios = []
        for seed in range(-1, self.rounds):
            mujoco, pybullet = (
                times_real_time(engine, max(seed, 0), self.time_limit) for engine in ("mujoco", "pybullet")
            )
            if seed >= 0:
                ratios.append(mujoco / pybullet)
        yield {
            "rounds": self.rounds,
            "mujoco_over_pybullet": median(ratios),
            "mujoco_over_pybullet_low": min(ratios),
            "mujoco_over_pybullet_high": max(ratios),
        }


def times_real_time(engine: Engine, seed: int, limit: float) -> float:
    """Simulated seconds per second of processor time.

    :param engine: physics engine
    :param seed: seed of the episode
    :param limit: its time limit, in s
    """
    spec = EpisodeSpec(TRAINED_STEPPING, seed, config=EpisodeConfig(engine=engine, time_limit=limit))
    start = time.process_time()
    return simulate(spec).duration / (time.process_time() - start)
