"""What a robot answers, its windows and its telemetry, as JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from enum import Enum
from typing import Any, TypeVar

from sarah.errors import RobotError
from sarah.number import is_number
from sarah.operation.window import FELT
from sarah.remote.requests import SCHEMA


class Outcome(str, Enum):
    """What became of a request."""

    APPLIED = "applied"
    """The robot does it from this tick on."""
    KEPT = "kept"
    """The robot has stepped with the new parameters for long enough."""
    REPLACED = "replaced"
    """The robot did not step with them, and has those before again."""
    STOPPED = "stopped"
    """The robot stopped before they were proven."""
    OVERTAKEN = "overtaken"
    """Newer parameters came."""
    REFUSED = "refused"
    """The robot does not do it."""
    ENDED = "ended"
    """The robot's program ended."""
    WAITING = "waiting"
    """The robot cannot do it now, and will when it can. If the answer is final, it has to be asked again."""
    BUSY = "busy"
    """A learner operates the robot."""


@dataclass(frozen=True)
class Answer:
    """An answer to a request. A push gets one or two: when it is applied, and what became of it.

    :param outcome: what became of the request
    :param reason: reason for it, on one line
    :param is_final: whether no other answer follows
    :param tick: number of the control tick, from 0; ``None`` if the request did not get as far
    :param seconds: time of that tick since the robot began, in s
    :param state: state of the robot then
    :param phase: phase of the step that begins then
    """

    outcome: Outcome
    reason: str = ""
    is_final: bool = True
    tick: int | None = None
    seconds: float | None = None
    state: str = ""
    phase: str = ""


@dataclass(frozen=True)
class Measured:
    """What a robot measured in a window: the last answer to a request for one.

    :param observed_reward: equation 2 over its ceiling, as far as the robot's own sensors tell; what a fall or the
        supervisor cut off counts as nothing
    :param score: the same by the torso's true motion; ``None`` where nobody knows it
    :param fell: whether the robot fell, which ended the window
    :param felt: what the robot felt, in the order of :data:`~sarah.operation.window.FELT`
    :param seconds: time from the request to the end of the window, in s
    :param began: time since the robot began at which the parameters were applied, in s
    :param tick: number of that control tick, from 0
    :param ticks: number of ticks of the window
    :param reason: what the supervisor did in the window; empty if it did nothing
    """

    observed_reward: float
    score: float | None
    fell: bool
    felt: Sequence[float]
    seconds: float
    began: float
    tick: int
    ticks: int
    reason: str = ""

    def __post_init__(self) -> None:
        """Refuse what is no number.

        :raises ValueError: if something is not
        """
        numbers = [self.observed_reward, self.seconds, self.began, self.tick, self.ticks, *self.felt]
        numbers += [] if self.score is None else [self.score]
        if not all(is_number(number) and math.isfinite(number) for number in numbers):
            raise ValueError
        if len(self.felt) != len(FELT) or not isinstance(self.fell, bool) or self.seconds <= 0.0:
            raise ValueError


@dataclass(frozen=True)
class Identity:
    """What robot it is.

    :param robot: its driver, or how it is simulated, in words
    :param host: computer on which its program runs
    :param process: name of this run of the program, which no other has
    :param version: version of this package there
    :param is_lockstep: whether it waits for a learner between windows
    :param has_score: whether it knows its true score
    :param settings: settings of the robot, by name
    """

    robot: str
    host: str
    process: str
    version: str
    is_lockstep: bool
    has_score: bool
    settings: Mapping[str, Any]


@dataclass(frozen=True)
class Telemetry:
    """What a robot does.

    :param tick: number of the control tick, from 0
    :param seconds: time since the robot began, in s
    :param state: state of its supervisor
    :param reason: reason for that state
    :param phase: phase of the step
    :param steps_per_second: steps per second in the last two seconds
    :param tilt: lateral acceleration towards the stance leg, in m/s^2
    :param parameters: values of P1 to P5 and V1 to V4 that it was given; in its first second those of the paper
    :param late_ticks: number of late ticks so far
    :param stance: side of the leg that carries the robot: +1 right, -1 left
    :param reading: newest sensor signals by the names of :class:`~sarah.robot.reading.SensorReading`; ``None`` if there
        are none, or one is no number
    """

    tick: int
    seconds: float
    state: str
    reason: str
    phase: str
    steps_per_second: float
    tilt: float
    parameters: Mapping[str, float]
    late_ticks: int
    stance: int
    reading: Mapping[str, Sequence[float]] | None


Message = Answer | Measured | Identity | Telemetry
"""What a robot sends."""
Kind = TypeVar("Kind", Answer, Measured, Identity, Telemetry)


def to_json(message: Message) -> bytes:
    """A message as JSON.

    :param message: message of a robot
    """
    return json.dumps({"schema": SCHEMA, **asdict(message)}).encode()


def from_json(kind: type[Kind], text: bytes) -> Kind:
    """Read a message of a robot.

    :param kind: its kind
    :param text: what the robot sent
    :raises RobotError: if it is of another kind
    """
    try:
        content: dict[str, Any] = json.loads(text)
        if content.pop("schema") != SCHEMA or content.keys() != {item.name for item in fields(kind)}:
            raise ValueError
        if kind is Answer:
            content["outcome"] = Outcome(content["outcome"])
        return kind(**content)
    except (ValueError, TypeError, AttributeError, KeyError):
        raise RobotError(f"the robot's answer is not one of schema {SCHEMA}: {text[:100]!r}") from None
