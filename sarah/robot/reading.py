"""Sensor readings of one control tick, and the two sides of the robot."""

from __future__ import annotations

import itertools
import math
from enum import Enum
from typing import Any, NamedTuple

Vector = tuple[float, float, float]
Targets = tuple[float, float, float, float, float, float]
"""Targets of the actuated joints in the order of :data:`ACTUATED_JOINTS`, in rad and m."""
GRAVITY = 9.81
"""Acceleration of gravity, in m/s^2."""
LARGEST_SIGNAL = 1e6
"""Largest signal of a sensor, in any SI unit: a larger one means that the simulation diverges."""


class Side(Enum):
    """Side of a leg; the value is its sign along the torso's x axis."""

    LEFT = -1
    RIGHT = 1

    __hash__ = object.__hash__  # Enum's own is slow, and every tick looks legs up

    def __str__(self) -> str:
        """Name of the side, with which the names of its links and joints begin."""
        return self.name.lower()

    @property
    def other(self) -> Side:
        """Opposite side."""
        return Side.LEFT if self is Side.RIGHT else Side.RIGHT


ACTUATED_JOINTS = tuple(f"{side}_{joint}" for joint in ("hip_abduction", "hip_flexion", "leg_length") for side in Side)
"""The six actuators, in the order of every list of joint values: left before right."""


class SensorReading(NamedTuple):
    """The 16 sensor signals of one control tick.

    :param acceleration: specific force in the torso's frame (x right, y forward, z up), in m/s^2; (0, 0, 9.81) at rest
    :param angular_rate: angular rate of the torso in its own frame, in rad/s
    :param pressures: loads on the four ankle pads, in N: left forefoot, left hindfoot, right forefoot, right hindfoot
        (the paper's LFP, LBP, RFP, RBP)
    :param joints: actuator positions in the order of :data:`ACTUATED_JOINTS`: left and right
        abduction and flexion in rad, left and right leg length in m, positive = retracted
    """

    acceleration: Vector
    angular_rate: Vector
    pressures: tuple[float, float, float, float]
    joints: tuple[float, float, float, float, float, float]

    @property
    def is_finite(self) -> bool:
        """Whether all signals are finite numbers that a sensor can return."""
        acceleration, angular_rate, pressures, joints = self
        try:
            return math.hypot(*acceleration, *angular_rate, *pressures, *joints) < LARGEST_SIGNAL
        except OverflowError:  # a whole number beyond all floats
            return False

    def repaired(self, before: SensorReading) -> SensorReading:
        """Replace each signal that no sensor can return by that of an earlier reading, and make floats of all.

        :param before: earlier reading, of finite signals
        """
        held: Any = self
        if self.is_finite:
            if set(map(type, itertools.chain(*self))) == {float}:  # as nearly always
                return self
        else:
            held = (
                [value if abs(value) < LARGEST_SIGNAL else last for value, last in zip(values, old, strict=True)]
                for values, old in zip(self, before, strict=True)
            )
        return SensorReading(*[tuple(map(float, values)) for values in held])  # type: ignore[arg-type]  # as long


STANDING = SensorReading((0.0, 0.0, GRAVITY), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
"""Reading of an upright robot whose feet carry nothing: what is known before the first one."""
