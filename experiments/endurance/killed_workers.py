"""A training whose workers are killed again and again ends with the same bytes as one that is left alone."""

from __future__ import annotations

import tempfile
import threading
import time
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from experiments.endurance.worker_processes import worker_processes
from experiments.record import Row
from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.spec import EpisodeSpec
from sarah.episode.workers import Workers
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.training.train import train

WORKERS = 2


@dataclass(frozen=True)
class KilledWorkers:
    """A First Training with two workers, one of which is killed now and then.

    :param budget: number of episodes of the training
    :param seconds_between_kills: time from one kill to the next, in s
    """

    budget: int = 200
    seconds_between_kills: float = 20.0

    def rows(self) -> Iterator[Row]:
        """One row.

        :raises SystemExit: if the training ends with other bytes than the one that is left alone
        """
        config = TrainingConfig(episodes=self.budget)
        with tempfile.TemporaryDirectory() as folder:
            alone, expected = trained(config, Path(folder, "alone"), None)
            killer = Killer(self.seconds_between_kills)
            disturbed, found = trained(config, Path(folder, "disturbed"), killer)
        if found != expected:
            raise SystemExit(f"after {killer.killed} killed workers the training ends with other bytes")
        yield {
            "episodes": self.budget,
            "seconds_between_kills": f"{self.seconds_between_kills:g}",
            "workers_killed": killer.killed,
            "time_s": round(disturbed),
            "longer": disturbed / alone - 1.0,
        }


@dataclass
class Killer:
    """Kills worker processes in turn, from a thread.

    :param seconds: time from one kill to the next, in s
    """

    seconds: float
    killed: int = 0
    done: threading.Event = field(default_factory=threading.Event)

    def run(self, workers: Workers) -> None:
        """Kill until all is done.

        :param workers: whose processes are killed
        """
        while not self.done.wait(self.seconds):
            processes = worker_processes(workers)
            if processes:  # not all of them are restarting
                processes[self.killed % len(processes)].kill()
                self.killed += 1


def trained(config: TrainingConfig, folder: Path, killer: Killer | None) -> tuple[float, list[bytes]]:
    """Train with two workers.

    :param config: settings of the training
    :param folder: its run folder
    :param killer: who kills workers meanwhile
    :return: time in s, and the bytes of what was learned
    """
    with Workers(WORKERS) as workers:
        list(workers.simulate_all([EpisodeSpec(PAPER_STEPPING, seed) for seed in range(2 * WORKERS)]))  # warm up
        thread = threading.Thread(target=killer.run, args=(workers,), daemon=True) if killer else None
        start = time.perf_counter()
        if thread:
            thread.start()
        run = RunFolder.create(folder, config)
        train(config, run, workers)
        elapsed = time.perf_counter() - start
        if killer and thread:
            killer.done.set()
            thread.join()
    weights = zipfile.ZipFile(run.model_path).read("policy.pth")
    return elapsed, [weights, *((folder / name).read_bytes() for name in ("episodes.csv", "parameters.json"))]
