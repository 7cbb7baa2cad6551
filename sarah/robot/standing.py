"""The standing robot, all joints at zero: its links, their masses, centres of mass and inertias."""

from __future__ import annotations

import io
import math
from collections.abc import Iterable
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from sarah.robot.description import RobotDescription


class MassProperties(NamedTuple):
    """Mass of a body, and how it is distributed.

    :param mass: mass, in kg
    :param centre: centre of mass, in m: x to the robot's right and y forward from the torso's centre, z up from the
        floor; shape (3,)
    :param inertia: inertia about the centre of mass, about these axes, in kg m^2; shape (3, 3)
    """

    mass: float
    centre: np.ndarray
    inertia: np.ndarray


@lru_cache(maxsize=4)
def model_of(urdf: str) -> Any:
    """Robot as yourdfpy reads it, which must not be changed.

    :param urdf: text of the robot's URDF
    """
    import yourdfpy

    return yourdfpy.URDF.load(io.StringIO(urdf), load_meshes=False)


def links_of(robot: RobotDescription) -> dict[str, MassProperties]:
    """Mass properties of each link of a standing robot, by the link's name.

    :param robot: robot
    """
    model = model_of(robot.urdf)
    links = {}
    for name, link in model.link_map.items():
        inertial, to_torso = link.inertial, model.get_transform(name, "torso")
        place = to_torso if inertial.origin is None else to_torso @ inertial.origin
        centre = place[:3, 3] + (0.0, 0.0, robot.standing_height)
        links[name] = MassProperties(
            float(inertial.mass), centre, place[:3, :3] @ np.array(inertial.inertia, float) @ place[:3, :3].T
        )
    return links


def together(bodies: Iterable[MassProperties]) -> MassProperties:
    """Mass properties of bodies that do not move against each other.

    :param bodies: mass properties of each, at least one
    """
    every = list(bodies)
    mass = math.fsum(body.mass for body in every)
    centre = np.sum([body.mass * body.centre for body in every], axis=0) / mass
    inertia = np.zeros((3, 3))
    for body in every:
        away = body.centre - centre
        inertia += body.inertia + body.mass * (away @ away * np.eye(3) - np.outer(away, away))  # parallel axes
    return MassProperties(mass, centre, inertia)
