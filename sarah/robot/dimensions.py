"""The robot's dimensions: the arguments of the xacro, in SI units."""

from __future__ import annotations

import itertools
import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping
from functools import lru_cache
from importlib import resources
from types import MappingProxyType
from typing import Any, NamedTuple

from sarah.errors import DescriptionError, shortened, unknown_name
from sarah.number import is_number, plain
from sarah.robot.scale import DIGITS, Scale

LARGEST_FACTOR = {"mass": 100.0}
"""Largest factor by which a dimension may differ from its default, by the end of its name: beyond it, somebody has
mistaken the unit."""
OTHERS_LARGEST_FACTOR = 10.0
"""The same for all other dimensions."""
SCALED = ("hip_effort", "leg_effort", "ankle_damping")
"""Dimensions whose defaults go with the length and the mass of the robot."""
XACRO = "sarah.urdf.xacro"
"""Name of the file, in the package ``sarah.urdf``."""

_ARGUMENT = "{http://www.ros.org/wiki/xacro}arg"


class Dimension(NamedTuple):
    """What can be set of the robot.

    :param default: value of the default robot
    :param unit: SI unit of the values
    :param meaning: what it is, in a few words
    :param low: lowest value
    :param high: highest value
    """

    default: float
    unit: str
    meaning: str
    low: float
    high: float


@lru_cache(maxsize=1)
def known_dimensions() -> Mapping[str, Dimension]:
    """Every dimension of the robot by its name, in the order of the xacro, whose comments are units and meanings."""
    text = resources.files("sarah.urdf").joinpath(XACRO).read_text(encoding="utf-8")
    parser = ElementTree.XMLParser(target=ElementTree.TreeBuilder(insert_comments=True))
    elements = list(ElementTree.fromstring(text, parser))
    dimensions = {}
    for element, comment in itertools.pairwise(elements):
        if element.tag == _ARGUMENT:
            name, default = element.attrib["name"], float(element.attrib["default"])
            factor = LARGEST_FACTOR.get(name.rpartition("_")[2], OTHERS_LARGEST_FACTOR)
            unit, _, meaning = (comment.text or "").strip().partition(": ")
            dimensions[name] = Dimension(default, unit, meaning, default / factor, default * factor)
    return MappingProxyType(dimensions)


def default_dimensions() -> dict[str, float]:
    """Every dimension of the robot that can be set, with its default, in SI units.

    :return: the xacro's arguments, in the order of the file
    """
    return {name: dimension.default for name, dimension in known_dimensions().items()}


def check_dimensions(dimensions: Mapping[str, Any]) -> dict[str, float]:
    """Refuse dimensions that the robot does not have.

    :param dimensions: values by name, in SI units, as a user gave them
    :return: the same, in floats
    :raises DescriptionError: for an unknown name, a value that is not a number near the default, or feet in one place
        or through the floor
    """
    if not isinstance(dimensions, Mapping):
        raise DescriptionError(f"robot dimensions must be values by name, not {shortened(dimensions)}")
    known = known_dimensions()
    checked = {}
    for name, given in dimensions.items():
        value = plain(given)
        if name not in known:
            raise DescriptionError(unknown_name("robot dimension", str(name), known))
        default, unit, meaning, low, high = known[name]
        if not is_number(value) or not low <= value <= high:
            raise DescriptionError(
                f"robot dimension {name!r} must be a number between {low:g} and {high:g} {unit}, not "
                f"{shortened(value)} (default: {default:g} {unit}; {meaning})"
            )
        checked[str(name)] = float(value)
    _check_feet({**default_dimensions(), **checked})
    return checked


def _check_feet(robot: Mapping[str, float]) -> None:
    """Refuse feet that overlap, and foot plates that do not lie above the soles."""
    half_width, radius, thickness = robot["sole_half_width"], robot["contact_radius"], robot["plate_thickness"]
    for name, least, of_what, otherwise in (
        (
            "hip_offset",
            half_width + radius,
            f"sole_half_width {half_width:g} + contact_radius {radius:g}",
            "feet overlap",
        ),
        ("hinge_height", 1.5 * thickness, f"1.5 times plate_thickness {thickness:g}", "foot plates reach the floor"),
    ):
        if robot[name] < round(least, DIGITS):
            raise DescriptionError(
                f"robot dimension {name!r} must be at least {least:g} m, which is {of_what}, not {robot[name]:g}: the "
                f"{otherwise}"
            )


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
    scale, known = scale_of(dimensions), known_dimensions()
    scaled = {name: known[name].default * scale.factor(known[name].unit) for name in SCALED}
    return {**default_dimensions(), **scaled, **dimensions}


def unscaled_dimensions(dimensions: Mapping[str, float]) -> dict[str, float]:
    """Dimensions of a robot whose efforts and ankle damping do not go with its size.

    :param dimensions: values of some of :func:`default_dimensions`
    """
    if scale_of(dimensions) == Scale():
        return dict(dimensions)
    return {**{name: known_dimensions()[name].default for name in SCALED}, **dimensions}


def dimensions_alike(length: float, mass: float) -> dict[str, float]:
    """Dimensions of a robot that is like the default one; what follows from its size is left out.

    :param length: ratio of all lengths to those of the default robot
    :param mass: ratio of all masses to those of the default robot
    """
    scale = Scale(length, mass, length)
    return {
        name: dimension.default * scale.factor(dimension.unit)
        for name, dimension in known_dimensions().items()
        if name not in SCALED and dimension.unit != "rad"
    }
