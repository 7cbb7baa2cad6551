"""Which flexion law helps against pushes from front and back: candidates on the same pushes, at several settings.

Every candidate keeps V1 = 1 on abduction and uses V3 on flexion. Signals: ``acceleration``, the forward acceleration
after a low-pass of 0.3 s; ``angle``, the postural angle asin(a_y / |a|) after the same; ``pitch``, the leaky integral
of the rate about x; ``rate``, that rate itself. Legs: ``both``, ``swing``, ``support``, ``held`` (the swing leg, which
then lets go with a time constant of 0.3 s while it supports), ``sampled`` (both, by the signal when the legs swapped).
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from statistics import mean

from sarah.control.hip_law import HIP_SPEED, LARGEST_ANGLE, BalanceParameters, HipLaw
from sarah.episode.episode import Episode
from sarah.episode.push import Push
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import TRAINED_STEPPING, EpisodeConfig
from sarah.episode.tasks import BALANCE
from sarah.reports.robustness import wilson_interval
from sarah.robot.filters import LowPass, ramped
from sarah.robot.reading import SensorReading, Side
from sarah.simulation.physics import Physics

SCALES = {"acceleration": 0.05, "angle": 0.5, "pitch": 2.5, "rate": 0.15}
"""Radians of flexion per unit of the signal, at V3 = 1."""
LEGS = ("both", "swing", "support", "held", "sampled")
SETTINGS = {
    "100 Hz, standard": Physics(),
    "100 Hz, 300 Hz x 40": Physics(300, 40, 100, added_plate_inertia=0.0),
    "100 Hz, 600 Hz x 60": Physics(600, 60, 100, added_plate_inertia=0.0),
    "200 Hz, 400 Hz x 40": Physics(400, 40, 200, added_plate_inertia=0.0),
    "200 Hz, 600 Hz x 60": Physics(600, 60, 200, added_plate_inertia=0.0),
}
"""Control rate, and physics steps and solver iterations."""


class Candidate(HipLaw):
    """The package's abduction with another flexion."""

    def __init__(self, signal: str, legs: str, v3: float, dt: float) -> None:
        super().__init__(BalanceParameters(1.0, 0.0, 0.0, 0.0), dt)
        self._signal, self._legs, self._gain = signal, legs, SCALES[signal] * v3
        self._step = HIP_SPEED * dt
        self._release = math.exp(-dt / 0.3)
        self._acceleration, self._angle, self._rate = LowPass(0.3, dt), LowPass(0.3, dt), LowPass(0.02, dt)
        self._swing_before: Side | None = None
        self._sample = 0.0
        self._kept = dict(self.flexion)

    def sense(self, reading: SensorReading) -> None:
        super().sense(reading)
        x, y, z = reading.acceleration
        self._acceleration(max(-20.0, min(20.0, y)))
        self._angle(math.asin(y / max(math.sqrt(x * x + y * y + z * z), abs(y), 1e-9)))
        self._rate(reading.angular_rate[0])

    def tick(self, swing: Side) -> None:
        super().tick(swing)  # for the abduction
        signals = {
            "acceleration": self._acceleration.value,
            "angle": self._angle.value,
            "pitch": self.pitch,
            "rate": self._rate.value,
        }
        goal = self._gain * signals[self._signal]
        if swing is not self._swing_before:
            self._swing_before, self._sample = swing, goal
        goals = {
            "both": {swing: goal, swing.other: goal},
            "swing": {swing: goal, swing.other: 0.0},
            "support": {swing: 0.0, swing.other: goal},
            "held": {swing: goal, swing.other: self._release * self._kept[swing.other]},
            "sampled": {swing: self._sample, swing.other: self._sample},
        }[self._legs]
        for side in Side:
            wanted = max(-LARGEST_ANGLE, min(LARGEST_ANGLE, goals[side]))
            self._kept[side] = ramped(self._kept[side], wanted, self._step)
        self.flexion = dict(self._kept)


@dataclass(frozen=True)
class Job:
    signal: str
    legs: str
    v3: float
    seed: int
    config: EpisodeConfig


def simulate(job: Job) -> EpisodeResult:
    episode = Episode(job.config, job.seed, BALANCE)
    try:
        episode.stand()
        episode.start((1.0, 0.0, 0.0, 0.0))
        candidate = Candidate(job.signal, job.legs, job.v3, job.config.physics.control_dt)
        for reading in episode.standing:
            candidate.sense(reading)
        episode.generator.hips = candidate
        while episode.termination is None:
            episode.tick()
        return episode.result()
    finally:
        episode.close()


def candidates(text: Sequence[str]) -> list[tuple[str, str, float]]:
    if text:
        return [(signal, legs, float(v3)) for signal, legs, v3 in (item.split(":") for item in text)]
    return [(signal, legs, v3) for signal in SCALES for legs in LEGS for v3 in (-1.0, 1.0)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("laws", nargs="*", metavar="SIGNAL:LEGS:V3", help="by default all of them, with V3 = -1 and 1")
    parser.add_argument("--newtons", type=float, default=115.0)
    parser.add_argument("--pushes", type=int, default=200)
    parser.add_argument("--unpushed", type=int, default=2)
    parser.add_argument("--first-seed", type=int, default=20_000)
    parser.add_argument("--settings", type=int, default=len(SETTINGS), help="how many of the settings")
    options = parser.parse_args()

    laws = [("pitch", "swing", 0.0), *candidates(options.laws)]
    force = (options.newtons, options.newtons)
    print(
        "| setting | signal | legs | V3 | survival | score | unpushed score | steps/s | vibration |\n"
        + "|---" * 9
        + "|"
    )
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
        for name, physics in list(SETTINGS.items())[: options.settings]:
            for signal, legs, v3 in laws:
                results = []
                # Forward and backward in turn; a robot that falls has left the box within a second.
                for newtons, seconds, count in ((force, 5.15, options.pushes), ((0.0, 0.0), 12.0, options.unpushed)):
                    jobs = []
                    for index in range(count):
                        degrees = (90.0, 90.0) if index % 2 else (270.0, 270.0)
                        push = Push(newtons, degrees, at_seconds=(2.0, 3.0))
                        config = EpisodeConfig(physics, stepping=TRAINED_STEPPING, push=push, time_limit=seconds)
                        jobs.append(Job(signal, legs, v3, options.first_seed + index, config))
                    results.append(list(pool.map(simulate, jobs, chunksize=2)))
                pushed, free = results
                survived = sum(result.survived for result in pushed)
                low, high = wilson_interval(survived, len(pushed))
                print(
                    f"| {name} | {signal} | {legs} | {v3:g} | {survived / len(pushed):.2f} ({low:.2f} to {high:.2f}) "
                    f"| {mean(r.score for r in pushed):.2f} | {mean(r.score for r in free):.2f} "
                    f"| {mean(r.steps_per_second for r in free):.2f} | {mean(r.vibration for r in free):.1f} |",
                    flush=True,
                )


if __name__ == "__main__":
    main()
