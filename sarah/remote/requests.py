"""What a robot is asked from outside, as JSON, and every check that needs no running robot.

``request.schema.json`` beside this file describes the same for other programs.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from sarah.control.constants import STANDARD_CONSTANTS, ControllerConstants
from sarah.control.parameters import Box, Parameters
from sarah.episode.from_mapping import from_mapping
from sarah.episode.robot_settings import RobotSettings
from sarah.errors import ConfigurationError, check_whole, shortened, unknown_name
from sarah.operation.settings import PARAMETERS, MeasureSeconds, SettleSeconds
from sarah.ranges import check_ranges
from sarah.robot.dimensions import all_dimensions, check_dimensions

SCHEMA = 1
"""Version of the requests, answers and telemetry."""
KINDS = ("push", "stand", "step", "state", "window", "identity")
"""What a robot can be asked: to take parameters, to stand, to step, what it does, to take parameters and measure a
window with them, and what robot it is."""
WITH_VALUES = ("push", "window")
"""Requests that have parameters."""
LONGEST_LEARNER = 64
"""Length of a learner's name, in characters."""
LARGEST_BYTES = 8192
"""Length of a message in bytes beyond which nobody reads it."""
LARGEST_CHANGE = 0.9
"""Default of the largest change of a parameter, as a share of its range: more than any two learned sets differ by."""
BY_NAME = {parameter.name: parameter for parameter in PARAMETERS}


@dataclass(frozen=True)
class LearnedWith:
    """Controller and robot that parameters were learned with, or that a robot has.

    :param controller: constants of the controller
    :param control_rate: control ticks per second
    :param dimensions: dimensions of the robot that were set, by name, in SI units
    """

    controller: ControllerConstants = STANDARD_CONSTANTS
    control_rate: int = 100
    dimensions: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def of(cls, config: RobotSettings) -> LearnedWith:
        """Controller and robot of some settings.

        :param config: settings of a robot
        """
        return cls(config.controller, config.physics.control_rate, dict(config.dimensions))

    def difference(self, other: LearnedWith) -> str:
        """First difference, in words; empty if there is none.

        :param other: controller and robot to compare with
        """
        here, there = self._numbers(), other._numbers()
        for name, value in here.items():
            if not math.isclose(value, there[name], rel_tol=1e-9, abs_tol=1e-12):
                return f"{name} is {value:g} and not {there[name]:g}"
        return ""

    def _numbers(self) -> dict[str, float]:
        robot = {f"dimension {name}": value for name, value in all_dimensions(self.dimensions).items()}
        return {"control_rate": self.control_rate, **asdict(self.controller), **robot}


@dataclass(frozen=True)
class WindowTimes:
    """Times of a window.

    :param settle_seconds: time that new parameters are given to settle, in s
    :param measure_seconds: time that is measured, in s
    """

    settle_seconds: SettleSeconds = 2.0
    measure_seconds: MeasureSeconds = 4.0

    def __post_init__(self) -> None:
        """Refuse times outside their ranges."""
        check_ranges("window.", self)


@dataclass(frozen=True)
class Request:
    """What a robot is asked.

    :param kind: one of :data:`KINDS`
    :param values: new parameters by name, from P1 to P5 and V1 to V4; those that are not named stay
    :param learned_with: controller and robot that they were learned with, if that is known
    :param window: times of a window
    :param learner: name of the learner that asks for a window, or that leaves the robot with parameters
    """

    kind: str
    values: Mapping[str, float] = field(default_factory=dict)
    learned_with: LearnedWith | None = None
    window: WindowTimes | None = None
    learner: str = ""

    def __post_init__(self) -> None:
        """Refuse unknown kinds and names, and values outside their ranges."""
        if self.kind not in KINDS:
            raise ConfigurationError(unknown_name("kind of request", self.kind, KINDS))
        for name in self.values:
            if name not in BY_NAME:
                raise ConfigurationError(unknown_name("parameter", name, BY_NAME))
        if bool(self.values) != (self.kind in WITH_VALUES):
            raise ConfigurationError(f"a request to {self.kind} has {'no' if self.values else 'to have'} values")
        if (self.window is not None) != (self.kind == "window"):
            has = "to have a" if self.window is None else "no"
            raise ConfigurationError(f"a request to {self.kind} has {has} window")
        if len(self.learner) > LONGEST_LEARNER or (self.kind == "window" and not self.learner):
            raise ConfigurationError(f"learner must be a name of 1 to {LONGEST_LEARNER} characters")
        checked = Box(tuple(BY_NAME[name] for name in self.values)).checked(list(self.values.values()))
        object.__setattr__(self, "values", dict(zip(self.values, checked, strict=True)))

    def to_json(self) -> bytes:
        """The request as JSON."""
        content: dict[str, Any] = {"schema": SCHEMA, "kind": self.kind}
        if self.values:
            content["values"] = dict(self.values)
        if self.learned_with is not None:
            content["learned_with"] = asdict(self.learned_with)
        if self.window is not None:
            content["window"] = asdict(self.window)
        if self.learner:
            content["learner"] = self.learner
        return json.dumps(content).encode()


def read_request(message: bytes) -> Request:
    """Read a request.

    :param message: JSON as ``request.schema.json`` describes it
    :raises ConfigurationError: with what is wrong, on one line
    """
    content = _read_json(message)
    if not isinstance(content, dict):
        raise ConfigurationError(f"a request must be a JSON object, not {shortened(content)}")
    _check_keys(content, "schema", "kind", "values", "learned_with", "window", "learner")
    version, kind = content.get("schema"), content.get("kind")
    if type(version) is not int or version != SCHEMA:
        raise ConfigurationError(f"schema must be {SCHEMA}, not {shortened(version)}")
    if not isinstance(kind, str):
        raise ConfigurationError(f"kind must be one of {', '.join(KINDS)}, not {shortened(kind)}")
    values = content.get("values", {})
    if not isinstance(values, dict):
        raise ConfigurationError(f"values must hold names and numbers, not {shortened(values)}")
    learner = content.get("learner", "")
    if not isinstance(learner, str) or ("learner" in content and not learner):
        raise ConfigurationError(
            f"learner must be a name of 1 to {LONGEST_LEARNER} characters, not {shortened(learner)}"
        )
    return Request(
        kind,
        values,
        _read_learned_with(content["learned_with"]) if "learned_with" in content else None,
        from_mapping(WindowTimes(), content["window"], "window.") if "window" in content else None,
        learner,
    )


def _read_json(message: bytes) -> Any:
    """Content of a message; a number that is not finite and a name that comes twice are mistakes."""

    def once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        content = dict(pairs)
        if len(content) < len(pairs):
            raise ValueError("a name comes twice")
        return content

    def refused(constant: str) -> None:
        raise ValueError(f"{constant} is no number")

    if len(message) > LARGEST_BYTES:
        raise ConfigurationError(f"a message has at most {LARGEST_BYTES} bytes, not {len(message)}")
    try:
        return json.loads(message.decode(), object_pairs_hook=once, parse_constant=refused)
    except (ValueError, RecursionError) as error:
        raise ConfigurationError(f"not JSON: {' '.join(str(error).split())[:100]}") from None


def _read_learned_with(content: Any) -> LearnedWith:
    names = ("controller", "control_rate", "dimensions")
    if not isinstance(content, dict) or not set(names) <= content.keys():
        raise ConfigurationError(f"learned_with must hold {', '.join(names)}, not {shortened(content)}")
    _check_keys(content, *names)
    if not isinstance(content["dimensions"], dict):
        raise ConfigurationError(f"dimensions must hold names and numbers, not {shortened(content['dimensions'])}")
    return LearnedWith(
        from_mapping(STANDARD_CONSTANTS, content["controller"], "controller."),
        check_whole("control_rate", content["control_rate"], 1, 10_000, "per second"),
        check_dimensions(content["dimensions"]),
    )


def _check_keys(content: Mapping[str, Any], *allowed: str) -> None:
    for name in content:
        if name not in allowed:
            raise ConfigurationError(unknown_name("key", name, allowed))


def too_large(values: Mapping[str, float], present: Parameters, largest_change: float) -> str:
    """Reason to refuse new parameters that are too far from the present ones; empty if none is.

    :param values: new parameters by name
    :param present: present values of all nine
    :param largest_change: largest change, as a share of a parameter's range
    """
    for parameter, before in zip(PARAMETERS, present, strict=True):
        largest = largest_change * parameter.width
        change = abs(values.get(parameter.name, before) - before)
        if change > largest * (1.0 + 1e-9):
            return f"{parameter.name} would change by {change:.3g}, and may change by {largest:.3g}"
    return ""


def merged(values: Mapping[str, float], present: Sequence[float]) -> Parameters:
    """All nine parameters, of which those that are not named stay.

    :param values: new parameters by name
    :param present: present values of all nine
    """
    return tuple(values.get(one.name, before) for one, before in zip(PARAMETERS, present, strict=True))
