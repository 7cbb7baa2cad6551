"""Whether a reading is a new one. A controller that reads the same again, or nothing, does not hear the robot."""

from __future__ import annotations

import math

from sarah.control.watches import NOTHING
from sarah.robot.reading import GRAVITY, SensorReading

UNHEARD = NOTHING._replace(acceleration=(math.nan, math.nan, GRAVITY))
"""What the controller is given without a new reading: a stuck vertical acceleration could look like a fall."""


class Hearing:
    """What comes of a robot's readings. Call :meth:`hear` once per control tick.

    :param stale_seconds: age from which a reading counts as missing, and time without a new one after which the robot
        is not heard any more, in s
    """

    def __init__(self, stale_seconds: float) -> None:
        self.unheard_seconds = math.inf
        """Time since the last new reading, in s."""
        self._stale_seconds = stale_seconds
        self._before: tuple[float, ...] = ()

    def hear(self, reading: SensorReading | None, age: float, seconds: float) -> tuple[SensorReading, SensorReading]:
        """Take the reading of a tick.

        :param reading: newest sensor reading; ``None`` if there is none
        :param age: age of the reading, in s
        :param seconds: time since the last tick, in s
        :return: the reading, in which what is missing is NaN, and what the controller is given
        """
        if reading is None or not age <= self._stale_seconds:
            reading = NOTHING
        is_new = self._is_new(reading)
        self.unheard_seconds = 0.0 if is_new else self.unheard_seconds + seconds
        return reading, reading if is_new else UNHEARD

    @property
    def is_stale(self) -> bool:
        """Whether there has been no new reading for too long."""
        return self.unheard_seconds > self._stale_seconds

    def _is_new(self, reading: SensorReading) -> bool:
        """Whether an inertial signal is another one than before; noise never repeats."""
        signals, before = (*reading.acceleration, *reading.angular_rate), self._before
        self._before = signals
        return signals != before and (signals[2] == signals[2] or signals[4] == signals[4])  # not all NaN
