"""The standing robot, all joints at zero: its links, their masses, centres of mass and inertias."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from sarah.robot.description import RobotDescription
from sarah.robot.links_and_joints import inertia_of, links_and_joints, numbers_of, place_of


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


def links_of(robot: RobotDescription) -> dict[str, MassProperties]:
    """Mass properties of each link of a standing robot, by the link's name.

    :param robot: robot
    """
    links, joints = links_and_joints(robot.urdf)
    found = {}
    for name, link in links.items():
        centre = place_of(name, joints) + numbers_of(link, "inertial/origin", "xyz", "0 0 0")
        centre += (0.0, 0.0, robot.standing_height)
        found[name] = MassProperties(robot.masses[name], centre, inertia_of(link))
    return found


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
