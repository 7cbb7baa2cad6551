"""What does it cost to resume a training?

Processor time to replay a whole First Training, with nothing simulated.
"""

import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from pandas import DataFrame

from benchmarks.timing import Timing
from experiments.experiment import TRAINING
from experiments.record import ResultError, Row
from experiments.tables import table
from sarah.episode.settings import EpisodeConfig
from sarah.runs.config import ALGORITHMS, TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.physics import Physics
from sarah.training.train import train

# What is replayed does not depend on how long or how finely it was simulated.
SHORT = EpisodeConfig(time_limit=1.1, physics=Physics(rate=50, solver_iterations=5, control_rate=50))


@dataclass(frozen=True)
class Resume(Timing):
    """First Trainings that are finished, and resumed.

    :param algorithms: names of the algorithms
    :param budget: number of episodes of a training
    """

    depends_on = TRAINING
    algorithms: tuple[str, ...] = ALGORITHMS
    budget: int = 100

    def cases(self) -> list[Row]:
        return [{"algorithm": algorithm} for algorithm in self.algorithms]

    def rows(self, algorithm: str) -> Iterator[Row]:
        config = TrainingConfig(algo=algorithm, episodes=self.budget, episode=SHORT)
        with tempfile.TemporaryDirectory() as folder:
            run = RunFolder.create(Path(folder) / "run", config)
            train(config, run)
            learned = run.parameters()
            start = time.process_time()
            train(config, run)
            seconds = time.process_time() - start
            if run.parameters() != learned:
                raise ResultError(f"{algorithm}: a replayed training ends with other parameters")
            yield {"replayed_in_s": seconds, "journal_kb": run.journal_path.stat().st_size / 1000}


FULL = Resume()
QUICK = Resume(algorithms=("cma-es",), budget=5)


def costs(rows: DataFrame) -> str:
    """Time and size for each algorithm."""
    caption = f"Processor time to replay a First Training of {FULL.budget} episodes, and the size of its journal."
    return table(rows, ["algorithm", "replayed_in_s", "journal_kb"], caption, replayed_in_s=".1f")
