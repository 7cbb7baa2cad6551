"""The First Training over many seeds: what each algorithm learned, on unseen seeds and at the reference physics.

Run folders go to --runs; a training that is finished there is not run again.
"""

from __future__ import annotations

import argparse
import dataclasses
import os
from pathlib import Path
from statistics import median

from trainings import learned

from sarah.control.pattern_generator import PAPER_PARAMETERS
from sarah.episode.evaluation import Evaluation
from sarah.episode.workers import Workers
from sarah.runs.config import ALGORITHMS, TrainingConfig
from sarah.simulation.physics import PHYSICS
from sarah.training.train import evaluate


def row(name: str, parameters: tuple[float, ...], standard: Evaluation, reference: Evaluation) -> str:
    values = " | ".join(f"{value:.2f}" for value in parameters)
    kept = reference.score_median / standard.score_median if standard.score_median else 0.0
    shares = f"{standard.event_driven_shift_mean:.2f}, {standard.event_driven_lift_mean:.2f}"
    return (
        f"| {name} | {values} | {standard.score_median:.3f} | {standard.steps_per_second_mean:.2f} "
        f"| {standard.survival_rate:.0%} | {shares} | {1000 * standard.sole_clearance_mean:.0f} mm "
        f"| {reference.score_median:.3f} | {kept:.0%} |"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--algo", nargs="+", choices=ALGORITHMS, default=["naf", "td3"])
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--simulations", type=int, default=TrainingConfig().simulations)
    parser.add_argument("--episodes", type=int, default=20, help="unseen seeds at the standard physics")
    parser.add_argument("--reference-episodes", type=int, default=20, help="the same at the reference physics")
    parser.add_argument("--runs", type=Path, default=Path("runs/benchmark"))
    options = parser.parse_args()

    with Workers(os.cpu_count() or 1) as workers:
        compare(options, workers)


def compare(options: argparse.Namespace, workers: Workers) -> None:
    def evaluations(parameters: tuple[float, ...], config: TrainingConfig) -> tuple[Evaluation, Evaluation]:
        episode = dataclasses.replace(config.episode, physics=PHYSICS["reference"])
        reference = dataclasses.replace(config, episode=episode)
        return (
            evaluate(parameters, config, range(options.episodes), workers),
            evaluate(parameters, reference, range(options.reference_episodes), workers),
        )

    print("| run | P1 | P2 | P3 | P4 | P5 | score | steps/s | survived | by sensors | clearance | reference | kept |")
    print("|---" * 13 + "|")
    print(row("paper", PAPER_PARAMETERS, *evaluations(PAPER_PARAMETERS, TrainingConfig())), flush=True)
    for algo in options.algo:
        scores = []
        for seed in range(options.first_seed, options.first_seed + options.seeds):
            config = TrainingConfig(algo=algo, simulations=options.simulations, seed=seed)
            parameters = learned(config, options.runs / f"{algo}-{options.simulations}-s{seed}", workers)
            standard, reference = evaluations(parameters, config)
            scores.append(standard.score_median)
            print(row(f"{algo} seed {seed}", parameters, standard, reference), flush=True)
        above = sum(score > 0.8 for score in scores)
        print(f"\n{algo}: median {median(scores):.3f}, {above} of {len(scores)} above 0.8\n", flush=True)


if __name__ == "__main__":
    main()
