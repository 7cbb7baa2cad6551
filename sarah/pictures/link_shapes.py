"""The shapes of the robot's links, where they are while it stands with all joints at zero."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from sarah.robot.description import RobotDescription, model_of


class Shape(NamedTuple):
    """A visual shape of a link.

    :param link: name of the link
    :param points: points of its surface, within whose convex hull it is, in the world's frame, in m; shape (n, 3)
    :param colour: red, green and blue, from 0 to 1; shape (3,)
    """

    link: str
    points: np.ndarray
    colour: np.ndarray


def shapes_of(robot: RobotDescription) -> Iterator[Shape]:
    """Visual shapes of all links.

    :param robot: robot, which stands
    """
    scene = model_of(robot.urdf).scene
    for node in scene.graph.nodes_geometry:
        place, name = scene.graph.get(node)
        mesh = scene.geometry[name]
        points = np.array(mesh.vertices) @ place[:3, :3].T + place[:3, 3] + (0.0, 0.0, robot.standing_height)
        yield Shape(scene.graph.transforms.parents[node], points, np.array(mesh.visual.main_color[:3]) / 255)
