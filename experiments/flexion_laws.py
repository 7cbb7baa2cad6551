"""Which flexion law saves the robot from pushes from front and back: the package's and two others on the same pushes.

V1 is 1 throughout, and V3 multiplies the signal of each law. The package's steps with the unloaded leg to where the
robot falls. The others flex the swing leg by the torso's ``pitch``, or by the ``postural angle`` of the paper, which is
asin(a_y / |a|) after a low-pass. The paper does not give the sign of the latter.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import get_args

from experiments.maker import ParallelExperiment, survival
from experiments.record import Row
from sarah.control.hip_law import LOCKED_HIPS, HipLaw
from sarah.control.pattern_generator import PatternGenerator
from sarah.episode.episode import Episode
from sarah.episode.evaluation import Evaluation
from sarah.episode.push import Push
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import FIRST_EVALUATION_SEED
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.episode.workers import Workers
from sarah.robot.filters import LowPass
from sarah.robot.reading import SensorReading, Side
from sarah.simulation.engines import Engine
from sarah.simulation.physics import PHYSICS

LAWS = (("none", 0.0), ("capture step", 1.0), ("pitch", 1.0), ("postural angle", 1.0), ("postural angle", -1.0))
"""Laws and their V3."""
SCALES = {"pitch": 2.5, "postural angle": 0.5}
"""Flexion of the swing leg per signal of the laws that are not the package's, at V3 = 1, in rad per rad."""
ANGLE_SECONDS = 0.3
"""Time constant of the postural angle's low-pass, in s."""
REFERENCE_NEWTONS = 115.0
"""Force of the pushes at the reference physics, in N."""


class SwingLegFlexion(HipLaw):
    """The package's abduction, with a flexion of the swing leg by another signal.

    :param law: name of the flexion law
    :param generator: pattern generator that knows which leg swings
    :param dt: control period, in s
    """

    def __init__(self, law: str, generator: PatternGenerator, dt: float) -> None:
        super().__init__(LOCKED_HIPS, dt)
        self._law = law
        self._generator = generator
        self._angle = LowPass(ANGLE_SECONDS, dt)

    def sense(self, reading: SensorReading, periods: int = 1) -> None:
        """Filter one reading without acting on it, as while standing."""
        super().sense(reading, periods)
        x, y, z = reading.acceleration
        self._angle(math.atan2(y, math.hypot(x, z)))  # the same as asin(a_y / |a|)

    def tick(self, periods: int = 1) -> None:
        """Move the targets."""
        flexion = dict(self.flexion)
        super().tick(periods)  # for the abduction
        signal = self.pitch if self._law == "pitch" else self._angle.value
        for joint, side in enumerate(Side, start=2):
            goal = SCALES[self._law] * self.parameters.V3 * signal if side is self._generator.swing else 0.0
            flexion[side] = self._moved(flexion[side], goal, (joint,), periods)
        self.flexion = flexion


def simulate(law: str, v3: float, seed: int, config: BalanceConfig) -> EpisodeResult:
    """Simulate an episode with a flexion law.

    :param law: name of the law
    :param v3: value of V3
    :param seed: seed of the episode
    :param config: settings of the episode
    """
    with Episode(config, seed, BALANCE) as episode:
        if law in SCALES:
            generator = episode.robot.generator
            generator.hips = SwingLegFlexion(law, generator, config.physics.control_dt)
        episode.stand()
        return episode.run((1.0, 0.0, v3, 0.0))


@dataclass(frozen=True)
class FlexionLaws(ParallelExperiment):
    """Flexion laws on pushes from front and back in turn, and without a push, in both engines.

    :param newtons: forces of the pushes, in N
    :param pushes: number of pushes of each force
    :param reference_pushes: number of pushes of 115 N in PyBullet at the reference physics; with 0 there is no such row
    :param unpushed: number of episodes without a push
    :param time_limit: time limit of an episode, in s; a push comes at 2 to 3 s
    """

    newtons: tuple[float, ...] = (105.0, 115.0, 130.0)
    pushes: int = 200
    reference_pushes: int = 60
    unpushed: int = 20
    time_limit: float = 6.0

    def rows(self) -> Iterator[Row]:
        """A row for each engine, physics, force and law."""
        cases: list[tuple[Engine, str, float, int]] = []
        for engine in get_args(Engine):
            cases.append((engine, "standard", 0.0, self.unpushed))
            cases += [(engine, "standard", newtons, self.pushes) for newtons in self.newtons]
        if self.reference_pushes:
            cases.append(("pybullet", "reference", REFERENCE_NEWTONS, self.reference_pushes))
        with Workers(self.workers) as workers:
            for engine, physics, newtons, count in cases:
                configs = [
                    BalanceConfig(
                        PHYSICS[physics],
                        engine,
                        push=Push((newtons, newtons), (degrees, degrees), at_seconds=(2.0, 3.0)),
                        time_limit=self.time_limit,
                    )
                    for degrees in (90.0, 270.0)
                ]
                for law, v3 in LAWS:
                    jobs = [
                        workers.submit(simulate, law, v3, FIRST_EVALUATION_SEED + index, configs[index % 2])
                        for index in range(count)
                    ]
                    found = Evaluation(tuple(job.result() for job in jobs))
                    yield {
                        "engine": engine,
                        "physics": physics,
                        "law": law,
                        "V3": f"{v3:g}",
                        "push_n": f"{newtons:g}",
                        **survival(found),
                        "score": found.mean("score"),
                        "steps_per_second": found.mean("steps_per_second"),
                        "vibration_m2_s4": found.median("vibration"),
                    }
