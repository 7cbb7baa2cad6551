"""Whether the hip law goes with what the First Training learned: V1 on several P1 to P5.

Columns differ in V1, and in what the pattern generator is told of the abduction: nothing, how far it makes the legs
lean (9.81 m/s^2 of tilt per radian, and its rate), or what the package tells it. The first row's P1 to P5 are the
paper's, the second's what the package ships, the others what ten First Trainings learned. Cells: mean score under
pushes, and in brackets the share that survived and the steps per second.
"""

from __future__ import annotations

import argparse
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from statistics import mean

from sarah.control import pattern_generator
from sarah.control.pattern_generator import ABDUCTION_RATE_SHARE, ABDUCTION_TILT, PAPER_PARAMETERS
from sarah.episode.episode import simulate
from sarah.episode.push import Push
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import TRAINED_STEPPING, EpisodeConfig, EpisodeSpec
from sarah.episode.tasks import BALANCE
from sarah.simulation.randomisation import Randomisation

STEPPING = (
    PAPER_PARAMETERS,
    TRAINED_STEPPING,
    (0.02, 0.23, 0.29, 0.07, 1.96),
    (0.01, 0.87, 0.14, 1.97, 1.88),
    (0.43, 0.53, 0.43, 1.85, 1.68),
    (0.05, 0.94, 0.24, 1.41, 0.38),
    (0.42, 0.32, 0.31, 0.83, 0.54),
    (0.42, 0.19, 0.75, 1.17, 1.73),
    (0.04, 0.04, 0.93, 1.20, 1.22),
    (0.09, 1.22, 0.09, 0.81, 1.26),
    (0.01, 1.08, 0.09, 1.60, 0.47),
    (0.03, 0.26, 0.37, 0.17, 1.37),
)
TOLD = {"nothing": (0.0, 0.0), "the legs' lean": (9.81, 1.0), "the package": (ABDUCTION_TILT, ABDUCTION_RATE_SHARE)}


def simulate_with(told: str, spec: EpisodeSpec) -> EpisodeResult:
    pattern_generator.ABDUCTION_TILT, pattern_generator.ABDUCTION_RATE_SHARE = TOLD[told]
    return simulate(spec)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--v1", type=float, nargs="+", default=[0.7, 1.1], help="beside 0")
    parser.add_argument("--pushes", type=int, default=8)
    parser.add_argument("--newtons", type=float, nargs=2, default=(75.0, 125.0))
    parser.add_argument("--engine", choices=("pybullet", "mujoco"), default="pybullet")
    parser.add_argument("--calm", action="store_true", help="without pushes, noise and other randomisation")
    options = parser.parse_args()
    newtons = (0.0, 0.0) if options.calm else tuple(options.newtons)
    episodes_each = 1 if options.calm else options.pushes

    laws = [("nothing", 0.0)] + [(told, v1) for told in TOLD for v1 in options.v1]
    heads = ["V1 = 0"] + [f"{told}: V1 = {v1:g}" for told, v1 in laws[1:]]
    print("| P1 to P5 | " + " | ".join(heads) + " |\n" + "|---" * (len(laws) + 1) + "|")
    better = [0] * len(laws)
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
        for stepping in STEPPING:
            config = EpisodeConfig(
                time_limit=10.0,
                stepping=stepping,
                push=Push(newtons=newtons),
                randomisation=Randomisation(enabled=not options.calm),
                engine=options.engine,
            )
            jobs = [
                (told, EpisodeSpec((v1, 0.0, 0.0, 0.0), seed, BALANCE.name, config))
                for told, v1 in laws
                for seed in range(episodes_each)
            ]
            results = list(pool.map(simulate_with, *zip(*jobs, strict=True), chunksize=episodes_each))
            cells, scores = [], []
            for index in range(len(laws)):
                episodes = results[index * episodes_each : (index + 1) * episodes_each]
                scores.append(mean(result.score for result in episodes))
                survival = mean(result.survived for result in episodes)
                frequency = mean(result.steps_per_second for result in episodes)
                cells.append(f"{scores[-1]:.2f} ({survival:.2f}, {frequency:.1f})")
                better[index] += scores[-1] > scores[0]
            print(f"| {', '.join(f'{value:.2f}' for value in stepping)} | {' | '.join(cells)} |", flush=True)
    print(f"| better than V1 = 0 | | {' | '.join(f'{count} of {len(STEPPING)}' for count in better[1:])} |")


if __name__ == "__main__":
    main()
