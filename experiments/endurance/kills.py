"""Trainings that are killed (SIGKILL) at random moments and resumed, against the same without: the same bytes.

A training is a process forked from this one, which has everything loaded: so kills fall into the training, while it
makes its folder, reads or writes the journal, learns, or replaces files.
"""

from __future__ import annotations

import multiprocessing
import random
import shutil
import tempfile
import time
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

from experiments.record import Row
from sarah.episode.settings import EpisodeConfig
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.physics import Physics
from sarah.training.train import train

EPISODES = 50
"""Budget of a training; agents learn from the episodes after the warm-up, 6 or 30."""
SHORT = EpisodeConfig(time_limit=2.0, physics=Physics(rate=100, solver_iterations=5))
ALGORITHMS = ("naf", "cma-es", "td3", "tpe")
FORK = multiprocessing.get_context("fork")


@dataclass(frozen=True)
class Kills:
    """Trainings by several algorithms, each killed until it is finished.

    :param kills: number of kills of all trainings together
    :param seed: seed of the moments
    """

    kills: int = 30
    seed: int = 0

    def rows(self) -> Iterator[Row]:
        """One row.

        :raises SystemExit: if a training ends with other bytes than without kills
        """
        generator = random.Random(self.seed)
        kills = number = 0
        with tempfile.TemporaryDirectory() as folder:
            while kills < self.kills:
                algo = ALGORITHMS[number % len(ALGORITHMS)]
                config = TrainingConfig(algo=algo, episodes=EPISODES, seed=number, slots=3, episode=SHORT)
                whole, cut = Path(folder, f"{number}-whole"), Path(folder, f"{number}-cut")
                start = time.perf_counter()
                killed_until_finished(config, whole, 0.0, generator, 0)
                seconds = time.perf_counter() - start
                killed = killed_until_finished(config, cut, seconds, generator, self.kills - kills)
                expected, found = left_behind(whole), left_behind(cut)
                different = [name for name, value in expected.items() if found.get(name) != value]
                if different:
                    raise SystemExit(f"{algo}, killed after {killed} finished episodes: {', '.join(different)} differ")
                print(f"{algo}: killed after {killed} finished episodes: the same bytes", flush=True)
                kills, number = kills + len(killed), number + 1
        yield {"kills": kills, "trainings": number, "same_bytes": number}


def begin_or_resume(config: TrainingConfig, folder: Path) -> None:
    """Train until something kills the process.

    :param config: settings of the training
    :param folder: its run folder
    """
    if (folder / "config.yaml").exists():
        run = RunFolder.open(folder, unfinished=True)
    else:  # killed before there was anything to resume
        shutil.rmtree(folder, ignore_errors=True)
        run = RunFolder.create(folder, config)
    train(config, run)


def killed_until_finished(
    config: TrainingConfig, folder: Path, seconds: float, generator: random.Random, left: int
) -> list[int]:
    """Train in processes that are killed, one after another, until the training is finished.

    :param config: settings of the training
    :param folder: its run folder
    :param seconds: longest time until a kill, in s
    :param generator: source of the moments
    :param left: number of kills after which nothing more is killed
    :return: number of episodes that had been finished at each kill
    """
    kills: list[int] = []
    while True:
        process = FORK.Process(target=begin_or_resume, args=(config, folder))
        process.start()
        process.join(generator.uniform(0.0, seconds) if len(kills) < left else None)
        if process.exitcode is not None:
            if process.exitcode:
                raise SystemExit(f"a training failed in {folder}")
            return kills
        process.kill()
        process.join()
        journal = folder / "journal.jsonl"
        rows = journal.read_bytes().splitlines() if journal.exists() else []
        kills.append(sum(b'"kind":"begin"' not in row for row in rows))


def left_behind(folder: Path) -> dict[str, object]:
    """Everything of a run folder but the time of day.

    :param folder: the run folder
    """
    names = ("episodes.csv", "recommendations.csv", "progress.csv", "parameters.json")
    found: dict[str, object] = {name: (folder / name).read_bytes() for name in names}
    if (folder / "model.zip").exists():
        archive = zipfile.ZipFile(folder / "model.zip")
        found |= {name: archive.read(name) for name in archive.namelist() if name.endswith(".pth")}
    (events,) = folder.glob("events.out.tfevents.*")
    curves = EventAccumulator(str(events), size_guidance={"scalars": 0})
    curves.Reload()
    tags = curves.Tags()["scalars"]
    return found | {tag: [(event.step, event.value) for event in curves.Scalars(tag)] for tag in tags}
