"""What ``sarah-describe`` prints: masses, centre of mass, inertias, limits and efforts of a robot."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from sarah.robot.description import JOINT_TYPES, RobotDescription, default_dimensions
from sarah.robot.dimension_words import words
from sarah.robot.standing import MassProperties, links_of, together


def lines_of(robot: RobotDescription, dimensions: Mapping[str, float], payload: float) -> Iterator[str]:
    """Lines about a robot.

    :param robot: robot, which stands with all joints at zero
    :param dimensions: values of all its dimensions, in SI units
    :param payload: mass of what its torso carries, in kg
    """
    links = links_of(robot)
    whole = together(links.values())
    carried = f", and a payload of {payload:g} kg, which no number below has" if payload else ""
    centre = f"{_text(whole.centre[2])} m over the floor, {_text(whole.centre[1])} m before the torso's centre"
    yield f"{'mass':<17}{whole.mass:.5g} kg{carried}"
    yield f"{'standing height':<17}{robot.standing_height:.4g} m from the floor to the torso's centre"
    yield f"{'centre of mass':<17}{centre}, standing with all joints at zero"
    yield ""
    yield from _changed(dimensions)
    yield from _aligned(
        ("link", "mass", "centre: x", "y", "z", "inertia: xx", "yy", "zz"),
        ("", "kg", "m", "m", "m", "kg m²", "kg m²", "kg m²"),
        *((name, *_numbers(link)) for name, link in {**links, "all": whole}.items()),
    )
    yield "x points to the robot's right and y forward from the torso's centre, z up from the floor."
    yield "Inertias are about the link's centre of mass, in the same directions."
    yield ""
    yield from _aligned(("joint", "lowest", "highest", "", "effort", ""), *_joints(robot))
    yield ""


def _changed(dimensions: Mapping[str, float]) -> Iterator[str]:
    """Dimensions that differ from the defaults, and an empty line; nothing if there are none."""
    defaults, meanings = default_dimensions(), words()
    rows = [
        (name, _text(value), _text(defaults[name]), meanings[name][0])
        for name, value in dimensions.items()
        if value != defaults[name]
    ]
    if rows:
        yield from _aligned(("dimension", "value", "default", ""), *rows)
        yield ""


def _numbers(body: MassProperties) -> Iterator[str]:
    yield from map(_text, (body.mass, *body.centre, *np.diag(body.inertia)))


def _joints(robot: RobotDescription) -> Iterator[Sequence[str]]:
    for joint, (low, high) in robot.limits.items():
        unit, force = ("m", "N") if JOINT_TYPES[joint] == "prismatic" else ("rad", "Nm")
        effort = (_text(robot.efforts[joint]), force) if robot.efforts[joint] else ("passive", "")
        yield joint, _text(low), _text(high), unit, *effort


def _text(value: float) -> str:
    """Number of four digits, without what only rounding has left of zero."""
    return f"{0.0 if abs(value) < 1e-12 else value:.4g}"


def _aligned(*rows: Sequence[str]) -> Iterator[str]:
    """Lines of a table: names and units to the left, numbers to the right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    is_text = [not any(cell[-1:].isdigit() for cell in column) for column in zip(*rows, strict=True)]
    for row in rows:
        cells = zip(row, widths, is_text, strict=True)
        yield "  ".join(cell.ljust(width) if left else cell.rjust(width) for cell, width, left in cells).rstrip()
