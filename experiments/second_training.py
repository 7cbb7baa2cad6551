"""The Second Training over many seeds: what each algorithm learned, pushed by 100 N, and stepping without a push.

Some of the pushes are simulated at the reference physics too: its last columns are survival there, and how much of the
mean score at the standard physics it keeps.

All trainings keep the P1 to P5 of --stepping, last 10 s an episode and push by 75 to 125 N: softer pushes hardly tell
controllers apart. Run folders go to --runs; a training that is
finished there is not run again. Every controller meets the same pushes.
"""

from __future__ import annotations

import argparse
import dataclasses
import os
from pathlib import Path
from statistics import median

from trainings import learned

from sarah.episode.evaluation import summarise
from sarah.episode.push import Push
from sarah.episode.spec import TRAINED_STEPPING, EpisodeConfig
from sarah.episode.tasks import BALANCE
from sarah.episode.workers import Workers
from sarah.reports.robustness import push_many, robustness_table
from sarah.runs.config import ALGORITHMS, TrainingConfig
from sarah.simulation.physics import PHYSICS
from sarah.training.train import evaluate


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--algo", nargs="+", choices=ALGORITHMS, default=["naf"])
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--simulations", type=int, default=300)
    parser.add_argument("--stepping", type=float, nargs=5, default=TRAINED_STEPPING)
    parser.add_argument("--newtons", type=float, nargs=2, default=(75.0, 125.0), help="range of the trainings' pushes")
    parser.add_argument("--pushes", type=int, default=50)
    parser.add_argument("--reference-pushes", type=int, default=12, help="of them, at the reference physics")
    parser.add_argument("--unpushed", type=int, default=4)
    parser.add_argument("--runs", type=Path, default=Path("runs/benchmark"))
    options = parser.parse_args()
    with Workers(os.cpu_count() or 1) as workers:
        compare(options, workers)


def compare(options: argparse.Namespace, workers: Workers) -> None:
    hard = Push(newtons=tuple(options.newtons))
    episode = EpisodeConfig(stepping=tuple(options.stepping), push=hard, time_limit=10.0)
    fine = dataclasses.replace(episode, physics=PHYSICS["reference"])
    free = dataclasses.replace(episode, push=Push(newtons=(0.0, 0.0)), time_limit=30.0)

    def row(name: str, parameters: tuple[float, ...]) -> float:
        (pushed,) = push_many([parameters], episode, workers, forces=(100.0,), episodes=options.pushes)
        everywhere, lateral, sagittal = robustness_table(pushed)
        (at_reference,) = push_many([parameters], fine, workers, forces=(100.0,), episodes=options.reference_pushes)
        reference = summarise(push.result for push in at_reference)
        same = summarise(push.result for push in pushed[: options.reference_pushes])
        unpushed = TrainingConfig(task=BALANCE.name, episode=free)
        stepping = evaluate(parameters, unpushed, range(options.unpushed), workers)
        together = summarise(push.result for push in pushed)
        print(
            f"| {name} | {' | '.join(f'{value:.2f}' for value in parameters)} | {everywhere.survival:.2f} "
            f"| {lateral.survival:.2f} | {sagittal.survival:.2f} | {together.score_mean:.3f} "
            f"| {stepping.score_mean:.3f} | {stepping.steps_per_second_mean:.2f} "
            f"| {1000 * stepping.sole_clearance_mean:.0f} mm "
            f"| {together.vibration_median:.1f}, {stepping.vibration_median:.1f} "
            f"| {reference.survival_rate:.2f} | {reference.score_mean / same.score_mean:.0%} |",
            flush=True,
        )
        return everywhere.survival

    head = (
        "| run | V1 | V2 | V3 | V4 | survival | lateral | sagittal | score | unpushed | steps/s | clearance | vibration"
        " | reference | kept |"
    )
    print(f"{head}\n{'|---' * 15}|")
    row("V = 0", BALANCE.neutral or ())
    for algo in options.algo:
        survivals = []
        for seed in range(options.first_seed, options.first_seed + options.seeds):
            config = TrainingConfig("balance", algo, options.simulations, seed, episode=episode)
            parameters = learned(config, options.runs / f"balance-{algo}-{options.simulations}-s{seed}", workers)
            survivals.append(row(f"{algo} seed {seed}", parameters))
        close = sum(survival >= max(survivals) - 0.05 for survival in survivals)
        print(
            f"\n{algo}: median survival {median(survivals):.2f}; {close} of {len(survivals)} within 0.05 of the best\n"
        )


if __name__ == "__main__":
    main()
