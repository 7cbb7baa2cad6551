"""How fine must the physics be? Mean score of parameter sets at several settings, and the speed of each.

Good sets, poor ones, and sets at the edge of stalling; further ones, such as what a training learned at a cheap one,
follow as arguments. Every setting simulates the same seeds, for 12 s and without pushes.
"""

from __future__ import annotations

import argparse
import os
import time
from statistics import mean

from sarah.config import TRAINED_STEPPING, EpisodeConfig, Physics, Push
from sarah.episode import EpisodeSpec, simulate
from sarah.tasks import TASKS
from sarah.workers import Workers

STEPPING_SETS = (
    (0.4, 1.3, 0.1, 1.0, 1.0),
    TRAINED_STEPPING,
    (0.02, 0.05, 0.55, 1.8, 1.3),
    (0.15, 0.3, 0.25, 0.5, 0.5),
    (0.42, 0.39, 0.91, 0.5, 1.2),
    (0.5, 0.8, 0.1, 1.0, 1.0),
    (0.8, 1.2, 0.1, 1.0, 1.0),
)
BALANCE_SETS = ((0.0, 0.0, 0.0, 0.0), (1.1, 0.34, -0.04, -1.72), (1.8, 0.0, 1.0, 0.0))
SETTINGS = ((1000, 100), (1000, 20), (500, 30), (400, 20), (300, 50), (300, 40), (300, 30), (200, 50), (200, 30))
"""Physics steps per second and solver iterations; scores are compared with those of the first."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("sets", nargs="*", help="further sets: P1 to P5, or V1 to V4, separated by commas")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument(
        "--settings", nargs="+", metavar="RATE,ITERATIONS", help="instead of all; the first is compared with"
    )
    options = parser.parse_args()
    settings = SETTINGS
    if options.settings:
        settings = tuple(tuple(map(int, text.split(","))) for text in options.settings)
    further = [tuple(map(float, text.split(","))) for text in options.sets]
    sets = [*STEPPING_SETS, *BALANCE_SETS, *further]
    print("| Hz, iterations |", " | ".join(", ".join(f"{v:g}" for v in s) for s in sets), "| x real time |")
    print("|---" * (len(sets) + 2) + "|")
    finest: list[float] = []
    with Workers(os.cpu_count() or 1) as workers:
        for rate, iterations in settings:
            config = EpisodeConfig(physics=Physics(rate, iterations), push=Push(newtons=(0.0, 0.0)), time_limit=12.0)
            specs = []
            for parameters in sets:
                task = next(name for name, task in TASKS.items() if len(task.parameter_names) == len(parameters))
                specs += [EpisodeSpec(parameters, seed, task, config) for seed in range(options.seeds)]
            results = list(workers.simulate_all(specs))
            scores = [
                mean(r.score for r in results[i : i + options.seeds]) for i in range(0, len(results), options.seeds)
            ]
            finest = finest or scores
            start = time.process_time()
            speed = sum(simulate(spec).duration for spec in specs[:2]) / (time.process_time() - start)
            cells = [f"{score:.3f} ({score / fine - 1:+.1%})" for score, fine in zip(scores, finest, strict=True)]
            print(f"| {rate}, {iterations} |", " | ".join(cells), f"| {speed:.0f} |", flush=True)


if __name__ == "__main__":
    main()
