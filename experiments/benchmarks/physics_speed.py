"""Times episodes at each setting of the physics whose scores are compared."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass

from experiments.record import Row
from experiments.robot.physics import SETTINGS
from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.episode import simulate
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec


@dataclass(frozen=True)
class PhysicsSpeed:
    """Simulated seconds per second of processor time.

    :param episodes: number of episodes at each setting, after one that warms up
    :param time_limit: time limit of an episode, in s
    """

    episodes: int = 2
    time_limit: float = 12.0

    def rows(self) -> Iterator[Row]:
        """A row for each setting."""
        for name, (engine, physics) in SETTINGS.items():
            config = EpisodeConfig(physics, engine, time_limit=self.time_limit)
            specs = [EpisodeSpec(PAPER_STEPPING, seed, config=config) for seed in range(self.episodes)]
            simulate(specs[0])
            start = time.process_time()
            simulated = sum(simulate(spec).duration for spec in specs)
            yield {"setting": name, "times_real_time": round(simulated / (time.process_time() - start))}
