"""The hip law: how V1 to V4 tilt the hips so that the robot steps back to where it stood.

    abduction of both hips      -0.05 (V1 stable_x + V2)
    flexion of the swing leg    2.5 V3 pitch + 0.02 V4
    flexion of the support leg  0.02 V4                     each within 0.3 rad, at 6 rad/s

Positive abduction turns both feet to the left of the torso, positive flexion turns a foot forward. stable_x is the
lateral acceleration after a low-pass of its own, slower than the pattern generator's; with V1 above zero both feet go
to the side that the torso was pushed to. pitch is how far the torso has lately turned about its x axis, the leaky
integral of that rate; with V3 above zero the swing leg turns on with the fall, and takes up momentum that would
otherwise tip the robot over the support foot.

A reconstruction: the paper says only that V1 and V3 multiply signals of the x and the y axis, that V2 and V4 are
constants, and that the sums adjust abduction and flexion. Its forward acceleration gave no law that helps, for a
reason: where the torso sits, the acceleration of a falling robot and its tilt cancel in the accelerometer
(benchmarks/hip_laws.py compares the candidates).
"""

from __future__ import annotations

from dataclasses import dataclass

from sarah.robot.filters import LowPass, ramped
from sarah.robot.reading import SensorReading, Side

ABDUCTION_SCALE = 0.05
"""Radians of abduction per m/s^2."""
PITCH_SCALE = 2.5
"""Radians of swing leg flexion per radian of pitch, at V3 = 1."""
FLEXION_SCALE = 0.02
"""Radians of constant flexion at V4 = 1; 0.1 rad would lean the robot over its toes."""
LARGEST_ANGLE = 0.3
"""Of either hip target, in rad."""
HIP_SPEED = 6.0
"""Of the ramp that hip targets follow, in rad/s."""
STABLE_TIME_CONSTANT = 0.30
"""Of the hips' own low-pass of the lateral acceleration, in s."""
PITCH_TIME_CONSTANT = 1.0
"""Over which the integral of the rate about x forgets, in s: longer than a fall, and it forgets a gyroscope's bias."""
LARGEST_ACCELERATION = 20.0
"""Accelerations are clipped to this, in m/s^2, before the low-pass."""
LARGEST_RATE = 10.0
"""Rates about x are clipped to this, in rad/s, before they are integrated."""


@dataclass(frozen=True)
class BalanceParameters:
    """The four parameters of the second training, each within -2 and 2; zeros lock the hips.

    :param V1: how much the lateral acceleration abducts both hips
    :param V2: constant added to it, in m/s^2
    :param V3: how much the torso's pitch flexes the swing leg
    :param V4: constant flexion of both legs, in units of 0.02 rad
    """

    V1: float
    V2: float
    V3: float
    V4: float


class HipLaw:
    """Hip targets from sensors. Call :meth:`sense` and then :meth:`tick` once per control tick.

    :param parameters: V1 to V4
    :param dt: control period in s
    """

    def __init__(self, parameters: BalanceParameters, dt: float) -> None:
        self.abduction = 0.0
        self.flexion = {Side.LEFT: 0.0, Side.RIGHT: 0.0}
        self.pitch = 0.0
        self._abduction_before = 0.0
        self._parameters = parameters
        self._dt = dt
        self._stable_x = LowPass(STABLE_TIME_CONSTANT, dt)

    @property
    def stable_x(self) -> float:
        """The hips' low-passed lateral acceleration, in m/s^2."""
        return self._stable_x.value

    @property
    def sway(self) -> float:
        """Abduction without V2's constant, in rad: what of it comes and goes with the rocking."""
        return self.abduction + ABDUCTION_SCALE * self._parameters.V2

    @property
    def abduction_rate(self) -> float:
        """How fast the last tick moved the abduction target, in rad/s."""
        return (self.abduction - self._abduction_before) / self._dt

    def sense(self, reading: SensorReading) -> None:
        """Filter one reading without acting on it, as while standing."""
        self._stable_x(_clipped(reading.acceleration[0], LARGEST_ACCELERATION))
        rate = _clipped(reading.angular_rate[0], LARGEST_RATE)
        self.pitch += self._dt * (rate - self.pitch / PITCH_TIME_CONSTANT)

    def tick(self, swing: Side) -> None:
        """Move the targets by one control tick.

        :param swing: the leg that swings
        """
        v = self._parameters
        constant = FLEXION_SCALE * v.V4
        self._abduction_before = self.abduction
        self.abduction = self._moved(self.abduction, -ABDUCTION_SCALE * (v.V1 * self.stable_x + v.V2))
        self.flexion[swing] = self._moved(self.flexion[swing], PITCH_SCALE * v.V3 * self.pitch + constant)
        self.flexion[swing.other] = self._moved(self.flexion[swing.other], constant)

    def _moved(self, now: float, goal: float) -> float:
        return ramped(now, _clipped(goal, LARGEST_ANGLE), HIP_SPEED * self._dt)


def _clipped(value: float, limit: float) -> float:
    return max(-limit, min(limit, value))
