"""The kinds of ground that the robot stands on, and one episode's draw of them."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass
from typing import Annotated

from sarah.errors import ConfigurationError
from sarah.ranges import Range, Within, check_ranges
from sarah.robot.reading import GRAVITY, Vector
from sarah.robot.scale import Sized
from sarah.scenery.ground import LEVEL_GRAVITY, Ground

LARGEST_ROUGHNESS = 0.05
"""Largest height of bumps, in m."""
LARGEST_REACH = 10.0
"""Largest distance from the start up to which rough ground reaches, in m."""
MOST_CELLS = 50.0
"""Largest number of cells from the start to where rough ground ends: an episode begins with making them."""


@dataclass(frozen=True)
class Terrain:
    """The ground, drawn for each episode from its seed. One number for a range fixes the value.

    The world's frame is the ground's: z is the normal of its mean plane, and the robot begins standing along it. A
    slope tilts gravity instead, which is the same physics as an endless plane. So heights, the box around the start and
    a push are along the ground, while the accelerometer reads gravity as it is, and a fall is a tilt from gravity's
    vertical.

    :param slope_degrees: uniform range of the slope, in degrees; 0 is level ground
    :param direction_degrees: uniform range of the direction that leads uphill, in degrees: 0 to the robot's right, 90
        forward
    :param roughness: uniform range of the largest bumps' height over and under the mean plane, in m; 0 is even ground
    :param cell: uniform range of the distance between neighbouring bumps, in m
    :param reach: distance from the start, to each side, at which rough ground ends, in m, to within half a cell; up to
        50 cells
    :param friction_left: uniform range of the friction coefficient under the left foot; by default that of the
        randomisation
    :param friction_right: uniform range of the friction coefficient under the right foot; by default that of the
        randomisation
    """

    slope_degrees: Annotated[Range, Within(0.0, 45.0, "degrees")] = Range((0.0, 0.0))
    direction_degrees: Annotated[Range, Within(0.0, 720.0, "degrees")] = Range((0.0, 360.0))
    roughness: Annotated[Range, Sized(0.0, LARGEST_ROUGHNESS, "m")] = Range((0.0, 0.0))
    cell: Annotated[Range, Sized(0.002, 1.0, "m")] = Range((0.05, 0.05))
    friction_left: Annotated[tuple[float, float], Within(0.0, 5.0)] | None = None
    friction_right: Annotated[tuple[float, float], Within(0.0, 5.0)] | None = None
    reach: Annotated[float, Sized(0.05, LARGEST_REACH, "m")] = 0.7

    def __post_init__(self) -> None:
        """Refuse ground that nobody stands on."""
        check_ranges("terrain.", self)
        nearest, farthest = self.cell[1], MOST_CELLS * self.cell[0]
        if not nearest <= self.reach <= farthest:
            raise ConfigurationError(
                f"terrain.reach must be between 1 and {MOST_CELLS:g} times terrain.cell, here {nearest:g} and "
                f"{farthest:g} m, not {self.reach:g}"
            )


def draw_terrain(ranges: Terrain, seed: int) -> Terrain:
    """Draw one episode's settings of the ground, independently of its conditions and its push.

    Slope, bumps and friction have a generator each, so that a change of one leaves the others alone.

    :param ranges: ranges to draw from
    :param seed: seed of the episode; the same seed draws the same direction on any slope
    :return: settings whose ranges are single values, from which the same seed draws the same ground
    """
    slope, bumps = random.Random(f"terrain {seed}"), random.Random(f"roughness {seed}")
    texture = random.Random(f"texture {seed}")
    shares = {name: texture.random() for name in ("friction_left", "friction_right")}
    given = {name: friction for name in shares if (friction := getattr(ranges, name)) is not None}
    return Terrain(
        slope_degrees=_single(slope.uniform(*ranges.slope_degrees)),
        direction_degrees=_single(slope.uniform(*ranges.direction_degrees)),
        roughness=_single(bumps.uniform(*ranges.roughness)),
        cell=_single(bumps.uniform(*ranges.cell)),
        reach=ranges.reach,
        **{name: _single(low + shares[name] * (high - low)) for name, (low, high) in given.items()},
    )


def _single(value: float) -> tuple[float, float]:
    return (value, value)


def draw_ground(ranges: Terrain, seed: int) -> Ground:
    """Make one episode's ground, as :func:`draw_terrain` draws it.

    :param ranges: ranges to draw from
    :param seed: seed of the episode; the same seed draws the same bumps at any height
    """
    drawn = draw_terrain(ranges, seed)
    frictions = [friction and friction[0] for friction in (drawn.friction_left, drawn.friction_right)]
    (roughness, _), (cell, _) = drawn.roughness, drawn.cell
    if roughness == 0.0:
        return Ground(_gravity_on(drawn), (frictions[0], frictions[1]))
    count = 2 * round(drawn.reach / cell) + 1
    nodes = random.Random(f"bumps {seed}")
    heights = tuple(tuple(roughness * nodes.uniform(-1.0, 1.0) for _ in range(count)) for _ in range(count))
    return Ground(_gravity_on(drawn), (frictions[0], frictions[1]), heights, cell)


def _gravity_on(drawn: Terrain) -> Vector:
    slope = math.radians(drawn.slope_degrees[0])
    if slope == 0.0:
        return LEVEL_GRAVITY
    uphill = math.radians(drawn.direction_degrees[0])
    downhill = -GRAVITY * math.sin(slope)
    return (downhill * math.cos(uphill), downhill * math.sin(uphill), -GRAVITY * math.cos(slope))
