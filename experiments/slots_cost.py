"""What more episodes in flight cost a training: the same budget, each action knowing less of the last outcomes."""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from statistics import mean, median
from typing import get_args

from trainings import learned

from sarah.agents.naf import PRESETS
from sarah.episode.spec import EpisodeConfig
from sarah.episode.workers import Workers
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.engines import Engine
from sarah.training.train import evaluate

WARM_UP = PRESETS["one-step"]["learning_starts"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--slots", type=int, nargs="+", default=[1, 4, 8, 32])
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--simulations", type=int, default=99, help="below 100, which has no closing comparison")
    parser.add_argument("--seconds", type=float, default=10.0, help="of each episode")
    parser.add_argument("--engine", choices=get_args(Engine), default="pybullet")
    parser.add_argument("--runs", type=Path, default=Path("runs/slots"))
    options = parser.parse_args()
    print("| slots | score while learning | of the agent's choice | lowest seed |\n|---|---|---|---|")
    with Workers(os.cpu_count() or 1) as workers:
        for slots in options.slots:
            learning, final = [], []
            for seed in range(options.seeds):
                episode = EpisodeConfig(time_limit=options.seconds, engine=options.engine)
                config = TrainingConfig(simulations=options.simulations, seed=seed, slots=slots, episode=episode)
                path = options.runs / f"slots{slots}-s{seed}"
                parameters = learned(config, path, workers)
                learning.append(
                    mean(float(row["score"]) for row in list(RunFolder(path).episodes())[max(WARM_UP, 2 * slots) :])
                )
                final.append(evaluate(parameters, config, range(10), workers).score_median)
            print(f"| {slots} | {median(learning):.3f} | {median(final):.3f} | {min(final):.3f} |", flush=True)


if __name__ == "__main__":
    main()
