"""Froude scaling: what goes with the length and the mass of a robot.

Gravity is the same for all robots. So two that are alike move alike if all lengths go by one factor, all masses by
another, and all times by the square root of that of the lengths (Alexander and Jayes 1983, J. Zool. 201, 135). Angles
and accelerations stay; the factor of any other quantity follows from its unit. A robot that is not like the default one
has the factor of its height.

Rocking also depends on how wide a robot stands. To come from the middle over a foot, the centre of mass has to rise by
width^2 / (2 height). The leg that extends in SHIFT lifts it by half of its extension, which therefore goes by
width^2 / height.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, is_dataclass, replace
from typing import NamedTuple, TypeVar

from sarah.ranges import Within, ranges_of

HEIGHT = 0.84
"""Height of the default robot's torso over the floor, in m."""
MASS = 30.0
"""Mass of the default robot, in kg; it is the paper's."""
HIP_OFFSET = 0.13
"""Lateral distance of the default robot's hips from its middle, in m."""
DIGITS = 12
"""Decimals of the ratios, so that the same robot has the same ones however they are computed."""
POWERS = {
    "": (0.0, 0.0),
    "rad": (0.0, 0.0),
    "m/s^2": (0.0, 0.0),
    "m": (1.0, 0.0),
    "s": (0.5, 0.0),
    "m/s": (0.5, 0.0),
    "rad/s": (-0.5, 0.0),
    "1/s": (-0.5, 0.0),
    "per second": (-0.5, 0.0),
    "kg": (0.0, 1.0),
    "N": (0.0, 1.0),
    "N per root Hz": (0.0, 1.0),  # the sensor's bandwidth stays
    "Nm": (1.0, 1.0),
    "kg m^2": (2.0, 1.0),
    "Ns/m": (-0.5, 1.0),
    "Nms/rad": (1.5, 1.0),
}
"""Powers of the ratios of lengths and of masses by which a quantity goes, by its unit."""
ROCKING = "m of rocking"
"""Unit of a length that goes by width^2 / height."""

Settings = TypeVar("Settings")


@dataclass(frozen=True)
class Sized(Within):
    """Range of a setting that goes with the robot's size.

    :param goes_by: unit whose factor the setting goes by, if it is not that of its limits
    :param usual: value of the default robot, from which that of any robot follows where none is given
    """

    goes_by: str = ""
    usual: float | None = None


class Scale(NamedTuple):
    """Size of a robot as ratios to that of the default robot.

    :param length: ratio of the heights of the torso over the floor
    :param mass: ratio of the masses
    :param width: ratio of the hips' lateral distances from the middle
    """

    length: float = 1.0
    mass: float = 1.0
    width: float = 1.0

    @classmethod
    def of(cls, height: float, mass: float, hip_offset: float) -> Scale:
        """Scale of a robot.

        :param height: height of the standing torso's centre over the floor, in m
        :param mass: mass of the robot, in kg
        :param hip_offset: lateral distance of its hips from its middle, in m
        """
        ratios = height / HEIGHT, mass / MASS, hip_offset / HIP_OFFSET
        return cls(*[round(ratio, DIGITS) for ratio in ratios])

    def over(self, other: Scale) -> Scale:
        """Ratios to another robot's size.

        :param other: scale of the other robot
        """
        return Scale(self.length / other.length, self.mass / other.mass, self.width / other.width)

    def words(self) -> str:
        """Ratios in words."""
        return f"length ({self.length:.3g} times the default), mass ({self.mass:.3g}) and hip offset ({self.width:.3g})"

    @property
    def time(self) -> float:
        """Ratio of times: the square root of that of lengths."""
        return math.sqrt(self.length)

    def factor(self, unit: str) -> float:
        """Factor on a quantity.

        :param unit: unit of the quantity, one of :data:`POWERS`, or :data:`ROCKING`
        """
        if unit == ROCKING:
            return self.width**2 / self.length
        length_power, mass_power = POWERS[unit]
        return float(self.length**length_power * self.mass**mass_power)

    def all_scaled(self, quantities: Sequence[tuple[float, str]]) -> tuple[float, ...]:
        """Quantities of a robot of this scale.

        :param quantities: value of the default robot and unit of each
        """
        return tuple(value * self.factor(unit) for value, unit in quantities)

    def scaled(self, settings: Settings) -> Settings:
        """Settings of a robot of this scale that is like the one they are for.

        :param settings: settings, a dataclass: fields with a range of :class:`Sized` go with the scale, also those of
            settings within them
        """
        if self == Scale():
            return settings
        values, ranges = {}, ranges_of(type(settings))
        for name, value in vars(settings).items():
            if isinstance(within := ranges.get(name), Sized):
                factor = self.factor(within.goes_by or within.unit)
                values[name] = tuple(end * factor for end in value) if isinstance(value, tuple) else value * factor
            elif is_dataclass(value):
                values[name] = self.scaled(value)
        return replace(settings, **values)  # type: ignore[type-var]  # a dataclass
