"""The hip law: how V1 to V4 move the hips so that the robot steps back to where it stood.

    abduction of either hip       -0.05 (V1 stable_x + V2), and outward by the spread
    flexion of an unloaded leg    -0.6 V3 fall + 0.02 V4
    flexion of a loaded leg       0.02 V4                     each within 0.3 rad, at 6 rad/s

Positive abduction turns both feet to the left of the torso, positive flexion turns a foot forward. stable_x is the
lateral acceleration after a low-pass of the hips' own, slower than the pattern generator's. With V1 above zero both
feet go to the side that the torso was pushed to.

Spread and fall answer the lean of the leg that carries (:class:`~sarah.control.lean.Lean`), about y and about x::

    spread = 2 V1 (lean outward beyond 0.15 rad)               at 1.5 rad/s, back at 1 rad/s
    fall = low-pass of (lean beyond 0.03 rad)                  falling backward is positive

A robot that tips over the outer edge of its foot spreads both legs. The torso turns over the leg that carries, which
pulls the robot back, and the other foot waits wide where it comes down. A robot that falls forward or backward steps
there with the foot in the air, if V3 is above zero.

The law is a reconstruction. The paper says only that V1 and V3 multiply signals of the x and the y axis, that V2 and
V4 are constants, and that the sums adjust abduction and flexion. Laws with the forward acceleration did not help, for
a reason: where the torso sits, the acceleration of a falling robot and its tilt cancel in the accelerometer
(docs/results/decisions.md compares the laws).
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

from sarah.control.constants import STANDARD_CONSTANTS, ControllerConstants
from sarah.control.lean import Lean
from sarah.number import to_floats
from sarah.robot.filters import LowPass, clipped, ramped
from sarah.robot.reading import SensorReading, Side


@dataclass(frozen=True)
class BalanceParameters:
    """The four parameters of the Second Training, each within -2 and 2; zeros lock the hips.

    :param V1: gain from the lateral acceleration to the abduction of both hips, and from tipping over to their spread
    :param V2: constant added to the lateral acceleration, in m/s^2
    :param V3: gain from a fall forward or backward to the step of a leg in the air
    :param V4: constant flexion of both legs, in units of 0.02 rad
    """

    V1: float
    V2: float
    V3: float
    V4: float

    def __post_init__(self) -> None:
        """Make floats of all of them."""
        to_floats(self, *self.__dataclass_fields__)


LOCKED_HIPS = BalanceParameters(0.0, 0.0, 0.0, 0.0)
"""V1 to V4 of the First Training, in which the hips stay straight."""
PAD_SECONDS = 0.01
"""Time over which the pads are averaged, in s: the noise of a single sample grows with the control rate."""
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
    """Sum of the two pads of each foot, in N: the mean of the readings of the last 0.01 s."""
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
        """Abduction that both hips share, in rad."""
        self.spread = 0.0
        """Angle by which either leg is turned outward, in rad."""
        self.abductions = {Side.LEFT: 0.0, Side.RIGHT: 0.0}
        """Abduction of each leg, in rad: what both share, and its spread."""
        self.flexion = {Side.LEFT: 0.0, Side.RIGHT: 0.0}
        self.abduction_rate = 0.0
        """Speed of the shared abduction in the last tick, in rad/s."""
        self.parameters = parameters
        self.loads = {Side.LEFT: 0.0, Side.RIGHT: 0.0}
        self.limited = set()
        self._constants = constants
        self._dt = dt
        self._limits = limits
        self._stable_x = LowPass(constants.stable_time_constant, dt)
        self._recent_loads: deque[tuple[float, float]] = deque(maxlen=max(1, round(PAD_SECONDS / dt)))
        self._pitch, self._roll = Lean(dt, constants), Lean(dt, constants)
        self._fall = LowPass(constants.fall_time_constant, dt)
        self.outward_lean = 0.0
        """Angle at which the leg that carries leans outward over its foot, and soon will, in rad."""
        self._carrying = Side.LEFT
        self._joints: tuple[float, ...] | None = None

    @property
    def stable_x(self) -> float:
        """The hips' low-passed lateral acceleration, in m/s^2."""
        return self._stable_x.value

    @property
    def pitch(self) -> float:
        """Angle by which the torso has lately turned about its x axis, in rad; backward is positive."""
        return self._pitch.turned

    @property
    def fall(self) -> float:
        """Angle at which the leg that carries falls over its foot, in rad; falling backward is positive."""
        return self._fall.value

    @property
    def sway(self) -> float:
        """Abduction without V2's constant, in rad: the part that comes and goes with the rocking.

        The constant counts as far as the limits let it.
        """
        return self.abduction - self._constant_abduction

    def sense(self, reading: SensorReading, periods: int = 1) -> None:
        """Filter one reading without acting on it, as while standing.

        :param reading: finite sensor reading of this tick, clipped and corrected by the
            :class:`~sarah.control.baselines.Baselines`
        :param periods: control periods since the last reading
        """
        loads = self.loads = self._mean_loads(reading.pressures, periods)
        if max(loads.values()) > self._constants.pad_threshold:
            self._carrying = Side.LEFT if loads[Side.LEFT] > loads[Side.RIGHT] else Side.RIGHT
        joints = self._plausible(reading.joints)
        before, self._joints = self._joints or joints, joints
        abduction, flexion = (0, 2) if self._carrying is Side.LEFT else (1, 3)
        seconds = periods * self._dt
        abduction_speed = (joints[abduction] - before[abduction]) / seconds
        flexion_speed = (joints[flexion] - before[flexion]) / seconds
        rate_x, rate_y, _ = reading.angular_rate
        straight = self._within_limits(self._constant_flexion, (flexion,))
        for _ in range(periods):
            self._stable_x(reading.acceleration[0])
            lean = self._pitch(rate_x, joints[flexion] - straight, flexion_speed)
            self._fall(lean - clipped(lean, self._constants.fall_dead_band))
            roll = self._roll(rate_y, joints[abduction] - self._constant_abduction, abduction_speed)
        self.outward_lean = self._carrying.value * roll

    def _mean_loads(self, pressures: tuple[float, float, float, float], periods: int) -> dict[Side, float]:
        """Loads of the feet, as means over the time of the pads."""
        left_fore, left_hind, right_fore, right_hind = pressures
        recent = self._recent_loads
        recent.extend([(left_fore + left_hind, right_fore + right_hind)] * min(periods, recent.maxlen or 1))
        left, right = map(sum, zip(*recent, strict=True))
        return {Side.LEFT: left / len(recent), Side.RIGHT: right / len(recent)}

    def _plausible(self, joints: Sequence[float]) -> tuple[float, ...]:
        """Positions of the hip joints, as far as a servo can be from its target: a stuck sensor is not a fall."""
        largest = self._constants.largest_servo_error
        targets = (*self.abductions.values(), *self.flexion.values())
        return tuple([target + clipped(joints[index] - target, largest) for index, target in enumerate(targets)])

    def tick(self, periods: int = 1) -> None:
        """Move the targets.

        :param periods: control periods to move them by
        """
        abduction, flexion = self._wanted()
        self.limited = set()
        before = self.abduction
        self.abduction = self._moved(before, abduction, (0, 1), periods)
        self.abduction_rate = (self.abduction - before) / (periods * self._dt)
        self._move_spread(periods)
        for joint, side in enumerate(Side):
            outward = self.abduction - side.value * self.spread
            self.abductions[side] = self._moved(self.abductions[side], outward, (joint,), periods)
            self.flexion[side] = self._moved(self.flexion[side], flexion[side], (joint + 2,), periods)

    def _move_spread(self, periods: int) -> None:
        constants = self._constants
        beyond = max(0.0, self.outward_lean - constants.spread_dead_band)
        goal = min(constants.largest_hip_angle, max(0.0, constants.spread_gain * self.parameters.V1 * beyond))
        speed = constants.spread_speed if goal > self.spread else constants.spread_return_speed
        self.spread = ramped(self.spread, goal, speed * self._dt * periods)

    def _wanted(self) -> tuple[float, dict[Side, float]]:
        """Abduction and flexions that the law asks for, before limits and ramps."""
        v, constants = self.parameters, self._constants
        flexion = dict.fromkeys(Side, self._constant_flexion)
        for side in Side:
            if self.loads[side] < constants.pad_threshold:
                flexion[side] = -constants.capture_gain * v.V3 * self.fall + flexion[side]
        return -constants.abduction_scale * (v.V1 * self.stable_x + v.V2), flexion

    @property
    def _constant_abduction(self) -> float:
        """V2's part of the abduction, as far as the limits let it."""
        return self._within_limits(-self._constants.abduction_scale * self.parameters.V2, (0, 1))

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
            if angle > high:
                angle = high
            if angle < low:
                angle = low
        return angle
