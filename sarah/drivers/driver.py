"""The driver: what stands between the controller and a robot, simulated or not."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import NamedTuple

from sarah.errors import ConfigurationError, shortened
from sarah.number import is_number, plain
from sarah.robot.reading import STANDING, SensorReading, Targets


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

    limits: Sequence[tuple[float, float]]
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
        """Let go of the robot, whose loop has ended, unless nothing was sent to it; here nothing happens."""

    def close(self) -> None:  # noqa: B027  # nor here
        """Give resources back; here there are none."""

    def now(self) -> float:
        """Time of the clock by which readings are taken, in s."""
        return time.monotonic()


def check_first(given: object, now: float, dt: float) -> None:
    """Refuse a driver whose first reading is none.

    :param given: what its ``read`` returned
    :param now: time of its clock, in s
    :param dt: control period, in s
    :raises ConfigurationError: naming what is wrong
    """
    if not isinstance(given, TimedReading) or not isinstance(given.reading, SensorReading):
        raise ConfigurationError(
            f"read must return TimedReading(SensorReading(…), taken) or None, not {shortened(given)}"
        )
    for name, standing in zip(SensorReading._fields, STANDING, strict=True):
        signal = plain(getattr(given.reading, name))
        if not isinstance(signal, (list, tuple)) or len(signal) != len(standing) or not all(map(is_number, signal)):
            raise ConfigurationError(f"{name} of a reading must be {len(standing)} numbers, not {shortened(signal)}")
    if not is_number(given.taken) or not given.taken <= now + dt:
        raise ConfigurationError(
            f"the time at which a reading was taken must be one of the driver's clock, now(), which says {now:.3f} s, "
            f"not {shortened(given.taken)}"
        )
