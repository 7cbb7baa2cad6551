"""The shapes of the robot's links, as points around each and as flat outlines."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import product
from typing import Any, NamedTuple

import numpy as np

CORNERS = np.array(list(product((-1.0, 1.0), repeat=3)))
"""Corners of a cube whose edges are 2 long."""
ROUND = np.array([(math.cos(angle), math.sin(angle)) for angle in np.linspace(0.0, 2 * math.pi, 48, endpoint=False)])
"""Points of a circle of radius 1."""


class Outline(NamedTuple):
    """What one sees of a shape from one direction.

    :param corners: corners of a convex outline in order, to the right and up, in m; shape (n, 2)
    :param nearness: distance of its nearest point towards the eye, from the origin, in m
    :param colour: red, green and blue, from 0 to 1
    """

    corners: np.ndarray
    nearness: float
    colour: tuple[float, float, float]


def points_around(shape: Any) -> np.ndarray:
    """Points of a shape's surface, within whose convex hull it is.

    :param shape: visual or collision shape of yourdfpy: a box, a cylinder or a sphere
    :return: points in the link's frame, in m; shape (n, 3)
    """
    geometry = shape.geometry
    if geometry.box is not None:
        points = CORNERS * np.array(geometry.box.size) / 2
    elif geometry.cylinder is not None:
        ends = (-geometry.cylinder.length / 2, geometry.cylinder.length / 2)
        points = np.array([(*(geometry.cylinder.radius * ring), end) for ring in ROUND for end in ends])
    else:
        rings = np.pad(geometry.sphere.radius * ROUND, ((0, 0), (0, 1)))
        points = np.concatenate([np.roll(rings, axis, axis=1) for axis in range(3)])
    place = np.eye(4) if shape.origin is None else shape.origin
    return np.asarray(points @ place[:3, :3].T + place[:3, 3])


def outlines(model: Any, links: Sequence[str], height: float, axes: np.ndarray) -> list[Outline]:
    """Outlines of the visual shapes of links, the farthest first.

    :param model: robot, as yourdfpy has read it, with all joints at zero
    :param links: names of the links; none stands for all
    :param height: height of the torso's centre over the floor, in m
    :param axes: unit vectors to the right, up and towards the eye, as rows
    """
    return sorted(_outlines(model, links, height, axes), key=lambda outline: outline.nearness)


def _outlines(model: Any, links: Sequence[str], height: float, axes: np.ndarray) -> Iterator[Outline]:
    from scipy.spatial import ConvexHull

    colours = {material.name: tuple(material.color.rgba[:3]) for material in model.robot.materials}
    for link in links or model.link_map:
        place = model.get_transform(link, "torso")
        for shape in model.link_map[link].visuals:
            points = points_around(shape) @ place[:3, :3].T + place[:3, 3] + (0.0, 0.0, height)
            seen = points @ axes.T
            flat = seen[:, :2]
            yield Outline(flat[ConvexHull(flat).vertices], float(seen[:, 2].max()), colours[shape.material.name])
