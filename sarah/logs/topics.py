"""The topics of a log, and the fields of their messages: schemas, columns and documentation come from here.

A message is one flat JSON object, so a field's name is also its path in a plotting program and its column in a table.
A number that is not finite, or that nobody knows, is left out.
"""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from sarah.control.pattern_generator import Phase, PhaseChange
from sarah.errors import ConfigurationError, shortened
from sarah.number import is_finite, is_number, plain
from sarah.operation.settings import PARAMETERS
from sarah.operation.window import FELT, FELT_SIZES
from sarah.robot.description import JOINT_TYPES
from sarah.robot.reading import ACTUATED_JOINTS, SensorReading, Side

Values = dict[str, Any]
"""Values of a message by the names of its fields."""
LONGEST_SECONDS = 1e9
"""Largest time in a log, in s: thirty years."""
TYPES = {"number": float, "string": str, "boolean": bool}
"""Types in Python of JSON's types."""
_ENCODE = json.JSONEncoder(allow_nan=False, separators=(",", ":")).encode


@dataclass(frozen=True)
class Field:
    """A value of a message.

    :param name: name, which has no dots
    :param meaning: what it is, as a noun phrase
    :param unit: SI unit; empty for what has none
    :param kind: type in JSON
    """

    name: str
    meaning: str
    unit: str = ""
    kind: str = "number"

    @property
    def description(self) -> str:
        """Meaning with unit."""
        return f"{self.meaning}, in {self.unit}" if self.unit else self.meaning

    def allows(self, value: object) -> bool:
        """Whether it can have a value: a finite number, or one of its type.

        :param value: value of a message
        """
        if self.kind == "number":
            return is_number(value) and is_finite(value)
        return isinstance(value, TYPES[self.kind])


@dataclass(frozen=True)
class Topic:
    """Messages of one kind.

    :param name: name, with a slash before it
    :param schema: name of their schema
    :param meaning: when there is one, and what it tells
    :param fields: their values; numbers but the time may be missing
    :param values: function that makes the values of what the log is given
    """

    name: str
    schema: str
    meaning: str
    fields: tuple[Field, ...]
    values: Callable[..., Values]

    @cached_property
    def needed(self) -> tuple[str, ...]:
        """Names of the fields that every message has."""
        return tuple(field.name for field in self.fields if field.kind != "number" or field is self.fields[0])

    @property
    def json_schema(self) -> bytes:
        """Schema of the messages, as JSON Schema."""
        properties = {field.name: {"type": field.kind, "description": field.description} for field in self.fields}
        schema = {"title": self.schema, "description": self.meaning, "type": "object", "properties": properties}
        return json.dumps({**schema, "required": self.needed}).encode()

    def encoded(self, *given: Any) -> bytes:
        """JSON of a message.

        :param given: arguments of :attr:`values`
        """
        values = self.values(*given)
        types = self.types
        if not all(type(value) is types[name] for name, value in values.items()):
            values = self._known(values)
        try:
            return _ENCODE(values).encode()
        except ValueError:  # a number that is not finite
            return _ENCODE(self._known(values)).encode()

    @cached_property
    def types(self) -> dict[str, type]:
        """Types in Python of the fields, by name."""
        return {field.name: TYPES[field.kind] for field in self.fields}

    def _known(self, values: Values) -> Values:
        """Values that their fields may have, as Python's own.

        :raises KeyError: if one is missing that every message has
        """
        plained = {field: plain(values[field.name]) for field in self.fields if field.name in values}
        known = {field.name: value for field, value in plained.items() if field.allows(value)}
        return {name: known[name] for name in (*self.needed, *known)}

    def decoded(self, data: bytes) -> Values:
        """Values of a message.

        :param data: its JSON
        :raises ConfigurationError: if it is not one of this topic
        """
        try:
            values = json.loads(data)
        except (ValueError, RecursionError) as error:
            raise ConfigurationError(f"a message of {self.name} is not JSON") from error
        if not isinstance(values, dict):
            raise ConfigurationError(f"a message of {self.name} must be an object, not {shortened(values)}")
        for name in self.needed:
            if name not in values:
                raise ConfigurationError(f"a message of {self.name} has no {name}")
        for field in self.fields:
            if field.name in values and not field.allows(values[field.name]):
                given = shortened(values[field.name])
                raise ConfigurationError(f"{field.name} of {self.name} must be a {field.kind}, not {given}")
        return values


SECONDS = Field("seconds", "time since the run began", "s")
_STANCE = Field("stance", "leg that carries the robot: left or right", kind="string")
_TICK_FIELDS = (
    SECONDS,
    Field("reading_seconds", "time at which the reading was taken", "s"),
    Field("late_seconds", "delay of the tick behind its deadline", "s"),
    Field("state", "state: standing, stepping, stopping or fallen", kind="string"),
    Field("phase", "phase of the pattern generator: stand, shift, lift or land", kind="string"),
    _STANCE,
    Field("tilt", "lean towards the leg that carries, which P2 is compared with", "m/s^2"),
    Field("rate", "rate towards that leg, which P1 and P3 are compared with", "rad/s"),
    *(
        Field(f"target_{joint}", f"target of {joint}", "m" if JOINT_TYPES[joint] == "prismatic" else "rad")
        for joint in ACTUATED_JOINTS
    ),
    *(Field(f"acceleration_{axis}", f"specific force along {axis} of the torso", "m/s^2") for axis in "xyz"),
    *(Field(f"angular_rate_{axis}", f"angular rate about {axis} of the torso", "rad/s") for axis in "xyz"),
    *(
        Field(f"load_{side}_{pad}", f"load on the pad of the {side} {pad}", "N")
        for side in ("left", "right")
        for pad in ("forefoot", "hindfoot")
    ),
    *(
        Field(f"position_{joint}", f"position of {joint}", "m" if JOINT_TYPES[joint] == "prismatic" else "rad")
        for joint in ACTUATED_JOINTS
    ),
)
_TICK_NAMES = tuple(field.name for field in _TICK_FIELDS)
_PARAMETER_FIELDS = tuple(Field(one.name, one.meaning, one.unit) for one in PARAMETERS)


def _tick(
    seconds: float,
    reading: SensorReading | None,
    reading_seconds: float,
    targets: tuple[float, ...],
    state: str,
    phase: Phase,
    stance: Side,
    tilt: float,
    rate: float,
    late_seconds: float,
) -> Values:
    signals = () if reading is None else itertools.chain(*reading)  # the last fields, and without a reading none
    decided = (seconds, reading_seconds, late_seconds, state, phase.value, str(stance), tilt, rate, *targets)
    return dict(zip(_TICK_NAMES, (*decided, *signals), strict=False))


def reading_of(values: Mapping[str, Any]) -> SensorReading | None:
    """Reading of a tick; ``None`` if a signal is missing.

    :param values: values of a message of ``/ticks``
    """
    signals = [values.get(name) for name in _TICK_NAMES[-16:]]
    if None in signals:
        return None
    return SensorReading(*(tuple(signals[begin:end]) for begin, end in itertools.pairwise((0, 3, 6, 10, 16))))  # type: ignore[arg-type]  # as long


def targets_of(values: Mapping[str, Any]) -> tuple[float, ...] | None:
    """Targets of a tick, in rad and m; ``None`` if one is missing.

    :param values: values of a message of ``/ticks``
    """
    targets = tuple(values.get(f"target_{joint}") for joint in ACTUATED_JOINTS)
    return None if None in targets else targets  # type: ignore[return-value]  # none is missing


def _phase_change(seconds: float, change: PhaseChange, stance: Side) -> Values:
    ended = {"ended": change.ended.value, "by_sensors": change.by_sensors, "is_step": change.is_step}
    return {"seconds": seconds, **ended, "stance": str(stance)}


def _window(seconds: float, window: Mapping[str, Any]) -> Values:
    parameters = zip((one.name for one in PARAMETERS), window.get("parameters", ()), strict=False)
    felt = zip((f"felt_{name}" for name in FELT), window.get("felt", ()), strict=False)
    times = {"begin": window.get("begin"), "duration": window.get("seconds")}
    others = {name: window[name] for name in ("index", "changes", "observed_reward", "score", "fell") if name in window}
    return {"seconds": seconds, **times, "fell": False, **others, **dict(parameters), **dict(felt)}


def _parameters(
    seconds: float, values: Mapping[str, float], asked_seconds: float, by: str, accepted: bool, reason: str
) -> Values:
    asked = {"asked_seconds": asked_seconds, "by": by, "accepted": accepted, "reason": reason}
    known = {one.name: values[one.name] for one in PARAMETERS if one.name in values}
    return {"seconds": seconds, **asked, **known}


def _state(seconds: float, state: str, before: str, reason: str) -> Values:
    return {"seconds": seconds, "state": state, "before": before, "reason": reason}


TICKS = Topic(
    "/ticks",
    "sarah.Tick",
    "each control tick: what the robot felt, and what the controller decided",
    _TICK_FIELDS,
    _tick,
)
PHASE_CHANGES = Topic(
    "/phase_changes",
    "sarah.PhaseChange",
    "each end of a phase",
    (
        SECONDS,
        Field("ended", "phase that ended: stand, shift, lift or land", kind="string"),
        Field("by_sensors", "whether sensors ended it, and not its time-out", kind="boolean"),
        Field("is_step", "whether it completed a step", kind="boolean"),
        Field("stance", "leg that carries the robot after it: left or right", kind="string"),
    ),
    _phase_change,
)
WINDOWS = Topic(
    "/windows",
    "sarah.Window",
    "each end of a window of an operation: what it was worth, and what the robot felt",
    (
        SECONDS,
        Field("begin", "time at which the window began", "s"),
        Field("duration", "time that it took, with standing before it and putting up after it", "s"),
        Field("index", "number of the window, from 0"),
        Field("changes", "number of changes that had been made to robot and world"),
        Field("observed_reward", "reward as the robot's own sensors tell it; 1 is the best"),
        Field("score", "reward by the true motion, which only a simulation knows"),
        Field("fell", "whether the robot fell, which ended the window", kind="boolean"),
        *_PARAMETER_FIELDS,
        *(
            Field(f"felt_{name}", f"{name.replace('_', ' ')} in the window", unit)
            for name, (_, unit) in zip(FELT, FELT_SIZES, strict=True)
        ),
    ),
    _window,
)
PARAMETER_CHANGES = Topic(
    "/parameters",
    "sarah.Parameters",
    "each set of parameters that was asked for",
    (
        SECONDS,
        Field("asked_seconds", "time at which it was asked for; seconds is when it was applied or refused", "s"),
        Field("by", "who asked", kind="string"),
        Field("accepted", "whether it was applied", kind="boolean"),
        Field("reason", "reason why it was not", kind="string"),
        *_PARAMETER_FIELDS,
    ),
    _parameters,
)
STATES = Topic(
    "/states",
    "sarah.State",
    "each change of the state",
    (
        SECONDS,
        Field("state", "new state: standing, stepping, stopping or fallen; ended, after a simulation", kind="string"),
        Field("before", "state before; empty at first", kind="string"),
        Field("reason", "reason of the change", kind="string"),
    ),
    _state,
)
TOPICS = {topic.name: topic for topic in (TICKS, PHASE_CHANGES, WINDOWS, PARAMETER_CHANGES, STATES)}
"""All topics by name."""
