"""What the robot senses in one control tick, and the names of its two sides."""

from __future__ import annotations

import math
from enum import Enum
from typing import NamedTuple

Vector = tuple[float, float, float]
LARGEST_SIGNAL = 1e6
"""Largest signal of a sensor, in any SI unit: what is beyond comes from a simulation that diverges."""


class Side(Enum):
    """A leg; the value is its sign along the torso's x axis."""

    LEFT = -1
    RIGHT = 1

    __hash__ = object.__hash__  # Enum's own is slow, and every tick looks legs up

    def __str__(self) -> str:
        """Name that links and joints of this side begin with."""
        return self.name.lower()

    @property
    def other(self) -> Side:
        """The opposite leg."""
        return Side.LEFT if self is Side.RIGHT else Side.RIGHT


class SensorReading(NamedTuple):
    """One control tick's 16 signals.

    :param acceleration: specific force in the torso's frame (x right, y forward, z up), in m/s^2; (0, 0, 9.81) at rest
    :param angular_rate: of the torso in its own frame, in rad/s
    :param pressures: load on the four ankle pads in N: left forefoot, left hindfoot, right forefoot, right hindfoot
        (the paper's LFP, LBP, RFP, RBP)
    :param joints: actuator positions in the order of :data:`sarah.robot.description.ACTUATED_JOINTS`: left and right
        abduction and flexion in rad, left and right leg length in m, positive = retracted
    """

    acceleration: Vector
    angular_rate: Vector
    pressures: tuple[float, float, float, float]
    joints: tuple[float, float, float, float, float, float]

    @property
    def is_finite(self) -> bool:
        """Whether all signals are numbers that a sensor can return."""
        acceleration, angular_rate, pressures, joints = self
        return math.hypot(*acceleration, *angular_rate, *pressures, *joints) < LARGEST_SIGNAL
