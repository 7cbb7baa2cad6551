"""How much of the balance race is noise: what would be recommended by somebody who knows where to look.

All of a budget's simulations are drawn around V1 to V4 that thousands of simulations have found to be good, and what is
recommended from them, as in a training, is judged on unseen seeds beside the good ones themselves.
"""

from __future__ import annotations

import argparse
import os
from statistics import mean, stdev

import numpy as np

from sarah.episode.push import Push
from sarah.episode.spec import EpisodeConfig, EpisodeSpec
from sarah.episode.tasks import BALANCE
from sarah.episode.workers import Workers
from sarah.runs.config import TrainingConfig
from sarah.training.recommendation import Parameters, candidates, merit
from sarah.training.train import evaluate

UNSEEN = 5000
"""First seed of the judging episodes."""


def recommended(
    good: Parameters, deviation: float, episodes: int, seed: int, base: TrainingConfig, workers: Workers
) -> tuple[Parameters, float]:
    """What is recommended after some episodes around good parameters, and the deviation of their scores."""
    generator = np.random.default_rng(seed)
    drawn = generator.normal(good, deviation, (episodes, len(good))).clip(BALANCE.low, BALANCE.high)
    tried = [tuple(map(float, parameters)) for parameters in drawn]
    specs = [EpisodeSpec(p, int(generator.integers(2**31, 2**32)), "balance", base.episode) for p in tried]
    results = list(workers.simulate_all(specs))
    merits = [(p, merit(result.fields())) for p, result in zip(tried, results, strict=True)]
    (choice,) = candidates(tried[0], merits, 1, BALANCE.width)
    return choice, stdev(result.score for result in results)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--good", type=float, nargs=4, default=[0.97, 0.13, -0.15, -0.3], metavar="V")
    parser.add_argument("--deviations", type=float, nargs="+", default=[0.3], help="of the draws, in V's units")
    parser.add_argument("--episodes", type=int, default=135, help="of 150, without the closing comparison")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--judged", type=int, default=48, help="episodes that judge")
    options = parser.parse_args()
    episode = EpisodeConfig(engine="mujoco", time_limit=10.0, push=Push(newtons=(75.0, 125.0)))
    base = TrainingConfig(task="balance", episode=episode)
    judging = range(UNSEEN, UNSEEN + options.judged)
    with Workers(os.cpu_count() or 1) as workers:
        for name, parameters in (("good ones", tuple(options.good)), ("V = 0", (0.0, 0.0, 0.0, 0.0))):
            print(f"{name}: {evaluate(parameters, base, judging, workers).score_mean:.3f}", flush=True)
        print(
            "| deviation of the draws | of their scores | recommended, mean | lowest | highest |\n|---|---|---|---|---|"
        )
        for deviation in options.deviations:
            finals, spreads = [], []
            for seed in range(options.seeds):
                choice, spread = recommended(tuple(options.good), deviation, options.episodes, seed, base, workers)
                finals.append(evaluate(choice, base, judging, workers).score_mean)
                spreads.append(spread)
            print(
                f"| {deviation:g} | {mean(spreads):.2f} | {mean(finals):.3f} | {min(finals):.3f} | {max(finals):.3f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
