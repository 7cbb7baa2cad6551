"""One episode's ground: the one surface that both engines, pictures and clearances are made from."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product

from sarah.errors import ConfigurationError
from sarah.robot.description import RobotDescription
from sarah.robot.reading import GRAVITY, Side, Vector

LEVEL_GRAVITY = (0.0, 0.0, -GRAVITY)
"""Acceleration of gravity on level ground, in the world's frame, in m/s^2."""
BALL_SAMPLES = 8
"""Number of samples of the surface from under a ball's centre to its edge."""


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

    def ball_height(self, x: float, y: float, radius: float) -> float:
        """Height of the centre of a ball that lies on the surface and can only move up and down, in m.

        The surface is sampled under the ball, at the nodes and between. For soles that is exact to 0.4 mm, and on the
        steepest bumps to 2 mm.

        :param x: place to the right, in m
        :param y: place forward, in m
        :param radius: radius of the ball, in m
        """
        steps = [radius * step / BALL_SAMPLES for step in range(-BALL_SAMPLES, BALL_SAMPLES + 1)]
        columns, rows = self._nodes_within(x, radius), self._nodes_within(y, radius)
        return max(
            self.height(x + right, y + forward) + math.sqrt(under)
            for right, forward in (*product(steps, steps), *product(columns, rows))
            if (under := radius * radius - right * right - forward * forward) >= 0.0
        )

    def highest(self, left: float, right: float, back: float, front: float) -> float:
        """Height of the highest place in a rectangle, in m.

        The surface is made of triangles. So the place is a node, a corner, or where the edges of the rectangle and of a
        triangle cross.

        :param left: smallest x, in m
        :param right: largest x, in m
        :param back: smallest y, in m
        :param front: largest y, in m
        """
        columns = [left, right, *self._multiples_within(left, right)]
        rows = [back, front, *self._multiples_within(back, front)]
        places = [
            *product(columns, rows),
            *((across - y, y) for y in (back, front) for across in self._multiples_within(left + y, right + y)),
            *((x, across - x) for x in (left, right) for across in self._multiples_within(back + x, front + x)),
        ]  # the diagonals of the cells are where x + y is a multiple of the cell
        return max(self.height(x, y) for x, y in places)

    def lift(self, robot: RobotDescription) -> float:
        """How much higher than on a plane a standing robot begins, so that it touches the ground and is not inside it.

        :param robot: checked robot
        :return: height, in m; 0 on a plane
        :raises ConfigurationError: if the robot stands beside the bumps, as wide as it is
        """
        if not self.heights:
            return 0.0
        farthest = max(abs(end) for *rectangle, _ in robot.undersides for end in rectangle)
        if farthest >= self.reach:
            raise ConfigurationError(
                f"bumps reach {self.reach:.2f} m from the start, and this robot's feet {farthest:.2f} m: "
                "stand them nearer to each other"
            )
        soles = max(self.ball_height(x, y, robot.contact_radius) - z for x, y, z in robot.standing_soles)
        return max(soles, *(self.highest(*rectangle) - height for *rectangle, height in robot.undersides))

    def _nodes_within(self, place: float, radius: float) -> list[float]:
        """Distances along an axis from a place to the nodes that are not farther away than a radius."""
        return [node - place for node in self._multiples_within(place - radius, place + radius)]

    def _multiples_within(self, low: float, high: float) -> list[float]:
        """Multiples of the cell from one number to another."""
        return [index * self.cell for index in range(math.ceil(low / self.cell), math.floor(high / self.cell) + 1)]

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
