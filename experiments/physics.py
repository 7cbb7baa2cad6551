"""How fine must the physics be? Mean score of parameter sets at several settings, and the speed of each.

Good sets, poor ones, and what trainings at a cheap one learned; others, as arguments, take their place. Every setting
simulates the same seeds, for 12 s, without pushes unless --newtons asks for them.
Scores come with their distance from the first setting's, and its standard error; a second table has steps per second,
sole clearance and the share that is up at the end. With --random the sets are drawn from the whole box of P1 to P5
instead, and one table says how far their scores are from the first setting's.
"""

from __future__ import annotations

import argparse
import os
import random
import sys
import time
from statistics import mean, stdev

from sarah.episode.episode import simulate
from sarah.episode.push import Push
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import TRAINED_STEPPING, EpisodeConfig, EpisodeSpec
from sarah.episode.tasks import TASKS
from sarah.episode.workers import Workers
from sarah.simulation.physics import PHYSICS, Physics

STEPPING_SETS = (
    (0.4, 1.3, 0.1, 1.0, 1.0),
    TRAINED_STEPPING,
    (0.02, 0.05, 0.55, 1.8, 1.3),
    (0.15, 0.3, 0.25, 0.5, 0.5),
    (0.42, 0.39, 0.91, 0.5, 1.2),
    (0.5, 0.8, 0.1, 1.0, 1.0),
    (0.8, 1.2, 0.1, 1.0, 1.0),
    (0.2, 0.0, 2.0, 0.0, 0.0),
)
BALANCE_SETS = (
    (0.0, 0.0, 0.0, 0.0),
    (1.1, 0.34, -0.04, -1.72),
    (1.8, 0.0, 1.0, 0.0),
    (1.1, 0.0, 0.0, 0.0),
    (0.8, 0.0, 0.4, 0.0),
    (1.29, 0.23, -0.02, -1.97),
    (0.4, 0.0, 0.0, 0.0),
    (0.5, 0.0, 0.0, 0.0),
)
STANDARD = PHYSICS["standard"]
SETTINGS = (
    "1000,100,0",
    f"1000,100,{STANDARD.added_plate_inertia}",
    "500,30,0",
    "200,40,0",
    f"{STANDARD.rate},{STANDARD.solver_iterations},{STANDARD.added_plate_inertia}",
)
"""Physics steps per second, solver iterations and added plate inertia; scores are compared with those of the first."""


def simulated(
    physics: Physics, newtons: float, sets: list[tuple[float, ...]], seeds: int, workers: Workers
) -> tuple[list[list[EpisodeResult]], float]:
    """Every set's results, and simulated seconds per processor second of two episodes."""
    config = EpisodeConfig(physics=physics, push=Push(newtons=(newtons, newtons)), time_limit=12.0)
    specs = []
    for parameters in sets:
        task = next(name for name, task in TASKS.items() if len(task.parameter_names) == len(parameters))
        specs += [EpisodeSpec(parameters, seed, task, config) for seed in range(seeds)]
    results = list(workers.simulate_all(specs))
    simulate(specs[0])  # what a process does once, is done
    start = time.process_time()
    speed = sum(simulate(spec).duration for spec in specs[:2]) / (time.process_time() - start)
    return [results[first : first + seeds] for first in range(0, len(results), seeds)], speed


def compared(results: list[EpisodeResult], finest: list[EpisodeResult]) -> str:
    """Mean score, its distance from the finest setting's, and the standard error of that, from the seeds in pairs."""
    score, fine = (mean(result.score for result in some) for some in (results, finest))
    if results is finest:
        return f"{score:.3f}"
    differences = [one.score - other.score for one, other in zip(results, finest, strict=True)]
    error = stdev(differences) / len(differences) ** 0.5
    return f"{score:.3f} ({score / fine - 1:+.1%} ± {error / fine:.1%})"


def drawn(count: int) -> list[tuple[float, ...]]:
    """Sets of P1 to P5, uniformly from their box."""
    generator = random.Random(7)
    return [tuple(generator.uniform(0.0, 2.0) for _ in range(5)) for _ in range(count)]


def print_distances(head: str, columns: list[list[list[EpisodeResult]]]) -> None:
    """How far the sets' mean scores are from those of the first setting, over all sets."""
    scores = [[mean(result.score for result in results) for results in column] for column in columns]
    distances = [[abs(one - finest) for one, finest in zip(column, scores[0], strict=True)] for column in scores]
    rows = {
        "mean score": [f"{mean(column):.3f}" for column in scores],
        "root mean square distance": [f"{mean(d * d for d in column) ** 0.5:.3f}" for column in distances],
        "largest": [f"{max(column):.3f}" for column in distances],
        "sets within 0.02": [f"{sum(d < 0.02 for d in column)} of {len(column)}" for column in distances],
    }
    print(head)
    for name, cells in rows.items():
        print(f"| {name} | {' | '.join(cells)} |")


def gait(results: list[EpisodeResult]) -> str:
    """Mean steps per second and sole clearance, and the share that survived."""
    steps, clearance = mean(r.steps_per_second for r in results), mean(r.sole_clearance for r in results)
    return f"{steps:.2f}, {1000 * clearance:.0f} mm, {mean(r.survived for r in results):.0%}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sets", nargs="*", help="P1 to P5, or V1 to V4, separated by commas")
    parser.add_argument("--seeds", type=int, default=20, help="at least 2")
    parser.add_argument("--random", type=int, default=0, metavar="COUNT", help="sets to draw instead")
    parser.add_argument("--newtons", type=float, default=0.0, help="of a push from anywhere, in the sets of four")
    parser.add_argument(
        "--settings",
        nargs="+",
        metavar="RATE,ITERATIONS,INERTIA",
        default=SETTINGS,
        help="the first is compared with",
    )
    options = parser.parse_args()
    given = [tuple(map(float, text.split(","))) for text in options.sets]
    sets = drawn(options.random) or given or [*STEPPING_SETS, *BALANCE_SETS]
    columns, speeds = [], []
    with Workers(os.cpu_count() or 1) as workers:
        for setting in options.settings:
            rate, iterations, inertia = setting.split(",")
            physics = Physics(int(rate), int(iterations), added_plate_inertia=float(inertia))
            results, speed = simulated(physics, options.newtons, sets, options.seeds, workers)
            columns.append(results)
            speeds.append(f"{speed:.0f}")
            print(f"{setting} done", file=sys.stderr)
    head = f"| Hz, iterations, kg m^2 | {' | '.join(options.settings)} |\n{'|---' * (len(options.settings) + 1)}|"
    if options.random:
        print_distances(head, columns)
        return
    print(head)
    for index, parameters in enumerate(sets):
        cells = [compared(results[index], columns[0][index]) for results in columns]
        print(f"| ({', '.join(f'{value:g}' for value in parameters)}) | {' | '.join(cells)} |")
    print(f"| x real time | {' | '.join(speeds)} |\n\n{head}")
    for index, parameters in enumerate(sets):
        cells = [gait(results[index]) for results in columns]
        print(f"| ({', '.join(f'{value:g}' for value in parameters)}) | {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
