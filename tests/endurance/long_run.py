"""Does a long run stay flat? Memory and open files over many episodes in one process, and over a training with workers.

Episodes are short ones: what leaks does so with every world that is built, not with every second simulated.
"""

from __future__ import annotations

import argparse
import gc
import tempfile
import threading
from pathlib import Path

import psutil

from sarah.control.pattern_generator import PAPER_PARAMETERS
from sarah.episode.episode import simulate
from sarah.episode.spec import EpisodeConfig, EpisodeSpec
from sarah.episode.workers import Workers
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.physics import Physics
from sarah.training.train import train

SHORT = EpisodeConfig(time_limit=1.3, physics=Physics(rate=100, solver_iterations=5))


def usage(process: psutil.Process) -> tuple[float, int]:
    """Resident memory in MiB, and open files."""
    return process.memory_info().rss / 2**20, process.num_fds()


def in_one_process(episodes: int) -> None:
    print("| episodes | memory (MiB) | open files |\n|---|---|---|")
    for index in range(episodes + 1):
        if index % (episodes // 10) == 0:
            gc.collect()
            memory, files = usage(psutil.Process())
            print(f"| {index} | {memory:.1f} | {files} |", flush=True)
        simulate(EpisodeSpec(PAPER_PARAMETERS, index, config=SHORT))


def with_workers(simulations: int) -> None:
    here = psutil.Process()
    print("\n| simulations | training (MiB) | open files | workers (MiB) | open files |\n|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder, Workers(2) as workers:
        config = TrainingConfig(simulations=simulations, episode=SHORT)
        run = RunFolder.create(Path(folder) / "run", config)
        done = threading.Event()

        def watch() -> None:
            shown = 0
            while not done.wait(0.2):
                count = sum(1 for _ in run.episodes())
                if count >= shown:
                    memory, files = usage(here)
                    children = [child for child in here.children(recursive=True) if child.memory_info().rss > 2**26]
                    there = [usage(child) for child in children]
                    print(
                        f"| {count} | {memory:.0f} | {files} | {' + '.join(f'{memory:.0f}' for memory, _ in there)} "
                        f"| {' + '.join(str(files) for _, files in there)} |",
                        flush=True,
                    )
                    shown += simulations // 8

        watcher = threading.Thread(target=watch)
        watcher.start()
        train(config, run, workers)
        done.set()
        watcher.join()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--episodes", type=int, default=2000)
    parser.add_argument("--simulations", type=int, default=400)
    options = parser.parse_args()
    in_one_process(options.episodes)
    with_workers(options.simulations)


if __name__ == "__main__":
    main()
