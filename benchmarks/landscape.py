"""What each parameter does: score and steps per second with one of P1 to P5 varied around a good set."""

from __future__ import annotations

import argparse
import os
from itertools import islice

from sarah.config import PHYSICS, EpisodeConfig
from sarah.episode import EpisodeSpec
from sarah.evaluation import summarise
from sarah.tasks import STEPPING
from sarah.workers import Workers

CENTRE = (0.4, 1.0, 0.1, 1.0, 1.0)
VALUES = (0.0, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0, 1.5, 2.0)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--episodes", type=int, default=1)
    parser.add_argument("--physics", choices=PHYSICS, default="standard")
    options = parser.parse_args()
    config = EpisodeConfig(physics=PHYSICS[options.physics])
    print(f"median score (steps per second) of {options.episodes} seed(s) around {CENTRE}, {options.physics} physics\n")
    print("| value |", " | ".join(STEPPING.parameter_names), "|")
    print("|---" * (len(STEPPING.parameter_names) + 1) + "|")
    cells = [(value, index) for value in VALUES for index in range(len(STEPPING.parameter_names))]
    specs = [
        EpisodeSpec((*CENTRE[:index], value, *CENTRE[index + 1 :]), seed, config=config)
        for value, index in cells
        for seed in range(options.episodes)
    ]
    with Workers(os.cpu_count() or 1) as workers:
        results = iter(list(workers.simulate_all(specs)))
    for value in VALUES:
        row = []
        for _ in STEPPING.parameter_names:
            evaluation = summarise(list(islice(results, options.episodes)))
            row.append(f"{evaluation.score_median:.2f} ({evaluation.steps_per_second_mean:.1f})")
        print(f"| {value:g} |", " | ".join(row), "|")


if __name__ == "__main__":
    main()
