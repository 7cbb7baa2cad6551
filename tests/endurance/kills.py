"""Does a training that is killed at random moments end as without?

A training is a process forked from this one, which has everything loaded. So kills (SIGKILL) fall into the training,
while it makes its folder, reads or writes the journal, learns, or replaces files.
"""

import multiprocessing
import random
import shutil
import tempfile
import time
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pandas import DataFrame
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

from benchmarks.timing import Timing
from experiments.experiment import TRAINING
from experiments.record import ResultError, Row
from experiments.tables import table
from sarah.episode.settings import EpisodeConfig
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.physics import Physics
from sarah.training.train import train

EPISODES = 50
"""Budget of a training; agents learn from the episodes after the warm-up, 6 or 30."""
SHORT = EpisodeConfig(time_limit=2.0, physics=Physics(rate=100, solver_iterations=5))
MOST_KILLS = 3
"""Largest number of kills of a training."""
FORK = multiprocessing.get_context("fork")


@dataclass(frozen=True)
class Kills(Timing):
    """Trainings by several algorithms, each killed at random moments.

    :param algorithms: names of the algorithms
    :param trainings: number of trainings of each
    """

    depends_on = TRAINING
    algorithms: tuple[str, ...] = ("naf", "cma-es", "td3", "tpe")
    trainings: int = 3

    def cases(self) -> list[Row]:
        return [{"algorithm": algorithm} for algorithm in self.algorithms]

    def rows(self, algorithm: str) -> Iterator[Row]:
        yield {"trainings": self.trainings, "kills": sum(kills(algorithm, seed) for seed in range(self.trainings))}


FULL = Kills()
QUICK = Kills(algorithms=("naf",), trainings=1)


def kills(algorithm: str, seed: int) -> int:
    """Number of kills of a training, which ends with the same bytes as without them."""
    config = TrainingConfig(algo=algorithm, episodes=EPISODES, seed=seed, slots=3, episode=SHORT)
    generator, count = random.Random(seed), 0
    with tempfile.TemporaryDirectory() as folder:
        whole, cut = Path(folder, "whole"), Path(folder, "cut")
        start = time.perf_counter()
        trained(config, whole, None)
        seconds = time.perf_counter() - start
        while not trained(config, cut, generator.uniform(0.0, seconds) if count < MOST_KILLS else None):
            count += 1
        expected, found = left_behind(whole), left_behind(cut)
    if different := [name for name, value in expected.items() if found.get(name) != value]:
        raise ResultError(f"{algorithm}, seed {seed}, killed {count} times: {', '.join(different)} differ")
    return count


def trained(config: TrainingConfig, folder: Path, seconds: float | None) -> bool:
    """Train in a process of its own, which is killed after some seconds; whether it finished before."""
    process = FORK.Process(target=begin_or_resume, args=(config, folder))
    process.start()
    process.join(seconds)
    if process.exitcode is None:
        process.kill()
        process.join()
        return False
    if process.exitcode:
        raise ResultError(f"{config.algo}, seed {config.seed}: a training failed")
    return True


def begin_or_resume(config: TrainingConfig, folder: Path) -> None:
    """Train until something kills the process."""
    if (folder / "config.yaml").exists():
        run = RunFolder.open(folder, unfinished=True)
    else:  # killed before there was anything to resume
        shutil.rmtree(folder, ignore_errors=True)
        run = RunFolder.create(folder, config)
    train(config, run)


def left_behind(folder: Path) -> dict[str, Any]:
    """Everything of a run folder but the time of day."""
    names = ("episodes.csv", "recommendations.csv", "progress.csv", "parameters.json")
    found: dict[str, Any] = {name: (folder / name).read_bytes() for name in names}
    if (folder / "model.zip").exists():
        archive = zipfile.ZipFile(folder / "model.zip")
        found |= {name: archive.read(name) for name in archive.namelist() if name.endswith(".pth")}
    (events,) = folder.glob("events.out.tfevents.*")
    curves = EventAccumulator(str(events), size_guidance={"scalars": 0})
    curves.Reload()
    tags = curves.Tags()["scalars"]
    return found | {tag: [(event.step, event.value) for event in curves.Scalars(tag)] for tag in tags}


def counts(rows: DataFrame) -> str:
    """How often trainings were killed."""
    caption = f"Trainings of {EPISODES} episodes that ended with the same bytes as without kills, and their kills."
    return table(rows, ["algorithm", "trainings", "kills"], caption)
