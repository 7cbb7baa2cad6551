"""What ``sarah-describe`` prints: masses, centre of mass, inertias, limits and efforts of a robot."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from sarah.episode.reward import natural_step_frequency
from sarah.episode.settings import EpisodeConfig
from sarah.robot.description import JOINT_TYPES, RobotDescription, describe_robot
from sarah.robot.dimensions import all_dimensions, known_dimensions
from sarah.robot.standing import MassProperties, links_of, together
from sarah.runs.config_files import settings_by_key


def lines_of(config: EpisodeConfig, usual: EpisodeConfig) -> Iterator[str]:
    """Lines about a robot and about the settings that go with it.

    :param config: settings of the robot's episodes
    :param usual: settings of the default robot
    """
    robot = describe_robot(config.dimensions)
    links = links_of(robot)
    whole = together(links.values())
    carried = f", and a payload of {config.payload:g} kg, which no number below has" if config.payload else ""
    centre = f"{_text(whole.centre[2])} m over the floor, {_text(whole.centre[1])} m before the torso's centre"
    yield f"{'mass':<17}{whole.mass:.5g} kg{carried}"
    yield f"{'standing height':<17}{robot.standing_height:.4g} m from the floor to the torso's centre"
    yield f"{'centre of mass':<17}{centre}, standing with all joints at zero"
    yield f"{'step frequency':<17}{natural_step_frequency(config):.3g} steps per second by itself"
    yield ""
    yield from _given(config)
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
    yield from _following(config, usual)


def _given(config: EpisodeConfig) -> Iterator[str]:
    """Dimensions that were given, and an empty line; nothing if there are none."""
    known = known_dimensions()
    rows = [
        (name, _text(value), _text(known[name].default), known[name].unit) for name, value in config.dimensions.items()
    ]
    if rows:
        yield from _aligned(("dimension", "value", "default", ""), *rows)
        yield ""


def _following(config: EpisodeConfig, usual: EpisodeConfig) -> Iterator[str]:
    """Settings that go with the robot's size, and an empty line; nothing if it has that of the default robot."""
    default, ruled, own = map(_settings, (usual, usual.for_robot(config.dimensions), config))
    rows = [
        (name, _text(own[name]), _text(default[name]), "" if own[name] == value else f"the rule gives {_text(value)}")
        for name, value in ruled.items()
        if value != default[name] and name not in config.dimensions
    ]
    if rows:
        yield f"Follows from {config.scale.words()}:"
        yield from _aligned(("setting", "value", "default", ""), *rows)
        yield ""


def _settings(config: EpisodeConfig) -> dict[str, Any]:
    """Settings by their names as options, and dimensions by theirs."""
    found = {f"episode.{name.replace('_', '-')}": value for name, value in settings_by_key(config).items()}
    return all_dimensions(found.pop("episode.dimensions")) | found


def _numbers(body: MassProperties) -> Iterator[str]:
    yield from map(_text, (body.mass, *body.centre, *np.diag(body.inertia)))


def _joints(robot: RobotDescription) -> Iterator[Sequence[str]]:
    for joint, (low, high) in robot.limits.items():
        unit, force = ("m", "N") if JOINT_TYPES[joint] == "prismatic" else ("rad", "Nm")
        effort = (_text(robot.efforts[joint]), force) if robot.efforts[joint] else ("passive", "")
        yield joint, _text(low), _text(high), unit, *effort


def _text(value: Any) -> str:
    """Number of four digits, without what only rounding has left of zero, or the ends of a range."""
    if isinstance(value, list):
        return " to ".join(map(_text, dict.fromkeys(value)))
    return f"{0.0 if abs(value) < 1e-12 else value:.4g}"


def _aligned(*rows: Sequence[str]) -> Iterator[str]:
    """Lines of a table: names and units to the left, numbers to the right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    is_text = [not any(cell[-1:].isdigit() for cell in column) for column in zip(*rows, strict=True)]
    for row in rows:
        cells = zip(row, widths, is_text, strict=True)
        yield "  ".join(cell.ljust(width) if left else cell.rjust(width) for cell, width, left in cells).rstrip()
