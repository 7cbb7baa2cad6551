"""A training whose workers are killed again and again, against one that is left alone: same bytes, how much slower?"""

from __future__ import annotations

import argparse
import os
import signal
import tempfile
import threading
import time
import zipfile
from pathlib import Path

from sarah.control.pattern_generator import PAPER_PARAMETERS
from sarah.episode.spec import EpisodeSpec
from sarah.episode.workers import Workers
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.training.train import train


def kill_every(seconds: float | None, workers: Workers, done: threading.Event, killed: list[int]) -> None:
    """Kill the workers in turn."""
    client = workers._client
    assert client is not None
    while not done.wait(seconds):
        pids = sorted(client.run(os.getpid, on_error="ignore").values())
        if pids:  # not all of them are restarting
            killed.append(pids[len(killed) % len(pids)])
            os.kill(killed[-1], signal.SIGKILL)


def trained(config: TrainingConfig, folder: Path, seconds: float | None) -> tuple[float, list[bytes], int]:
    """Time, learned bytes and number of killed workers of a training."""
    killed: list[int] = []
    done = threading.Event()
    with Workers(2) as workers:
        list(workers.simulate_all([EpisodeSpec(PAPER_PARAMETERS, seed) for seed in range(4)]))  # warm up
        killer = threading.Thread(target=kill_every, args=(seconds, workers, done, killed), daemon=True)
        if seconds is not None:
            killer.start()
        start = time.perf_counter()
        run = RunFolder.create(folder, config)
        train(config, run, workers)
        elapsed = time.perf_counter() - start
        done.set()
        if seconds is not None:
            killer.join()
    weights = zipfile.ZipFile(run.model_path).read("policy.pth")
    files = [(folder / name).read_bytes() for name in ("episodes.csv", "parameters.json")]
    return elapsed, [weights, *files], len(killed)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--simulations", type=int, default=200)
    parser.add_argument("--every", type=float, default=20.0, help="seconds between deaths")
    options = parser.parse_args()
    config = TrainingConfig(simulations=options.simulations)
    with tempfile.TemporaryDirectory() as folder:
        alone, expected, _ = trained(config, Path(folder) / "alone", None)
        disturbed, found, killed = trained(config, Path(folder) / "disturbed", options.every)
    print(f"left alone           {alone:.0f} s")
    print(f"{killed} workers killed    {disturbed:.0f} s, {disturbed / alone - 1:+.0%}")
    print(f"the same bytes       {'yes' if found == expected else 'NO'}")


if __name__ == "__main__":
    main()
