"""Where the torso is over the ground, as the robot's own sensors tell: the feet that carry it, one after the other."""

from __future__ import annotations

import math

from sarah.robot.filters import LowPass
from sarah.robot.reading import SensorReading, Side

LEAK_SECONDS = 1.0
"""Time constant of the leaky integrals of the angular rates, in s: long beside a step, short beside a drift."""

DRIFT_SECONDS = 8.0
"""Time constant of the gyroscope's errors, which are left out, in s."""


class LegOdometry:
    """Displacement of the torso, by the lean of the legs that carry it in turn.

    While a foot carries, the torso is over it by the height times the sine of the leg's lean. When the other foot takes
    over, it takes over where the torso is. Whatever slides or turns about the vertical is not seen.

    :param height: height of the torso's centre while the robot stands, in m
    :param dt: control period, in s
    """

    def __init__(self, height: float, dt: float) -> None:
        self.x = 0.0
        """Displacement to the robot's right, in m."""
        self.y = 0.0
        """Displacement forward, in m."""
        self._height = height
        self._dt = dt
        self._roll = self._pitch = 0.0
        self._drift_x, self._drift_y = LowPass(DRIFT_SECONDS, dt), LowPass(DRIFT_SECONDS, dt)
        self._carrying: Side | None = None
        self._over: dict[Side, tuple[float, float]] = {}

    def tick(self, reading: SensorReading) -> None:
        """Follow one reading.

        :param reading: sensor reading of the tick
        """
        left_fore, left_hind, right_fore, right_hind = reading.pressures
        carrying = Side.LEFT if left_fore + left_hind > right_fore + right_hind else Side.RIGHT
        rate_x, rate_y, _ = reading.angular_rate
        rate_x -= self._drift_x(rate_x)
        rate_y -= self._drift_y(rate_y)
        self._pitch += self._dt * (rate_x - self._pitch / LEAK_SECONDS)
        self._roll += self._dt * (rate_y - self._roll / LEAK_SECONDS)
        over = {
            side: (
                self._height * math.sin(self._roll + reading.joints[abduction]),
                -self._height * math.sin(self._pitch + reading.joints[flexion]),
            )
            for side, abduction, flexion in ((Side.LEFT, 0, 2), (Side.RIGHT, 1, 3))
        }
        if self._carrying is not None:
            (x, y), (x_before, y_before) = over[self._carrying], self._over[self._carrying]
            self.x += x - x_before
            self.y += y - y_before
        self._carrying, self._over = carrying, over
