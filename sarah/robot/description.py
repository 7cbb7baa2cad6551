"""The robot: from the xacro to a checked URDF text.

PyBullet crashes on some malformed URDFs and silently accepts others. So yourdfpy checks every text before an engine
sees it. That the robot is SARAH is for the tests of the xacro: dimensions change its numbers only.
"""

from __future__ import annotations

import io
import threading
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from typing import Any, NamedTuple

from sarah.errors import DescriptionError
from sarah.robot.dimensions import SCALED, XACRO, all_dimensions, check_dimensions, scale_of
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
    return _read_off(_expand_xacro(given))


def _expand_xacro(dimensions: Mapping[str, float]) -> str:
    import xacro

    with (
        resources.as_file(resources.files("sarah.urdf").joinpath(XACRO)) as path,
        _xacro_lock,
    ):
        document = xacro.process_file(str(path), mappings={name: repr(value) for name, value in dimensions.items()})
    # Only the robot element: xacro's leading comment contains the path of the source.
    return document.documentElement.toprettyxml(indent="  ")


@lru_cache(maxsize=4)
def model_of(urdf: str) -> Any:
    """Robot as yourdfpy reads it, which must not be changed.

    :param urdf: text of the URDF
    :raises DescriptionError: naming what yourdfpy finds invalid
    """
    import yourdfpy

    model = yourdfpy.URDF.load(io.StringIO(urdf), load_meshes=False)
    if not model.validate():
        raise DescriptionError(f"yourdfpy finds the URDF invalid: {'; '.join(map(str, model.errors))}")
    return model


def _read_off(urdf: str) -> RobotDescription:
    model = model_of(urdf)
    soles: dict[str, tuple[tuple[float, float, float], ...]] = {}
    standing_soles: list[tuple[float, float, float]] = []
    undersides: list[Underside] = []
    radius = 0.0
    for plate in ANKLE_JOINTS:
        spheres = [shape for shape in model.link_map[plate].collisions if shape.geometry.sphere is not None]
        radius = spheres[0].geometry.sphere.radius
        soles[plate] = tuple((float(s.origin[0, 3]), float(s.origin[1, 3]), float(s.origin[2, 3])) for s in spheres)
        to_torso = model.get_transform(plate, "torso")
        for sole in soles[plate]:
            x, y, z = map(float, (to_torso @ [*sole, 1.0])[:3])
            standing_soles.append((x, y, z))
        boxes = [shape for shape in model.link_map[plate].collisions if shape.geometry.box is not None]
        for box in boxes:
            (x, y, z), half = to_torso[:3, 3] + box.origin[:3, 3], box.geometry.box.size / 2
            sides = (x - half[0], x + half[0], y - half[1], y + half[1], z - half[2])
            undersides.append(Underside(*map(float, sides)))
    height = -min(z - radius for _, _, z in standing_soles)
    masses = {name: float(link.inertial.mass) for name, link in model.link_map.items()}
    limits = {name: (joint.limit.lower, joint.limit.upper) for name, joint in model.joint_map.items()}
    efforts = {name: joint.limit.effort for name, joint in model.joint_map.items()}
    return RobotDescription(
        urdf,
        height,
        masses,
        limits,
        efforts,
        soles,
        radius,
        tuple((x, y, z + height) for x, y, z in standing_soles),
        tuple(underside._replace(height=underside.height + height) for underside in undersides),
        Scale.of(height, sum(masses.values()), float(model.joint_map["right_hip_abduction"].origin[0, 3])),
    )
