"""Trainings that are killed (SIGKILL) at random moments and resumed, against the same without: the same bytes?

Kills fall anywhere: while Python starts, while the journal is read or written, while files are replaced.
"""

from __future__ import annotations

import argparse
import random
import signal
import subprocess
import sys
import tempfile
import time
import zipfile
from pathlib import Path

from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

COMMAND = Path(sys.executable).parent / "sarah-train"
SIMULATIONS = 60
"""Twenty of them after the warm-up."""
WORKERS = (0, 0, 0, 0, 2)
ALGORITHMS = ("naf", "cma-es", "td3", "tpe")


def started(arguments: list[str]) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [COMMAND, *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, start_new_session=True
    )


def arguments_of(number: int, folder: Path) -> list[str]:
    algo = ALGORITHMS[number % len(ALGORITHMS)]
    short = ("--simulations", str(SIMULATIONS), "--seed", str(number), "--slots", "3", "--episode.time-limit", "4")
    coarse = ("--episode.physics.rate", "100", "--episode.physics.solver-iterations", "5")
    return ["--algo", algo, *short, *coarse, "--run-dir", str(folder)]


def finished(process: subprocess.Popen[bytes]) -> None:
    _, errors = process.communicate()
    if process.returncode:
        raise SystemExit(errors.decode())


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


def simulations_of(folder: Path) -> int:
    journal = folder / "journal.jsonl"
    return sum(b'"kind":"stand"' not in line for line in journal.open("rb")) if journal.exists() else 0


def killed_until_finished(number: int, folder: Path, seconds: float, generator: random.Random, left: int) -> list[int]:
    """How many simulations each killed process had finished; nothing more is killed after ``left`` kills."""
    kills: list[int] = []
    begun = arguments_of(number, folder)
    while True:
        arguments = ["--resume", str(folder)] if (folder / "config.yaml").exists() else begun
        process = started([*arguments, "--workers", str(WORKERS[number % len(WORKERS)])])
        if len(kills) < left:
            time.sleep(generator.uniform(0.0, seconds))
            if process.poll() is None:
                process.send_signal(signal.SIGKILL)
                process.communicate()
                kills.append(simulations_of(folder))
                continue
        finished(process)
        return kills


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=30)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    generator = random.Random(options.seed)
    kills, number, same = 0, 0, 0
    with tempfile.TemporaryDirectory() as folder:
        while kills < options.kills:
            whole, cut = Path(folder) / f"{number}-whole", Path(folder) / f"{number}-cut"
            start = time.perf_counter()
            finished(started(arguments_of(number, whole)))
            seconds = time.perf_counter() - start
            killed = killed_until_finished(number, cut, seconds, generator, options.kills - kills)
            expected, found = left_behind(whole), left_behind(cut)
            different = [name for name, value in expected.items() if found.get(name) != value]
            algo, workers = ALGORITHMS[number % len(ALGORITHMS)], WORKERS[number % len(WORKERS)]
            print(
                f"{algo}, {workers} workers: killed {len(killed)} times, after "
                f"{', '.join(map(str, killed))} finished simulations: "
                f"{f'DIFFERENT in {different}' if different else 'the same'}",
                flush=True,
            )
            kills, number, same = kills + len(killed), number + 1, same + (not different)
    print(f"{kills} kills, {number} trainings, {same} of them end as without")


if __name__ == "__main__":
    main()
