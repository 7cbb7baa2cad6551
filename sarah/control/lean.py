"""How far the leg that carries leans over its foot, about one horizontal axis, and how far it soon will."""

from __future__ import annotations

from sarah.control.constants import ControllerConstants
from sarah.robot.filters import LowPass, clipped


class Lean:
    """Lean of a leg that carries, from a gyroscope and the leg's hip joint. Call it once per control period.

        lean = turned + joint + low-pass of (rate + speed of the joint) / 4

    A lean and a quarter of its rate say where a pendulum that falls over its foot is going: the capture point (Pratt et
    al. 2006, Humanoids), as an angle. The joint's angle, and not its target, belongs to it, because a servo gives way
    when the robot falls.

    :param dt: control period, in s
    :param constants: time constants and limits of the controller
    """

    def __init__(self, dt: float, constants: ControllerConstants) -> None:
        self.turned = 0.0
        """Angle by which the torso has lately turned, in rad: the leaky integral of its rate."""
        self._dt = dt
        self._constants = constants
        self._rate = LowPass(constants.fall_time_constant, dt)

    def __call__(self, rate: float, joint: float, speed: float) -> float:
        """Follow one reading, and return the lean, in rad.

        :param rate: rate of the torso about the axis, in rad/s
        :param joint: angle of the hip joint of the leg that carries, which leans the leg over its foot if positive, in
            rad
        :param speed: speed of that joint, in rad/s
        """
        constants = self._constants
        self.turned += self._dt * (rate - self.turned / constants.lean_time_constant)
        return self.turned + joint + self._rate(clipped(rate + speed, constants.largest_rate)) / constants.fall_rate
