"""The driver: what stands between the controller and a robot, simulated or not."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import NamedTuple

from sarah.control.hip_law import NO_LIMITS
from sarah.robot.reading import SensorReading, Targets


class TimedReading(NamedTuple):
    """A sensor reading and when it was taken.

    :param reading: sensor reading
    :param taken: time at which it was taken, by the clock of :meth:`Driver.now`, in s
    """

    reading: SensorReading
    taken: float


class Driver(ABC):
    """A robot. :meth:`read` and :meth:`send` are all that a robot needs; the rest is for those that have more.

    Neither may block for longer than a control period: the control loop calls both in each tick.
    """

    limits: Sequence[tuple[float, float]] = NO_LIMITS
    """Lowest and highest position of the joints in the order of ``ACTUATED_JOINTS``, in rad and m."""
    ended: str = ""
    """Reason for which the robot takes no more targets, such as its emergency stop; empty while it does."""

    @abstractmethod
    def read(self) -> TimedReading | None:
        """Newest sensor reading, also if it is the same as before; ``None`` if there has been none yet."""

    @abstractmethod
    def send(self, targets: Targets) -> None:
        """Give the servos new targets.

        :param targets: joint targets in the order of ``ACTUATED_JOINTS``, in rad and m
        """

    def off(self) -> None:  # noqa: B027  # most robots have nothing to do here
        """Let go of the robot, whose loop has ended; here nothing happens."""

    def now(self) -> float:
        """Time of the clock by which readings are taken, in s."""
        return time.monotonic()
