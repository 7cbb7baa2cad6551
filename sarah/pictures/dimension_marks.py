"""Where in a drawing of the robot each of its dimensions is shown."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Literal, NamedTuple

import numpy as np

Side = Literal["left", "right"]
Beside = Literal["", "left", "right", "top", "bottom"]
Point = tuple[float, float, float]
CENTRE_OF_MASS = "centre of mass"
ARC_RADIUS = 0.3
"""Radius of the arcs about a hip, as a share of the leg's length."""
ARC_POINTS = 40
LARGEST_ANGLE = 3.0
"""Largest angle of an arc, in rad; a larger limit is drawn as this one."""


class Mark(NamedTuple):
    """A dimension in a drawing: a dot, an arrow, or an arc.

    :param name: name of the dimension
    :param side: side of the drawing on which its name stands
    :param points: points in the world's frame, in m: one of a dot, two of an arrow, more of an arc; shape (n, 3)
    :param beside: side of the robot on which an arrow is drawn; empty for one that is drawn on the robot
    :param lane: number of the lane beside the robot, counted from it
    :param has_two_heads: whether an arrow points to both of its ends, and not to the last only
    :param centre: centre of an arc, shape (1, 3); no point for others
    """

    name: str
    side: Side
    points: np.ndarray
    beside: Beside = ""
    lane: int = 1
    has_two_heads: bool = True
    centre: np.ndarray = np.empty((0, 3))


def marks(dimensions: Mapping[str, float], centre_of_mass: np.ndarray) -> dict[str, list[Mark]]:
    """Marks of all dimensions and of the centre of mass, by the drawing that they are in.

    :param dimensions: values of all dimensions, in SI units
    :param centre_of_mass: centre of mass of the standing robot, in m, of shape (3,)
    """
    return {
        "front": _front(dimensions),
        "side": [*_side(dimensions), Mark(CENTRE_OF_MASS, "right", centre_of_mass[None])],
        "foot side": _foot_side(dimensions),
        "foot front": _foot_front(dimensions),
    }


def _front(d: Mapping[str, float]) -> list[Mark]:
    hip, knee, ankle = _heights(d)
    torso, left, right = hip + d["hip_drop"], -d["hip_offset"], d["hip_offset"]
    half, top = d["torso_width"] / 2, torso + d["torso_height"] / 2
    return [
        _beside("torso_width", "right", "top", (half, 0, top), (-half, 0, top)),
        _beside("hip_drop", "left", "left", (0, 0, torso), (right, 0, hip)),
        _beside("thigh_length", "left", "left", (right, 0, hip), (right, 0, knee)),
        _beside("shank_length", "left", "left", (right, 0, knee), (right, 0, ankle)),
        _beside("hip_offset", "left", "bottom", (0, 0, torso), (left, 0, hip)),
        _dot("torso_mass", "right", (-0.6 * half, 0, torso + 0.3 * d["torso_height"])),
        _dot("hip_mass", "right", (left, 0, hip)),
        _arc("abduction_limit", (left, 0, hip), ARC_RADIUS * (hip - ankle), d["abduction_limit"], across=0),
        _dot("thigh_mass", "right", (left, 0, hip - 0.75 * d["thigh_length"])),
        _dot("shank_mass", "right", (left, 0, knee - 0.5 * d["shank_length"])),
    ]


def _side(d: Mapping[str, float]) -> list[Mark]:
    hip, knee, ankle = _heights(d)
    x, torso, depth, thigh = d["hip_offset"], hip + d["hip_drop"], d["torso_depth"] / 2, d["thigh_width"] / 2
    low, top = torso - d["torso_height"] / 2, torso + d["torso_height"] / 2
    end, retracted, extended = (
        (x, -thigh, knee + change) for change in (0.0, d["leg_retract_limit"], -d["leg_extend_limit"])
    )
    return [
        _beside("torso_depth", "right", "top", (0, -depth, top), (0, depth, top)),
        _beside("torso_height", "left", "left", (0, -depth, low), (0, -depth, top))._replace(lane=2),
        _dot("hip_effort", "left", (x, -d["hip_size"], hip)),
        _beside("leg_retract_limit", "left", "left", end, retracted)._replace(has_two_heads=False),
        _beside("leg_extend_limit", "left", "left", end, extended)._replace(has_two_heads=False),
        _across("hip_size", d["hip_size"], hip),
        _arc("flexion_limit", (x, 0, hip), ARC_RADIUS * (hip - ankle), d["flexion_limit"], across=1),
        _dot("leg_effort", "right", (x, 1.44 * thigh, hip - 0.6 * d["thigh_length"])),
        _across("thigh_width", d["thigh_width"], hip - 0.8 * d["thigh_length"]),
        _across("shank_width", d["shank_width"], knee - 0.3 * d["shank_length"]),
    ]


def _foot_side(d: Mapping[str, float]) -> list[Mark]:
    fore, hind, ankle = d["forefoot_contact"], d["hindfoot_contact"], d["hinge_height"]
    hinge, plate, forward = (0.0, 0.0, ankle), ankle - d["plate_thickness"], math.pi / 2
    return [
        _beside("hindfoot_contact", "left", "bottom", hinge, (0, -hind, d["contact_radius"])),
        _beside("forefoot_contact", "right", "bottom", hinge, (0, fore, d["contact_radius"])),
        _beside("hinge_height", "left", "left", (0, 0, 0), hinge),
        _dot("ankle_damping", "left", hinge),
        _dot("hindfoot_mass", "left", (0, -0.7 * hind, plate)),
        _dot("forefoot_mass", "right", (0, 0.7 * fore, plate)),
        _arc("ankle_up_limit", hinge, fore, d["ankle_up_limit"], across=1, zero=forward),
        _arc("ankle_down_limit", hinge, fore, -d["ankle_down_limit"], across=1, zero=forward),
    ]


def _foot_front(d: Mapping[str, float]) -> list[Mark]:
    x, radius, thickness, ankle = d["hip_offset"], d["contact_radius"], d["plate_thickness"], d["hinge_height"]
    contact = x - d["sole_half_width"]
    edge, middle = contact - radius, ankle - thickness
    return [
        _beside("sole_half_width", "right", "bottom", (x, 0, ankle), (contact, 0, radius)),
        _beside(
            "plate_thickness", "right", "right", (edge, 0, middle - thickness / 2), (edge, 0, middle + thickness / 2)
        ),
        Mark("contact_radius", "right", np.array(((contact, 0, radius), (edge, 0, radius))), has_two_heads=False),
    ]


def _heights(d: Mapping[str, float]) -> tuple[float, float, float]:
    """Heights of hip, upper end of the shank, and ankle over the floor."""
    knee = d["hinge_height"] + d["shank_length"]
    return knee + d["thigh_length"], knee, d["hinge_height"]


def _dot(name: str, side: Side, point: Point) -> Mark:
    return Mark(name, side, np.array([point]))


def _beside(name: str, side: Side, beside: Beside, first: Point, last: Point) -> Mark:
    return Mark(name, side, np.array((first, last), float), beside)


def _across(name: str, width: float, height: float) -> Mark:
    """Arrow across a leg, from its back to its front."""
    return Mark(name, "right", np.array(((0.0, -width / 2, height), (0.0, width / 2, height))))


def _arc(name: str, centre: Point, radius: float, angle: float, across: int, zero: float = 0.0) -> Mark:
    """Arc to an angle from zero, or to it and its negative if zero is straight down.

    :param across: axis that the arc's plane has besides z
    :param zero: angle of zero from straight down, in rad
    """
    largest = float(np.clip(angle, -LARGEST_ANGLE, LARGEST_ANGLE))
    angles = zero + np.linspace(0.0 if zero else -largest, largest, ARC_POINTS)
    points = np.tile(np.array(centre, float), (ARC_POINTS, 1))
    points[:, across] += radius * np.sin(angles)
    points[:, 2] -= radius * np.cos(angles)
    return Mark(name, "right", points, has_two_heads=not zero, centre=np.array([centre], float))
