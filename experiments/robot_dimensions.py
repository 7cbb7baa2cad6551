"""Which robot: stepping, and survival of 100 N, with one dimension at a time away from the defaults.

Stepping is unpushed; pushes come to both sides in turn, at 2 to 3 s, and a robot that is up 2.5 s later has survived.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from statistics import mean

from sarah.control import pattern_generator
from sarah.episode.episode import simulate
from sarah.episode.push import Push
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import TRAINED_STEPPING, EpisodeConfig, EpisodeSpec

DEFAULT_LEGS = (pattern_generator.PUSH_LENGTH, pattern_generator.LIFT_LENGTH)
CONTROLLERS = ((0.0, 0.0, 0.0, 0.0), (1.0, 0.0, 1.0, 0.0))
DIRECTIONS = {"lateral": (0.0, 180.0), "sagittal": (90.0, 270.0)}


@dataclass(frozen=True)
class Robot:
    name: str
    dimensions: Mapping[str, float]
    legs: tuple[float, float] = DEFAULT_LEGS


def foot(length: float) -> dict[str, float]:
    return {"forefoot_contact": length, "hindfoot_contact": length}


ROBOTS = (
    Robot("defaults", {}),
    *(Robot(f"hips ±{offset:.2f} m", {"hip_offset": offset}) for offset in (0.10, 0.11, 0.12, 0.14)),
    *(Robot(f"sole ±{length:.3f} m long", foot(length)) for length in (0.115, 0.125, 0.135, 0.15)),
    *(Robot(f"sole ±{width:.3f} m wide", {"sole_half_width": width}) for width in (0.045, 0.055)),
    *(Robot(f"push {1000 * push:.0f} mm", {}, (push, DEFAULT_LEGS[1])) for push in (0.004, 0.006, 0.010)),
    *(Robot(f"lift {1000 * lift:.0f} mm", {}, (DEFAULT_LEGS[0], lift)) for lift in (0.020, 0.025, 0.035)),
)


def simulate_robot(legs: tuple[float, float], spec: EpisodeSpec) -> EpisodeResult:
    pattern_generator.PUSH_LENGTH, pattern_generator.LIFT_LENGTH = legs
    return simulate(spec)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pushes", type=int, default=40, help="of each direction")
    parser.add_argument("--unpushed", type=int, default=3)
    options = parser.parse_args()
    columns = "".join(f" {name}, V = {v[0]:g} |" for v in CONTROLLERS for name in ("score", "steps/s", *DIRECTIONS))
    print(f"| robot |{columns}\n{'|---' * 9}|")
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
        for robot in ROBOTS:
            cells = []
            for v in CONTROLLERS:
                still = Push(newtons=(0.0, 0.0))
                config = EpisodeConfig(
                    dimensions=robot.dimensions, stepping=TRAINED_STEPPING, push=still, time_limit=15.0
                )
                specs = [EpisodeSpec(v, seed, "balance", config) for seed in range(options.unpushed)]
                for degrees in DIRECTIONS.values():
                    for seed in range(options.pushes):
                        side = (degrees[seed % 2],) * 2
                        push = Push((100.0, 100.0), side, at_seconds=(2.0, 3.0))
                        pushed = EpisodeConfig(
                            dimensions=robot.dimensions, stepping=TRAINED_STEPPING, push=push, time_limit=5.65
                        )
                        specs.append(EpisodeSpec(v, seed, "balance", pushed))
                results = list(pool.map(simulate_robot, [robot.legs] * len(specs), specs, chunksize=4))
                free, rest = results[: options.unpushed], results[options.unpushed :]
                cells += [f"{mean(r.score for r in free):.2f}", f"{mean(r.steps_per_second for r in free):.2f}"]
                for group in (rest[: options.pushes], rest[options.pushes :]):
                    cells.append(f"{mean(r.survived for r in group):.2f}")
            print(f"| {robot.name} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
