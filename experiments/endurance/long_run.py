"""Does a long run stay flat? Memory and open files over many episodes in one process, and over a training with workers.

Episodes are short ones: what leaks does so with every world that is built, not with every second simulated.
"""

from __future__ import annotations

import gc
import tempfile
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import psutil

from experiments.endurance.worker_processes import worker_processes
from experiments.record import Row
from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.episode import simulate
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.workers import Workers
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.physics import Physics
from sarah.training.train import train

SHORT = EpisodeConfig(time_limit=1.3, physics=Physics(rate=100, solver_iterations=5))
LOOK_SECONDS = 0.2
"""Time between looks at how far a training is, in s."""
LOOKS = 8
"""Number of rows of a training, after the one at its beginning."""
LARGEST_GROWTH = 20.0
"""Growth of a process's memory, in MiB, beyond which it is not flat."""


@dataclass(frozen=True)
class LongProcess:
    """Many episodes in this process: memory and open files after a tenth of them and in the end.

    :param episodes: number of episodes
    """

    episodes: int = 2000

    def rows(self) -> Iterator[Row]:
        """Two rows.

        :raises SystemExit: if memory grows
        """
        begin = self.episodes // 10
        memory = []
        for index in range(self.episodes):
            simulate(EpisodeSpec(PAPER_STEPPING, index, config=SHORT))
            if index + 1 in (begin, self.episodes):
                gc.collect()
                row = usage(psutil.Process())
                memory.append(row[0])
                yield {"episodes": index + 1, "memory_mib": memory[-1], "open_files": row[1]}
        if memory[-1] - memory[0] > LARGEST_GROWTH:
            raise SystemExit(f"{self.episodes - begin} episodes left {memory[-1] - memory[0]:.0f} MiB behind")


@dataclass(frozen=True)
class LongTraining:
    """A First Training with two workers: memory and open files of the three processes along the way.

    :param budget: number of episodes
    """

    budget: int = 400

    def rows(self) -> Iterator[Row]:
        """A row for the beginning and for each eighth of the training."""
        with tempfile.TemporaryDirectory() as folder, Workers(2) as workers:
            config = TrainingConfig(episodes=self.budget, episode=SHORT)
            run = RunFolder.create(Path(folder) / "run", config)
            rows: list[Row] = []
            done = threading.Event()
            watcher = threading.Thread(target=watch, args=(run, workers, self.budget // LOOKS, rows, done))
            watcher.start()
            train(config, run, workers)
            done.set()
            watcher.join()
        yield from rows


def watch(run: RunFolder, workers: Workers, interval: int, rows: list[Row], done: threading.Event) -> None:
    """Add a row whenever a training has gone on for some episodes.

    :param run: run folder of the training
    :param workers: its workers
    :param interval: number of episodes between rows
    :param rows: list of the rows
    :param done: set when the training is over
    """
    while not done.wait(LOOK_SECONDS):
        if sum(1 for _ in run.episodes()) < interval * len(rows):
            continue
        (memory, files), first, second = map(usage, (psutil.Process(), *worker_processes(workers)))
        rows.append(
            {
                "episodes": interval * len(rows),
                "training_memory_mib": round(memory),
                "training_open_files": files,
                "worker_1_memory_mib": round(first[0]),
                "worker_2_memory_mib": round(second[0]),
                "worker_1_open_files": first[1],
                "worker_2_open_files": second[1],
            }
        )


def usage(process: psutil.Process) -> tuple[float, int]:
    """Resident memory in MiB, and open files.

    :param process: a process
    """
    return process.memory_info().rss / 2**20, process.num_fds()
