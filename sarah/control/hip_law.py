"""The hip law: how V1 to V4 move the hips so that the robot steps back to where it stood.

    abduction of both hips        -0.05 (V1 stable_x + V2)
    flexion of an unloaded leg    -0.6 V3 fall + 0.02 V4
    flexion of a loaded leg       0.02 V4                     each within 0.3 rad, at 6 rad/s

Positive abduction turns both feet to the left of the torso, positive flexion turns a foot forward. stable_x is the
lateral acceleration after a low-pass of the hips' own, slower than the pattern generator's. With V1 above zero both
feet go to the side that the torso was pushed to.

The fall is the angle at which the leg that carries leans back over its foot, and will lean soon::

    lean = pitch + its flexion joint - 0.02 V4 + low-pass of (rate about x + speed of that joint) / 4
    fall = low-pass of (lean beyond 0.03 rad)

pitch is how far the torso has lately turned about its x axis: the leaky integral of that rate. The joint's angle, and
not its target, belongs to the lean, because a servo gives way when the robot falls. A lean and a quarter of its rate
say where a pendulum that falls over its foot is going (the capture point). With V3 above zero the foot in the air steps
there: forward when the robot falls forward.

The law is a reconstruction. The paper says only that V1 and V3 multiply signals of the x and the y axis, that V2 and
V4 are constants, and that the sums adjust abduction and flexion. Laws with the forward acceleration did not help, for
a reason: where the torso sits, the acceleration of a falling robot and its tilt cancel in the accelerometer
(``make results NAME=flexion_laws`` compares the laws).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from sarah.control.constants import STANDARD_CONSTANTS, ControllerConstants
from sarah.robot.filters import LowPass, clipped, ramped
from sarah.robot.reading import SensorReading, Side


@dataclass(frozen=True)
class BalanceParameters:
    """The four parameters of the Second Training, each within -2 and 2; zeros lock the hips.

    :param V1: gain from the lateral acceleration to the abduction of both hips
    :param V2: constant added to that acceleration, in m/s^2
    :param V3: gain from a fall forward or backward to the step of a leg in the air
    :param V4: constant flexion of both legs, in units of 0.02 rad
    """

    V1: float
    V2: float
    V3: float
    V4: float


LOCKED_HIPS = BalanceParameters(0.0, 0.0, 0.0, 0.0)
"""V1 to V4 of the First Training, in which the hips stay straight."""
NO_LIMITS = ((-math.inf, math.inf),) * 6
"""Lowest and highest position of each actuated joint, for a robot whose joints have no limits."""


class HipLaw:
    """Hip targets from sensor readings. Call :meth:`sense` and then :meth:`tick` once per control tick.

    :param parameters: values of V1 to V4
    :param dt: control period, in s
    :param constants: gains, limits, speeds and time constants of the controller
    :param limits: lowest and highest position of the joints in the order of ``ACTUATED_JOINTS``, each around zero
    :raises ConfigurationError: if the period is not finite and above zero
    """

    parameters: BalanceParameters
    """Values of V1 to V4 at present."""
    loads: dict[Side, float]
    """Sum of the two pads of each foot in the last reading, in N."""
    limited: set[int]
    """Indices of the hip joints whose limits kept a target of the last tick from where the law wanted it."""

    def __init__(
        self,
        parameters: BalanceParameters,
        dt: float,
        constants: ControllerConstants = STANDARD_CONSTANTS,
        limits: Sequence[tuple[float, float]] = NO_LIMITS,
    ) -> None:
        self.abduction = 0.0
        self.flexion = {Side.LEFT: 0.0, Side.RIGHT: 0.0}
        self.pitch = 0.0
        self.abduction_rate = 0.0
        """Speed of the abduction target in the last tick, in rad/s."""
        self.parameters = parameters
        self.loads = {Side.LEFT: 0.0, Side.RIGHT: 0.0}
        self.limited = set()
        self._constants = constants
        self._dt = dt
        self._limits = limits
        self._stable_x = LowPass(constants.stable_time_constant, dt)
        self._lean_rate = LowPass(constants.fall_time_constant, dt)
        self._fall = LowPass(constants.fall_time_constant, dt)
        self._joints: dict[Side, float] | None = None

    @property
    def stable_x(self) -> float:
        """The hips' low-passed lateral acceleration, in m/s^2."""
        return self._stable_x.value

    @property
    def fall(self) -> float:
        """Angle at which the leg that carries falls over its foot, in rad; falling backward is positive."""
        return self._fall.value

    @property
    def sway(self) -> float:
        """Abduction without V2's constant, in rad: the part that comes and goes with the rocking.

        The constant counts as far as the limits let it.
        """
        return self.abduction - self._within_limits(-self._constants.abduction_scale * self.parameters.V2, (0, 1))

    def sense(self, reading: SensorReading, periods: int = 1) -> None:
        """Filter one reading without acting on it, as while standing.

        :param reading: finite sensor reading of this tick, clipped and corrected by the
            :class:`~sarah.control.baselines.Baselines`
        :param periods: control periods since the last reading
        """
        left_fore, left_hind, right_fore, right_hind = reading.pressures
        loads = self.loads = {Side.LEFT: left_fore + left_hind, Side.RIGHT: right_fore + right_hind}
        carrying = Side.LEFT if loads[Side.LEFT] > loads[Side.RIGHT] else Side.RIGHT
        joints = {Side.LEFT: reading.joints[2], Side.RIGHT: reading.joints[3]}
        speed = (joints[carrying] - (self._joints or joints)[carrying]) / (periods * self._dt)
        self._joints = joints
        for _ in range(periods):
            self._filter(reading.acceleration[0], reading.angular_rate[0], joints[carrying], speed)

    def _filter(self, acceleration: float, rate: float, joint: float, speed: float) -> None:
        """Advance all filters by a control period: lateral acceleration, rate about x, carrying joint and its speed."""
        constants = self._constants
        self._stable_x(acceleration)
        self.pitch += self._dt * (rate - self.pitch / constants.pitch_time_constant)
        lean_rate = self._lean_rate(clipped(rate + speed, constants.largest_rate))
        lean = self.pitch + joint - self._constant_flexion + lean_rate / constants.fall_rate
        self._fall(lean - clipped(lean, constants.fall_dead_band))

    def tick(self, periods: int = 1) -> None:
        """Move the targets.

        :param periods: control periods to move them by
        """
        abduction, flexion = self._wanted()
        self.limited = set()
        before = self.abduction
        self.abduction = self._moved(before, abduction, (0, 1), periods)
        self.abduction_rate = (self.abduction - before) / (periods * self._dt)
        for joint, side in enumerate(Side, start=2):
            self.flexion[side] = self._moved(self.flexion[side], flexion[side], (joint,), periods)

    def _wanted(self) -> tuple[float, dict[Side, float]]:
        """Abduction and flexions that the law asks for, before limits and ramps."""
        v, constants = self.parameters, self._constants
        flexion = dict.fromkeys(Side, self._constant_flexion)
        for side in Side:
            if self.loads[side] < constants.pad_threshold:
                flexion[side] = -constants.capture_gain * v.V3 * self.fall + flexion[side]
        return -constants.abduction_scale * (v.V1 * self.stable_x + v.V2), flexion

    @property
    def _constant_flexion(self) -> float:
        return self._constants.flexion_scale * self.parameters.V4

    def _moved(self, now: float, goal: float, joints: tuple[int, ...], periods: int) -> float:
        wanted = clipped(goal, self._constants.largest_hip_angle)
        for joint in joints:
            low, high = self._limits[joint]
            if not low <= wanted <= high:
                self.limited.add(joint)
        return ramped(now, self._within_limits(goal, joints), self._constants.hip_speed * self._dt * periods)

    def _within_limits(self, angle: float, joints: tuple[int, ...]) -> float:
        """Nearest angle that the largest hip angle and the limits of all these joints allow."""
        angle = clipped(angle, self._constants.largest_hip_angle)
        for joint in joints:
            low, high = self._limits[joint]
            angle = max(low, min(high, angle))
        return angle
