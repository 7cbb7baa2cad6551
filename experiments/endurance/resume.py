"""What resuming costs: processor time to replay a whole training, with nothing simulated."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from experiments.record import Row
from sarah.episode.settings import EpisodeConfig
from sarah.runs.config import ALGORITHMS, TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.physics import Physics
from sarah.training.train import train

# What is replayed does not depend on how long or how finely it was simulated.
SHORT = EpisodeConfig(time_limit=1.1, physics=Physics(rate=50, solver_iterations=5, control_rate=50))


@dataclass(frozen=True)
class Resume:
    """First Trainings that are finished, and resumed.

    :param algorithms: names of the algorithms
    :param budget: number of episodes of a training
    """

    algorithms: tuple[str, ...] = ALGORITHMS
    budget: int = 100

    def rows(self) -> Iterator[Row]:
        """A row for each algorithm.

        :raises SystemExit: if a replayed training ends with other parameters
        """
        for algo in self.algorithms:
            with tempfile.TemporaryDirectory() as folder:
                config = TrainingConfig(algo=algo, episodes=self.budget, episode=SHORT)
                run = RunFolder.create(Path(folder) / "run", config)
                train(config, run)
                learned = run.parameters()
                start = time.process_time()
                train(config, run)
                seconds = time.process_time() - start
                if run.parameters() != learned:
                    raise SystemExit(f"{algo}: a replayed training ends with other parameters")
                yield {
                    "algorithm": algo,
                    "episodes": self.budget,
                    "replayed_in_s": round(seconds, 1),
                    "journal_kb": round(run.journal_path.stat().st_size / 1000),
                }
