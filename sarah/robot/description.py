"""The robot: from the xacro to a checked URDF text.

PyBullet crashes on some malformed URDFs and silently accepts others. So every text is checked here before an engine
sees it: yourdfpy checks the syntax, and this module's own rules check that the robot is SARAH. Only a test shows the
default robot to yourdfpy, because importing yourdfpy takes longer than a short episode.
"""

from __future__ import annotations

import io
import math
import threading
import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from typing import Any, NamedTuple

import numpy as np

from sarah.errors import DescriptionError
from sarah.robot.dimensions import SCALED, XACRO, all_dimensions, check_dimensions, scale_of
from sarah.robot.links_and_joints import inertia_of, links_and_joints, numbers_of, place_of
from sarah.robot.reading import ACTUATED_JOINTS, Side
from sarah.robot.scale import Scale

PLATES = ("forefoot", "hindfoot")
ANKLE_JOINTS = tuple(f"{side}_{plate}" for side in Side for plate in PLATES)
"""The four ankle joints, each named like the plate it carries."""
JOINT_TYPES = {
    joint: "prismatic" if joint.endswith("leg_length") else "revolute" for joint in (*ACTUATED_JOINTS, *ANKLE_JOINTS)
}
JOINT_AXES = {
    **dict.fromkeys(("left_hip_abduction", "right_hip_abduction"), (0.0, 1.0, 0.0)),
    **dict.fromkeys(("left_hip_flexion", "right_hip_flexion"), (1.0, 0.0, 0.0)),
    **dict.fromkeys(("left_leg_length", "right_leg_length"), (0.0, 0.0, 1.0)),
    **dict.fromkeys(("left_forefoot", "right_forefoot"), (1.0, 0.0, 0.0)),
    **dict.fromkeys(("left_hindfoot", "right_hindfoot"), (-1.0, 0.0, 0.0)),
}
"""Axes in the torso's frame. Positive swings a leg left or forward, retracts it, or turns a plate onto its pad."""
GROUPS = {
    "top": ("torso", "left_hip", "right_hip"),
    "left leg": ("left_thigh", "left_shank", "left_forefoot", "left_hindfoot"),
    "right leg": ("right_thigh", "right_shank", "right_forefoot", "right_hindfoot"),
}
"""The three groups of links; each of the paper's robot weighs 10 kg."""

_xacro_lock = threading.Lock()  # xacro keeps its state in global variables


class Underside(NamedTuple):
    """Horizontal rectangle under a foot plate, in the world's frame, in m.

    :param left: smallest x
    :param right: largest x
    :param back: smallest y
    :param front: largest y
    :param height: height over the floor
    """

    left: float
    right: float
    back: float
    front: float
    height: float


@dataclass(frozen=True)
class RobotDescription:
    """A checked robot.

    :param urdf: text of the URDF
    :param standing_height: height of the torso's centre over the floor with all joints at zero, in m
    :param masses: mass of each link, in kg
    :param limits: lowest and highest position of each joint, in rad or m
    :param efforts: largest force or torque of each joint, in N or Nm
    :param soles: centres of the sole contacts of each foot plate, in the plate's frame, in m
    :param contact_radius: radius of the sole contacts, in m
    :param standing_soles: centres of all sole contacts while the robot stands on the floor, in the world's frame, in m
    :param undersides: undersides of the foot plates' boxes, in the same pose
    :param scale: size of the robot as ratios to that of the default robot
    """

    urdf: str
    standing_height: float
    masses: Mapping[str, float]
    limits: Mapping[str, tuple[float, float]]
    efforts: Mapping[str, float]
    soles: Mapping[str, tuple[tuple[float, float, float], ...]]
    contact_radius: float
    standing_soles: tuple[tuple[float, float, float], ...]
    undersides: tuple[Underside, ...]
    scale: Scale


def describe_robot(dimensions: Mapping[str, float] | None = None) -> RobotDescription:
    """Build and check the robot.

    :param dimensions: values of some of :func:`default_dimensions`, in SI units; the others keep their defaults
    :return: the checked robot; equal dimensions give the same object
    :raises DescriptionError: if a dimension is unknown or not a number near its default, or if the robot is invalid
    """
    return _describe_cached(tuple(sorted(check_dimensions(dimensions or {}).items())))


@lru_cache(maxsize=16)
def _describe_cached(dimensions: tuple[tuple[str, float], ...]) -> RobotDescription:
    given = dict(dimensions)
    if scale_of(given) != Scale():
        given = {name: value for name, value in all_dimensions(given).items() if name in given or name in SCALED}
    urdf = _expand_xacro(given)
    return check_urdf(urdf) if given else _check_robot(urdf)


def _expand_xacro(dimensions: Mapping[str, float]) -> str:
    import xacro

    with (
        resources.as_file(resources.files("sarah.urdf").joinpath(XACRO)) as path,
        _xacro_lock,
    ):
        document = xacro.process_file(str(path), mappings={name: repr(value) for name, value in dimensions.items()})
    # Only the robot element: xacro's leading comment contains the path of the source.
    return document.documentElement.toprettyxml(indent="  ")


def check_urdf(urdf: str) -> RobotDescription:
    """Check that a URDF text describes SARAH, and extract what a simulator needs.

    :param urdf: text of the URDF
    :return: the checked robot
    :raises DescriptionError: naming the first rule that the text breaks
    """
    try:
        root = ElementTree.fromstring(urdf)
    except ElementTree.ParseError as error:
        raise DescriptionError(f"URDF is not well-formed XML: {error}") from error
    _check_tree(root)
    try:
        model = model_of(urdf)
        valid = model.validate()
    except Exception as error:  # yourdfpy lets through every exception of its XML parsing
        raise DescriptionError(f"yourdfpy cannot read the URDF: {error}") from error
    if not valid:
        raise DescriptionError(
            f"yourdfpy finds the URDF invalid: {'; '.join(str(problem) for problem in model.errors)}"
        )
    return _check_robot(urdf)


@lru_cache(maxsize=4)
def model_of(urdf: str) -> Any:
    """Robot as yourdfpy reads it, which must not be changed.

    :param urdf: text of the robot's URDF
    """
    import yourdfpy

    return yourdfpy.URDF.load(io.StringIO(urdf), load_meshes=False)


def _check_robot(urdf: str) -> RobotDescription:
    """Check that what a valid URDF describes is SARAH."""
    links, joints = links_and_joints(urdf)
    _check_joints(joints)
    _check_inertials(links)
    return _read_off(urdf, links, joints)


def _check_tree(root: ElementTree.Element) -> None:
    """Require unique names, known parents, and one root from which every link is reached."""
    links = [link.get("name", "") for link in root.findall("link")]
    joints = [joint.get("name", "") for joint in root.findall("joint")]
    for kind, names in (("link", links), ("joint", joints)):
        for name in names:
            if names.count(name) > 1:
                raise DescriptionError(f"URDF has more than one {kind} named {name!r}")
    parent_of: dict[str, str] = {}
    for joint in root.findall("joint"):
        ends = [
            element.get("link", "") if (element := joint.find(end)) is not None else "" for end in ("parent", "child")
        ]
        for link in ends:
            if link not in links:
                raise DescriptionError(f"URDF joint {joint.get('name')!r} names a link {link!r} that does not exist")
        if ends[1] in parent_of:
            raise DescriptionError(f"URDF link {ends[1]!r} has more than one parent")
        parent_of[ends[1]] = ends[0]
    roots = [link for link in links if link not in parent_of]
    if len(roots) != 1:
        raise DescriptionError(f"URDF must have one root link, not {len(roots)}: {', '.join(roots) or 'a loop'}")
    for link in links:
        visited = {link}
        while link in parent_of:
            link = parent_of[link]
            if link in visited:
                raise DescriptionError(f"URDF has a loop through link {link!r}")
            visited.add(link)


def _check_joints(joints: Mapping[str, ElementTree.Element]) -> None:
    """Require the ten joints, of the right kinds, with limits around zero."""
    for name, kind in JOINT_TYPES.items():
        if name not in joints:
            raise DescriptionError(f"URDF has no joint {name!r}")
        joint = joints[name]
        if joint.get("type") != kind:
            raise DescriptionError(f"URDF joint {name!r} must be {kind}, not {joint.get('type')}")
        axis = numbers_of(joint, "axis", "xyz", "1 0 0")
        if tuple(axis) != JOINT_AXES[name] or numbers_of(joint, "origin", "rpy", "0").any():
            raise DescriptionError(f"URDF joint {name!r} must turn about {JOINT_AXES[name]}, not {axis}")
        if not _limit_of(joint, "lower") <= 0.0 <= _limit_of(joint, "upper"):
            raise DescriptionError(f"URDF joint {name!r} must have limits with zero between them")
    for name in joints:
        if name not in JOINT_TYPES:
            raise DescriptionError(f"URDF joint {name!r} is not one of the robot's ten")
    for name in ACTUATED_JOINTS:
        if not _limit_of(joints[name], "effort") > 0.0:
            raise DescriptionError(f"URDF joint {name!r} must have a positive effort limit")


def _limit_of(joint: ElementTree.Element, name: str) -> float:
    return float(numbers_of(joint, "limit", name, "nan")[0])


def _mass_of(link: ElementTree.Element) -> float:
    return float(numbers_of(link, "inertial/mass", "value", "nan")[0])


def _check_inertials(links: Mapping[str, ElementTree.Element]) -> None:
    """Require positive masses and positive definite inertias."""
    expected = {name for group in GROUPS.values() for name in group}
    if set(links) != expected:
        raise DescriptionError(f"URDF links differ from the robot's: {', '.join(sorted(set(links) ^ expected))}")
    for name, link in links.items():
        if link.find("inertial/mass") is None or link.find("inertial/inertia") is None:
            raise DescriptionError(f"URDF link {name!r} has no mass or inertia")
        mass, inertia = _mass_of(link), inertia_of(link)
        if not (math.isfinite(mass) and mass > 0.0):
            raise DescriptionError(f"URDF link {name!r} must have a positive mass, not {mass}")
        if not np.isfinite(inertia).all() or not (np.linalg.eigvalsh(inertia) > 0.0).all():
            raise DescriptionError(f"URDF link {name!r} must have a positive definite inertia")


def _read_off(
    urdf: str, links: Mapping[str, ElementTree.Element], joints: Mapping[str, ElementTree.Element]
) -> RobotDescription:
    soles: dict[str, tuple[tuple[float, float, float], ...]] = {}
    standing_soles: list[tuple[float, float, float]] = []
    undersides: list[Underside] = []
    radius = 0.0
    for plate in ANKLE_JOINTS:
        place, shapes = place_of(plate, joints), links[plate].findall("collision")
        spheres = [shape for shape in shapes if shape.find("geometry/sphere") is not None]
        if not spheres:
            raise DescriptionError(f"URDF link {plate!r} has no sole contact (a collision sphere)")
        radius = float(numbers_of(spheres[0], "geometry/sphere", "radius", "nan")[0])
        centres = [numbers_of(sphere, "origin", "xyz", "0 0 0") for sphere in spheres]
        soles[plate] = tuple((float(x), float(y), float(z)) for x, y, z in centres)
        standing_soles += [(float(x), float(y), float(z)) for x, y, z in place + centres]
        for box in (shape for shape in shapes if shape.find("geometry/box") is not None):
            half = numbers_of(box, "geometry/box", "size", "nan") / 2
            x, y, z = place + numbers_of(box, "origin", "xyz", "0 0 0")
            sides = (x - half[0], x + half[0], y - half[1], y + half[1], z - half[2])
            undersides.append(Underside(*map(float, sides)))
    height = -min(z - radius for _, _, z in standing_soles)
    masses = {name: _mass_of(link) for name, link in links.items()}
    return RobotDescription(
        urdf,
        height,
        masses,
        {name: (_limit_of(joint, "lower"), _limit_of(joint, "upper")) for name, joint in joints.items()},
        {name: _limit_of(joint, "effort") for name, joint in joints.items()},
        soles,
        radius,
        tuple((x, y, z + height) for x, y, z in standing_soles),
        tuple(underside._replace(height=underside.height + height) for underside in undersides),
        Scale.of(height, sum(masses.values()), float(place_of("right_hip", joints)[0])),
    )
