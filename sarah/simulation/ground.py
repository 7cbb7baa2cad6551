"""One episode's ground: the one surface that both engines, pictures and clearances are made from."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sarah.robot.reading import Side, Vector
from sarah.simulation.simulator import LEVEL_GRAVITY


@dataclass(frozen=True)
class Ground:
    """The ground of an episode, in the world's frame: the plane z = 0, or bumps above and below it.

    Between four nodes lie two triangles, which share the edge from the node on the right to the one in front.

    :param gravity: acceleration of gravity, which a slope tilts, in m/s^2
    :param frictions: Coulomb friction coefficients under the left and the right foot; ``None`` for the episode's own
    :param heights: heights of the nodes, in m: rows from back to front, each from left to right, as many as rows and an
        odd number, around the world's origin; empty for a plane
    :param cell: distance between neighbouring nodes, in m
    """

    gravity: Vector = LEVEL_GRAVITY
    frictions: tuple[float | None, float | None] = (None, None)
    heights: tuple[tuple[float, ...], ...] = ()
    cell: float = 0.05

    @property
    def is_rough(self) -> bool:
        """Whether it has bumps."""
        return bool(self.heights)

    @property
    def reach(self) -> float:
        """Distance from the origin, along x and y, up to which there is ground, in m; a plane has no end."""
        return self.cell * (len(self.heights) - 1) / 2 if self.heights else math.inf

    def friction(self, side: Side) -> float | None:
        """Friction coefficient under a foot; ``None`` for the episode's own.

        :param side: side of the foot
        """
        return self.frictions[tuple(Side).index(side)]

    def height(self, x: float, y: float) -> float:
        """Height of the surface, in m; 0 beyond the reach.

        :param x: place to the right, in m
        :param y: place forward, in m
        """
        return self._triangle(x, y)[0]

    def distance(self, position: Vector) -> float:
        """Distance of a point from the triangle under it, along the triangle's normal, in m; negative below.

        :param position: the point, in m
        """
        x, y, z = position
        height, slope_x, slope_y = self._triangle(x, y)
        return (z - height) / math.sqrt(1.0 + slope_x * slope_x + slope_y * slope_y)

    def _triangle(self, x: float, y: float) -> tuple[float, float, float]:
        """Height at a place, and the slopes along x and y of the triangle there."""
        cell, heights = self.cell, self.heights
        if not heights:
            return 0.0, 0.0, 0.0
        middle = (len(heights) - 1) / 2
        column, row = x / cell + middle, y / cell + middle
        i, j = math.floor(column), math.floor(row)
        if not (0 <= i < len(heights) - 1 and 0 <= j < len(heights) - 1):
            return 0.0, 0.0, 0.0
        right, forward = column - i, row - j
        behind, ahead = heights[j], heights[j + 1]
        if right + forward <= 1.0:
            rise_x, rise_y = behind[i + 1] - behind[i], ahead[i] - behind[i]
            height = behind[i] + right * rise_x + forward * rise_y
        else:
            rise_x, rise_y = ahead[i + 1] - ahead[i], ahead[i + 1] - behind[i + 1]
            height = ahead[i + 1] - (1.0 - right) * rise_x - (1.0 - forward) * rise_y
        return height, rise_x / cell, rise_y / cell


LEVEL = Ground()
"""Level ground without bumps."""
