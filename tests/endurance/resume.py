"""What resuming costs: processor time to replay a whole training, with nothing simulated."""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

from sarah.episode.spec import EpisodeConfig
from sarah.runs.config import ALGORITHMS, TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.physics import Physics
from sarah.training.train import train

# What is replayed does not depend on how long or how finely it was simulated.
SHORT = EpisodeConfig(time_limit=1.1, physics=Physics(rate=50, solver_iterations=5, control_rate=50))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--algorithms", nargs="+", default=ALGORITHMS)
    parser.add_argument("--simulations", type=int, default=100)
    options = parser.parse_args()
    print("| algorithm | simulations | replayed in | journal |\n|---|---|---|---|")
    for algo in options.algorithms:
        with tempfile.TemporaryDirectory() as folder:
            config = TrainingConfig(algo=algo, simulations=options.simulations, episode=SHORT)
            run = RunFolder.create(Path(folder) / "run", config)
            train(config, run)
            start = time.process_time()
            train(config, run)
            seconds = time.process_time() - start
            size = run.journal_path.stat().st_size / 1000
            print(f"| {algo} | {options.simulations} | {seconds:.1f} s | {size:.0f} kB |", flush=True)


if __name__ == "__main__":
    main()
