"""Which flexion law helps against pushes from front and back: candidates on the same pushes, at several settings.

Every candidate keeps V1 = 1 on abduction and uses V3 on flexion. The package's law flexes the unloaded leg against the
``fall``. Signals of the others: ``acceleration``, the forward acceleration
after a low-pass of 0.3 s; ``angle``, the postural angle asin(a_y / |a|) after the same; ``pitch``, the leaky integral
of the rate about x. Legs: ``both``, ``swing``, ``held`` (the swing leg, which then lets go with a time constant of
0.3 s while it supports), ``sampled`` (both, by the signal when the legs swapped).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from statistics import mean
from typing import NamedTuple

from experiments.experiment import OnWorkers
from experiments.record import Row
from sarah.control.constants import ControllerConstants
from sarah.control.hip_law import BalanceParameters, HipLaw
from sarah.control.pattern_generator import PatternGenerator
from sarah.episode.episode import Episode
from sarah.episode.push import Push
from sarah.episode.result import EpisodeResult
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.episode.workers import Workers
from sarah.reports.robustness import wilson_interval
from sarah.robot.filters import LowPass, clipped, low_pass_gain, ramped
from sarah.robot.reading import SensorReading, Side
from sarah.simulation.physics import PyBulletPhysics

SCALES = {"acceleration": 0.05, "angle": 0.5, "pitch": 2.5}
"""Radians of flexion per unit of the signal, at V3 = 1."""
SECONDS = 0.3
"""Time constant of the signals' low-pass, and of a leg that lets go, in s."""
V = (1.0, 0.0, 0.0, 0.0)
"""V1 to V4 of the abduction."""


class Law(NamedTuple):
    """A flexion law.

    :param signal: signal that flexes: ``fall``, or one of :data:`SCALES`
    :param legs: legs that flex
    :param v3: gain
    """

    signal: str
    legs: str
    v3: float


OWN_LAWS = (Law("fall", "unloaded", 0.0), Law("fall", "unloaded", 1.0))
"""The package's, with V3 = 0 and with V3 = 1."""
LAWS = (
    *OWN_LAWS,
    Law("pitch", "swing", 1.0),
    Law("acceleration", "both", 1.0),
    Law("acceleration", "held", 1.0),
    Law("acceleration", "sampled", 1.0),
    Law("angle", "swing", 1.0),
)
FINER = (
    PyBulletPhysics(300, 40, 100, added_plate_inertia=0.0),
    PyBulletPhysics(600, 60, 100, added_plate_inertia=0.0),
    PyBulletPhysics(400, 40, 200, added_plate_inertia=0.0),
    PyBulletPhysics(600, 60, 200, added_plate_inertia=0.0),
)
"""Settings of PyBullet without added inertia, at two control rates."""
FIRST_SEED = 20_000
PUSHED_SECONDS, FREE_SECONDS = 5.15, 12.0
"""Time limits with a push and without; a robot that falls has left the box within a second."""


class Candidate(HipLaw):
    """The package's abduction with another flexion.

    :param law: the other flexion
    :param generator: pattern generator that knows which leg swings
    :param dt: control period, in s
    """

    def __init__(self, law: Law, generator: PatternGenerator, dt: float) -> None:
        constants = ControllerConstants()
        super().__init__(BalanceParameters(*V), dt, constants)
        self._generator = generator
        self._law, self._gain = law, SCALES[law.signal] * law.v3
        self._limit, self._step = constants.largest_hip_angle, constants.hip_speed * dt
        self._largest = constants.largest_acceleration
        self._release = 1.0 - low_pass_gain(SECONDS, dt)
        self._acceleration, self._angle = LowPass(SECONDS, dt), LowPass(SECONDS, dt)
        self._swing_before: Side | None = None
        self._sample = 0.0
        self._kept = dict(self.flexion)

    def sense(self, reading: SensorReading, periods: int = 1) -> None:
        """Filter one reading without acting on it, as while standing."""
        super().sense(reading, periods)
        x, y, z = reading.acceleration
        self._acceleration(clipped(y, self._largest))
        self._angle(math.asin(y / max(math.sqrt(x * x + y * y + z * z), abs(y), 1e-9)))

    def tick(self, periods: int = 1) -> None:
        """Move the targets by one control tick."""
        super().tick(periods)  # for the abduction
        swing = self._generator.swing
        signals = {"acceleration": self._acceleration.value, "angle": self._angle.value, "pitch": self.pitch}
        goal = self._gain * signals[self._law.signal]
        if swing is not self._swing_before:
            self._swing_before, self._sample = swing, goal
        goals = {
            "both": {swing: goal, swing.other: goal},
            "swing": {swing: goal, swing.other: 0.0},
            "held": {swing: goal, swing.other: self._release * self._kept[swing.other]},
            "sampled": {swing: self._sample, swing.other: self._sample},
        }[self._law.legs]
        for side in Side:
            self._kept[side] = ramped(self._kept[side], clipped(goals[side], self._limit), self._step)
        self.flexion = dict(self._kept)


def simulate(law: Law, seed: int, config: BalanceConfig) -> EpisodeResult:
    """Simulate an episode with the package's hip law, or with a candidate in its place.

    :param law: flexion law
    :param seed: seed of the episode
    :param config: settings of the episode
    """
    episode = Episode(config, seed, BALANCE)
    try:
        if law.signal in SCALES:
            episode.generator.hips = Candidate(law, episode.generator, config.physics.control_dt)
        episode.stand()
        v1, v2, _, v4 = V
        episode.start((v1, v2, law.v3, v4))
        while episode.termination is None:
            episode.tick()
        return episode.result()
    finally:
        episode.close()


@dataclass(frozen=True)
class FlexionLaws(OnWorkers):
    """Flexion laws on pushes from front and back in turn, and without a push.

    :param settings: number of the settings of the physics, from the first
    :param pushes: number of pushes
    :param newtons: force of the pushes, in N
    :param unpushed: number of episodes without a push
    """

    settings: int = len(FINER)
    pushes: int = 200
    newtons: float = 105.0
    unpushed: int = 2

    def rows(self) -> Iterator[Row]:
        """A row for each setting and law."""
        with Workers(self.workers) as workers:
            for physics in FINER[: self.settings]:
                for law in LAWS:
                    pushed = simulated(physics, law, self.newtons, PUSHED_SECONDS, self.pushes, workers)
                    free = simulated(physics, law, 0.0, FREE_SECONDS, self.unpushed, workers)
                    yield {
                        **setting(physics),
                        **survival(law, pushed),
                        "score": mean(result.score for result in pushed),
                        "unpushed_score": mean(result.score for result in free),
                        "unpushed_steps_per_second": mean(result.steps_per_second for result in free),
                        "unpushed_vibration_m2_s4": mean(result.vibration for result in free),
                    }


@dataclass(frozen=True)
class FlexionLawsToday(OnWorkers):
    """The package's law with V3 and without, on pushes from front and back in turn.

    :param pushes: number of pushes
    :param newtons: force of the pushes, in N
    """

    pushes: int = 200
    newtons: float = 105.0

    def rows(self) -> Iterator[Row]:
        """A row for each setting and value of V3."""
        with Workers(self.workers) as workers:
            for physics in (PyBulletPhysics(), FINER[0]):
                for law in OWN_LAWS:
                    pushed = simulated(physics, law, self.newtons, PUSHED_SECONDS, self.pushes, workers)
                    inertia = {"added_plate_inertia_kg_m2": f"{physics.added_plate_inertia:g}"}
                    yield {**setting(physics), **inertia, **survival(law, pushed)}


def simulated(
    physics: PyBulletPhysics, law: Law, newtons: float, limit: float, count: int, workers: Workers
) -> list[EpisodeResult]:
    """Results of episodes with pushes from front and back in turn.

    :param physics: setting of PyBullet
    :param law: flexion law
    :param newtons: force of the pushes, in N
    :param limit: time limit of an episode, in s
    :param count: number of episodes
    :param workers: who simulates
    """
    jobs = []
    for index in range(count):
        degrees = 90.0 if index % 2 else 270.0
        push = Push((newtons, newtons), (degrees, degrees), at_seconds=(2.0, 3.0))
        config = BalanceConfig(physics, engine="pybullet", push=push, time_limit=limit)
        jobs.append(workers.submit(simulate, law, FIRST_SEED + index, config))
    return [job.result() for job in jobs]


def setting(physics: PyBulletPhysics) -> Row:
    """Columns of a setting of the physics.

    :param physics: the setting
    """
    return {
        "control_rate_hz": physics.control_rate,
        "physics_rate_hz": physics.rate,
        "solver_iterations": physics.solver_iterations,
    }


def survival(law: Law, pushed: list[EpisodeResult]) -> Row:
    """Columns of a law, and of what it survived.

    :param law: flexion law
    :param pushed: results of episodes with a push
    """
    survived = sum(result.survived for result in pushed)
    low, high = wilson_interval(survived, len(pushed))
    share = {"survival": survived / len(pushed), "survival_low": low, "survival_high": high}
    return {"signal": law.signal, "legs": law.legs, "V3": f"{law.v3:g}", **share}
