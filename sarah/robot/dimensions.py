"""The robot's dimensions: the arguments of the xacro, in SI units."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping
from functools import lru_cache
from importlib import resources
from typing import Any

from sarah.errors import DescriptionError, shortened, unknown_name
from sarah.number import is_number, plain
from sarah.robot.scale import Scale

LARGEST_FACTOR = {"mass": 100.0}
"""Largest factor by which a dimension may differ from its default, by the end of its name: beyond it, somebody has
mistaken the unit."""
OTHERS_LARGEST_FACTOR = 10.0
"""The same for all other dimensions."""
SCALED = {"hip_effort": "Nm", "leg_effort": "N", "ankle_damping": "Nms/rad"}
"""Units of the dimensions whose defaults go with the length and the mass of the robot."""
XACRO = "sarah.urdf.xacro"
"""Name of the file, in the package ``sarah.urdf``."""

_NAMESPACE = "{http://www.ros.org/wiki/xacro}"


def default_dimensions() -> dict[str, float]:
    """Every dimension of the robot that can be set, with its default, in SI units.

    :return: the xacro's arguments, in the order of the file
    """
    return dict(_default_dimensions())


@lru_cache(maxsize=1)
def _default_dimensions() -> tuple[tuple[str, float], ...]:
    root = ElementTree.fromstring(resources.files("sarah.urdf").joinpath(XACRO).read_text(encoding="utf-8"))
    return tuple((arg.attrib["name"], float(arg.attrib["default"])) for arg in root.iter(f"{_NAMESPACE}arg"))


def range_of(name: str) -> tuple[float, float]:
    """Lowest and highest value of a dimension.

    :param name: name of the dimension, one of :func:`default_dimensions`
    """
    default = default_dimensions()[name]
    factor = LARGEST_FACTOR.get(name.rpartition("_")[2], OTHERS_LARGEST_FACTOR)
    return default / factor, default * factor


def check_dimensions(dimensions: Mapping[str, Any]) -> dict[str, float]:
    """Refuse dimensions that the robot does not have.

    :param dimensions: values by name, in SI units, as a user gave them
    :return: the same, in floats
    :raises DescriptionError: for an unknown name, or a value that is not a number near the default
    """
    allowed = default_dimensions()
    checked = {}
    for name, given in dimensions.items():
        value = plain(given)
        if name not in allowed:
            raise DescriptionError(unknown_name("robot dimension", str(name), allowed))
        low, high = range_of(name)
        if not is_number(value) or not low <= value <= high:
            raise DescriptionError(
                f"robot dimension {name!r} must be a number between {low:g} and {high:g}, not {shortened(value)} "
                f"(default: {allowed[name]:g}; metres, kilograms, seconds and radians)"
            )
        checked[str(name)] = float(value)
    return checked


def scale_of(dimensions: Mapping[str, float]) -> Scale:
    """Size of a robot.

    :param dimensions: values of some of :func:`default_dimensions`; the others keep their defaults
    """
    robot = {**default_dimensions(), **dimensions}
    pairs = ("hip_mass", "thigh_mass", "shank_mass", "forefoot_mass", "hindfoot_mass")
    mass = robot["torso_mass"] + 2.0 * sum(robot[name] for name in pairs)
    height = sum(robot[name] for name in ("hip_drop", "thigh_length", "shank_length", "hinge_height"))
    return Scale.of(height, mass, robot["hip_offset"])


def all_dimensions(dimensions: Mapping[str, float]) -> dict[str, float]:
    """Every dimension of a robot.

    :param dimensions: values of some of :func:`default_dimensions`; the others keep their defaults, of which efforts
        and ankle damping go with the length and the mass of the robot
    """
    scale, defaults = scale_of(dimensions), default_dimensions()
    return {**defaults, **{name: defaults[name] * scale.factor(unit) for name, unit in SCALED.items()}, **dimensions}
