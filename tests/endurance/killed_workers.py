"""What do killed workers cost a training?

A training whose workers are killed again and again ends with the same bytes as one that is left alone.
"""

import os
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import psutil
from pandas import DataFrame

from benchmarks.timing import Timing
from experiments.experiment import TRAINING
from experiments.record import ResultError, Row
from experiments.tables import table
from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.spec import EpisodeSpec
from sarah.episode.workers import Workers
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.training.train import train

from .kills import left_behind

WORKERS = 2


@dataclass(frozen=True)
class KilledWorkers(Timing):
    """A First Training with two workers, one of which is killed now and then.

    :param budget: number of episodes of the training
    :param seconds_between_kills: time from one kill to the next, in s
    """

    depends_on = TRAINING
    budget: int = 200
    seconds_between_kills: float = 20.0

    def cases(self) -> list[Row]:
        return [{"episodes": self.budget, "seconds_between_kills": self.seconds_between_kills}]

    def rows(self, episodes: int, seconds_between_kills: float) -> Iterator[Row]:
        with tempfile.TemporaryDirectory() as folder, Workers(WORKERS) as workers:
            list(workers.simulate_all([EpisodeSpec(PAPER_STEPPING, seed) for seed in range(2 * WORKERS)]))  # warm up
            alone, disturbed = Path(folder, "alone"), Path(folder, "disturbed")
            usual = seconds_of_training(episodes, alone, workers, lambda: False)
            killer = Killer(workers, seconds_between_kills)
            seconds = seconds_of_training(episodes, disturbed, workers, killer)
            if left_behind(alone) != left_behind(disturbed):
                raise ResultError(f"after {killer.killed} killed workers the training ends with other bytes")
        yield {"workers_killed": killer.killed, "time_s": seconds, "longer": seconds / usual - 1.0}


FULL = KilledWorkers()
QUICK = KilledWorkers(budget=8, seconds_between_kills=60.0)


@dataclass
class Killer:
    """Kills worker processes in turn.

    :param workers: workers whose processes are killed
    :param seconds: time from one kill to the next, in s
    """

    workers: Workers
    seconds: float
    killed: int = 0
    last: float = field(default_factory=time.monotonic)

    def __call__(self) -> bool:
        """Kill, if it is time. The training, which asks whether to stop, goes on."""
        if time.monotonic() - self.last > self.seconds and (processes := worker_processes(self.workers)):
            processes[self.killed % len(processes)].kill()
            self.killed += 1
            self.last = time.monotonic()
        return False


def seconds_of_training(episodes: int, folder: Path, workers: Workers, interrupted: Callable[[], bool]) -> float:
    """Train; the time that it takes, in s."""
    config = TrainingConfig(episodes=episodes)
    start = time.perf_counter()
    train(config, RunFolder.create(folder, config), workers, interrupted=interrupted)
    return time.perf_counter() - start


def cost(rows: DataFrame) -> str:
    """Kills, and how much longer the training took."""
    formats = {"kills": ".0f", "_s": ".0f", "longer": ".0%"}
    return table(rows, list(rows.columns), "A First Training with two workers, which were killed in turn.", **formats)


def worker_processes(workers: Workers) -> list[psutil.Process]:
    """Processes of workers of this machine that are ready to simulate, in the order of their ids."""
    assert workers.client is not None
    return [psutil.Process(pid) for pid in sorted(workers.client.run(os.getpid, on_error="ignore").values())]
