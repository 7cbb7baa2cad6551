"""Times episodes on each kind of ground against the same episodes on the plane."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass
from statistics import median
from typing import get_args

from experiments.conditions import LEARNED
from experiments.record import Row
from experiments.rough_ground import GROUNDS, PLANE
from sarah.episode.episode import simulate
from sarah.episode.push import Push
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE
from sarah.simulation.engines import Engine
from sarah.simulation.terrain import Terrain

NAMES = ("bumps of 10 mm every 5 cm", "bumps of 10 mm every 2 cm", "bumps of 20 mm every 5 cm", "friction 0.25")
"""Grounds that are timed."""


@dataclass(frozen=True)
class TerrainSpeed:
    """Processor time of an episode, as a multiple of that on the plane right before it.

    :param episodes: number of episodes on each ground, after one that warms up
    :param time_limit: time limit of an episode, in s
    """

    episodes: int = 7
    time_limit: float = 12.0

    def rows(self) -> Iterator[Row]:
        """A row for each engine and ground."""
        engines: tuple[Engine, ...] = get_args(Engine)
        for engine in engines:
            for name in NAMES:
                self._seconds(engine, GROUNDS[name], 0)
                ratios = [
                    self._seconds(engine, GROUNDS[name], seed) / self._seconds(engine, GROUNDS[PLANE], seed)
                    for seed in range(self.episodes)
                ]
                yield {
                    "engine": engine,
                    "ground": name,
                    "time_ratio": median(ratios),
                    "time_ratio_low": min(ratios),
                    "time_ratio_high": max(ratios),
                }

    def _seconds(self, engine: Engine, terrain: Terrain, seed: int) -> float:
        """Processor time per simulated second, with all that an episode needs."""
        config = BALANCE.config_of(
            LEARNED.config, engine=engine, terrain=terrain, time_limit=self.time_limit, push=Push((0.0, 0.0))
        )
        start = time.process_time()
        result = simulate(EpisodeSpec(LEARNED.parameters, seed, BALANCE, config))
        return (time.process_time() - start) / result.duration
