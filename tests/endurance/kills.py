"""Trainings that are killed (SIGKILL) at random moments and resumed, against the same without: the same bytes?

A training is a process forked from this one, which has everything loaded: so kills fall into the training, while it
makes its folder, reads or writes the journal, learns, or replaces files.
"""

from __future__ import annotations

import argparse
import multiprocessing
import random
import shutil
import tempfile
import time
import zipfile
from pathlib import Path

from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

from sarah.episode.spec import EpisodeConfig
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.physics import Physics
from sarah.training.train import train

SIMULATIONS = 50
"""Of which agents learn from those after the warm-up, 6 or 30."""
SHORT = EpisodeConfig(time_limit=2.0, physics=Physics(rate=100, solver_iterations=5))
ALGORITHMS = ("naf", "cma-es", "td3", "tpe")
FORK = multiprocessing.get_context("fork")


def begin_or_resume(config: TrainingConfig, folder: Path) -> None:
    if (folder / "config.yaml").exists():
        run = RunFolder.resumable(folder)
    else:  # killed before there was anything to resume
        shutil.rmtree(folder, ignore_errors=True)
        run = RunFolder.create(folder, config)
    train(config, run)


def killed_until_finished(
    config: TrainingConfig, folder: Path, seconds: float, generator: random.Random, left: int
) -> list[int]:
    """How many simulations each killed process had finished; nothing more is killed after ``left`` kills."""
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
        kills.append(sum(b'"kind":"stand"' not in row for row in rows))


def left_behind(folder: Path) -> dict[str, object]:
    """Everything of a run folder but the time of day."""
    names = ("episodes.csv", "choices.csv", "progress.csv", "parameters.json")
    found: dict[str, object] = {name: (folder / name).read_bytes() for name in names}
    if (folder / "model.zip").exists():
        archive = zipfile.ZipFile(folder / "model.zip")
        found |= {name: archive.read(name) for name in archive.namelist() if name.endswith(".pth")}
    (events,) = folder.glob("events.out.tfevents.*")
    curves = EventAccumulator(str(events), size_guidance={"scalars": 0})
    curves.Reload()
    tags = curves.Tags()["scalars"]
    return found | {tag: [(event.step, event.value) for event in curves.Scalars(tag)] for tag in tags}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=30)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    generator = random.Random(options.seed)
    kills, number, same = 0, 0, 0
    with tempfile.TemporaryDirectory() as folder:
        while kills < options.kills:
            algo = ALGORITHMS[number % len(ALGORITHMS)]
            config = TrainingConfig(algo=algo, simulations=SIMULATIONS, seed=number, slots=3, episode=SHORT)
            whole, cut = Path(folder) / f"{number}-whole", Path(folder) / f"{number}-cut"
            start = time.perf_counter()
            killed_until_finished(config, whole, 0.0, generator, 0)
            seconds = time.perf_counter() - start
            killed = killed_until_finished(config, cut, seconds, generator, options.kills - kills)
            expected, found = left_behind(whole), left_behind(cut)
            different = [name for name, value in expected.items() if found.get(name) != value]
            print(
                f"{algo}: killed {len(killed)} times, after {', '.join(map(str, killed))} finished simulations: "
                f"{f'DIFFERENT in {different}' if different else 'the same'}",
                flush=True,
            )
            kills, number, same = kills + len(killed), number + 1, same + (not different)
    print(f"{kills} kills, {number} trainings, {same} of them end as without")


if __name__ == "__main__":
    main()
