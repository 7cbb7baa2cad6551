"""The two physics engines: how fast an episode is in each, and how far they agree.

Speed is that of whole episodes in a closed loop, from building the world to the result, in turns, so that whatever else
the machine does slows both; the ratio is the median of the rounds'. Agreement is of good parameters, poor ones, and
V1 to V4 under pushes, on the same seeds.
"""

from __future__ import annotations

import argparse
import os
import time
from statistics import median
from typing import get_args

from sarah.control.pattern_generator import PAPER_PARAMETERS
from sarah.episode.episode import simulate
from sarah.episode.evaluation import Evaluation, summarise
from sarah.episode.push import Push
from sarah.episode.spec import TRAINED_STEPPING, EpisodeConfig, EpisodeSpec
from sarah.episode.workers import Workers
from sarah.simulation.engines import Engine
from sarah.simulation.physics import PHYSICS

STEPPING_SETS = (
    PAPER_PARAMETERS,
    TRAINED_STEPPING,
    (0.02, 0.05, 0.55, 1.8, 1.3),
    (0.15, 0.3, 0.25, 0.5, 0.5),
    (0.5, 0.8, 0.1, 1.0, 1.0),
    (0.8, 1.2, 0.1, 1.0, 1.0),
)
BALANCE_SETS = ((0.0, 0.0, 0.0, 0.0), (1.06, -0.24, 0.21, -0.15), (1.8, 0.0, 1.0, 0.0))
ENGINES: tuple[Engine, ...] = get_args(Engine)


def speed(rounds: int) -> None:
    print("| round | " + " | ".join(f"{engine}: x real time" for engine in ENGINES) + " | ratio |")
    print("|---" * (len(ENGINES) + 2) + "|")
    ratios = []
    for seed in range(-1, rounds):  # the first round warms up
        speeds = []
        for engine in ENGINES:
            spec = EpisodeSpec(TRAINED_STEPPING, max(seed, 0), config=EpisodeConfig(engine=engine))
            start = time.process_time()
            speeds.append(simulate(spec).duration / (time.process_time() - start))
        if seed >= 0:
            ratios.append(speeds[1] / speeds[0])
            print(
                f"| {seed} | " + " | ".join(f"{value:.0f}" for value in speeds) + f" | {ratios[-1]:.2f} |", flush=True
            )
    print(f"\nmedian ratio {median(ratios):.2f}, {min(ratios):.2f} to {max(ratios):.2f}\n", flush=True)


def agreement(seeds: int, physics: str) -> None:
    cases = [("stepping", parameters) for parameters in STEPPING_SETS]
    cases += [("balance", parameters) for parameters in BALANCE_SETS]
    print(
        "| parameters | "
        + " | ".join(f"{engine}: score | steps/s | survived" for engine in ENGINES)
        + " | difference |"
    )
    print("|---" * (3 * len(ENGINES) + 2) + "|")
    with Workers(os.cpu_count() or 1) as workers:
        for task, parameters in cases:
            evaluations = [evaluate(task, parameters, engine, physics, seeds, workers) for engine in ENGINES]
            cells = [
                f"{e.score_mean:.3f} | {e.steps_per_second_mean:.2f} | {round(e.survival_rate * e.episodes)} of {seeds}"
                for e in evaluations
            ]
            first, second = (evaluation.score_mean for evaluation in evaluations)
            name = ", ".join(f"{value:g}" for value in parameters)
            print(f"| {name} | " + " | ".join(cells) + f" | {second / first - 1:+.1%} |", flush=True)


def evaluate(
    task: str, parameters: tuple[float, ...], engine: Engine, physics: str, seeds: int, workers: Workers
) -> Evaluation:
    config = EpisodeConfig(engine=engine, physics=PHYSICS[physics], push=Push(newtons=(100.0, 100.0)))
    specs = [EpisodeSpec(parameters, seed, task, config) for seed in range(seeds)]
    return summarise(workers.simulate_all(specs))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=10, help="of the comparison of speed; 0 leaves it out")
    parser.add_argument("--seeds", type=int, default=20, help="of the comparison of scores; 0 leaves it out")
    parser.add_argument("--physics", choices=PHYSICS, default="standard")
    options = parser.parse_args()
    if options.rounds:
        speed(options.rounds)
    if options.seeds:
        agreement(options.seeds, options.physics)


if __name__ == "__main__":
    main()
