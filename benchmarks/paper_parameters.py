"""The paper's parameters on 20 seeds: with and without randomisation, at both physics settings."""

from __future__ import annotations

import argparse
import os
from itertools import product

from sarah.config import PHYSICS, EpisodeConfig, Randomisation
from sarah.episode import EpisodeSpec
from sarah.evaluation import summarise
from sarah.pattern_generator import PAPER_PARAMETERS
from sarah.workers import Workers


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--episodes", type=int, default=20)
    episodes = parser.parse_args().episodes
    print("| physics | randomisation | survived | median score | steps per second | mean, max drift | by sensors |")
    print("|---|---|---|---|---|---|---|")
    with Workers(os.cpu_count() or 1) as workers:
        for (name, physics), enabled in product(PHYSICS.items(), (True, False)):
            config = EpisodeConfig(physics=physics, randomisation=Randomisation(enabled=enabled))
            specs = [EpisodeSpec(PAPER_PARAMETERS, seed, config=config) for seed in range(episodes)]
            results = list(workers.simulate_all(specs))
            e = summarise(results)
            frequencies = [result.steps_per_second for result in results]
            print(
                f"| {name} | {'on' if enabled else 'off'} | {round(e.survival_rate * episodes)} of {episodes} "
                f"| {e.score_median:.3f} | {min(frequencies):.2f} to {max(frequencies):.2f} "
                f"| {100 * e.drift_mean:.1f}, {100 * e.drift_max:.1f} cm "
                f"| {e.event_driven_shift_mean:.1%}, {e.event_driven_lift_mean:.1%} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
