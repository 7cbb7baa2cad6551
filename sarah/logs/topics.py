"""The topics of a log: schemas, columns of tables and documentation come from here."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from typing import Any

from sarah.control.pattern_generator import Phase, PhaseChange
from sarah.logs.topic import Field, Topic, Values
from sarah.operation.settings import PARAMETERS
from sarah.operation.window import FELT, FELT_SIZES
from sarah.robot.description import JOINT_TYPES
from sarah.robot.reading import ACTUATED_JOINTS, SensorReading, Side

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
_SIGNALS = 16
"""Number of the last fields of a tick, which are those of its reading."""
_DECIDED_NAMES = tuple(field.name for field in _TICK_FIELDS[:-_SIGNALS])
_SIGNAL_NAMES = tuple(field.name for field in _TICK_FIELDS[-_SIGNALS:])
_FELT_MEANINGS = {
    "mean": "mean of {}",
    "deviation": "standard deviation of {}",
    "seconds": "mean duration of {}",
    "lag": "mean distance of {} from its target",
    "load": "mean load on the pads of the {} foot",
    "second": "steps per second",
}
"""Meaning of what the robot felt, by the last word of its name; the words before it take the place of the braces."""
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
    decided = (seconds, reading_seconds, late_seconds, state, phase.value, str(stance), tilt, rate, *targets)
    values = dict(zip(_DECIDED_NAMES, decided, strict=True))
    if reading is not None:
        values.update(zip(_SIGNAL_NAMES, itertools.chain(*reading), strict=True))
    return values


def reading_of(values: Mapping[str, Any]) -> SensorReading | None:
    """Reading of a tick; ``None`` if a signal is missing.

    :param values: values of a message of ``/ticks``
    """
    signals = [values.get(name) for name in _SIGNAL_NAMES]
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
    names = ("index", "changes", "observed_reward", "score", "fell")
    others = {name: window[name] for name in names if window.get(name) is not None}
    return {"seconds": seconds, **times, "fell": False, **others, **dict(parameters), **dict(felt)}


def _meaning(felt: str) -> str:
    """Meaning of what the robot felt, from its name."""
    subject, _, what = felt.rpartition("_")
    return _FELT_MEANINGS[what].format(subject)


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
        Field("duration", "time that it took, with standing before it and setting upright after it", "s"),
        Field("index", "number of the window, from 0"),
        Field("changes", "number of changes that had been made to robot and world"),
        Field("observed_reward", "reward as the robot's own sensors tell it; 1 is the best"),
        Field("score", "reward by the true motion, which only a simulation knows"),
        Field("fell", "whether the robot fell, which ended the window", kind="boolean"),
        *_PARAMETER_FIELDS,
        *(
            Field(f"felt_{name}", f"{_meaning(name)} in the window", unit)
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
