"""The ground that the robot stands on, and one episode's draw of it."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass

from sarah.errors import check_fields, to_ranges
from sarah.robot.reading import Vector
from sarah.simulation.simulator import GRAVITY, LEVEL_GRAVITY

PLAUSIBLE = {"slope_degrees": (0.0, 45.0, "degrees"), "direction_degrees": (0.0, 720.0, "degrees")}
"""Lowest value, highest value and unit of each setting. On more than 45 degrees the robot has fallen at once."""


@dataclass(frozen=True)
class Terrain:
    """The ground, drawn for each episode from its seed: a plane without end. One number for a range fixes the value.

    The world's frame is the ground's: z is the plane's normal, and the robot begins standing along it. A slope tilts
    gravity instead, which is the same physics. So heights, the box around the start and a push are along the ground,
    while the accelerometer reads gravity as it is, and a fall is a tilt from gravity's vertical.

    :param slope_degrees: uniform range of the slope, in degrees; 0 is level ground
    :param direction_degrees: uniform range of the direction that leads uphill, in degrees: 0 to the robot's right, 90
        forward
    """

    slope_degrees: tuple[float, float] = (0.0, 0.0)
    direction_degrees: tuple[float, float] = (0.0, 360.0)

    def __post_init__(self) -> None:
        """Refuse slopes that nobody stands on."""
        to_ranges(self, "slope_degrees", "direction_degrees")
        check_fields("terrain", self, PLAUSIBLE)


def draw_gravity(ranges: Terrain, seed: int) -> Vector:
    """Draw one episode's slope, independently of its conditions and its push.

    :param ranges: ranges to draw from
    :param seed: seed of the episode; the same seed draws the same direction on any slope
    :return: gravity in the ground's frame, in m/s^2
    """
    generator = random.Random(f"terrain {seed}")
    slope = math.radians(generator.uniform(*ranges.slope_degrees))
    if slope == 0.0:
        return LEVEL_GRAVITY
    uphill = math.radians(generator.uniform(*ranges.direction_degrees))
    downhill = -GRAVITY * math.sin(slope)
    return (downhill * math.cos(uphill), downhill * math.sin(uphill), -GRAVITY * math.cos(slope))
