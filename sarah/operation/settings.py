"""The settings of a robot in operation, and the box of its nine parameters."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

from sarah.control.hip_law import BalanceParameters
from sarah.control.parameters import BALANCE_PARAMETERS, STEPPING_PARAMETERS, Box, Parameters
from sarah.control.pattern_generator import SteppingParameters
from sarah.episode.from_mapping import changed_alone, convert_fields
from sarah.episode.push import Push, PushedConfig
from sarah.episode.shipped import shipped_parameters
from sarah.errors import ConfigurationError, check_extended_from, check_type, shortened
from sarah.number import plain
from sarah.ranges import Within, check_ranges
from sarah.robot.description import describe_robot

PARAMETERS = (*STEPPING_PARAMETERS, *BALANCE_PARAMETERS)
"""The nine parameters that can change while the robot runs: P1 to P5 and V1 to V4."""
BOX = Box(PARAMETERS, decimals=6)
"""Their ranges together. What a learner chooses is rounded, so that a table shows all of it."""
SHIPPED: Parameters = (
    *shipped_parameters("stepping", STEPPING_PARAMETERS),
    *shipped_parameters("balance", BALANCE_PARAMETERS),
)
"""P1 to P5 and V1 to V4 that the package ships."""
Minutes = Annotated[float, Within(0.1, 600.0, "min")]
SettleSeconds = Annotated[float, Within(0.0, 60.0, "s")]
MeasureSeconds = Annotated[float, Within(0.5, 600.0, "s")]
WITHOUT_EFFECT = ("time_limit", "reward_form", "push.at_seconds")
"""Settings of an episode that an operation does not know."""
SOFT_PUSHES = Push(newtons=(0.0, 50.0))
"""Pushes of an operation by default: a robot that is being tuned is nudged, and not knocked over."""


@dataclass(frozen=True)
class Change:
    """A change of the robot or its world at some time.

    :param minute: time of operation from which it is so, in min; it begins with the next window, from standing
    :param settings: settings of the episode that change, by name, as in a config.yaml
    """

    minute: float
    settings: Mapping[str, Any]

    def __post_init__(self) -> None:
        """Refuse values of another type, and make numbers of any type Python's own."""
        convert_fields(self, "change.")
        object.__setattr__(self, "settings", _plain(self.settings))


@dataclass(frozen=True)
class OperationConfig:
    """Settings of a robot in operation.

    It runs on in windows. Each has a time to settle after new parameters, and a time in which it is measured. After a
    fall somebody has to put the robot up, which costs time; it then stands, and steps again.

    :param robot: settings of robot, world and controller, and the pushes. Of these, force, direction and duration
        count: a push comes every ``push_seconds``. The time limit is without effect, as is the form of the reward
    :param minutes: duration of the operation, in min; the window that has begun by then is completed
    :param settle_seconds: time that a window gives new parameters to settle, in s; steps are counted anew in each
        window, so below 2 s the first ones count as slow
    :param measure_seconds: time that a window measures, in s
    :param fall_seconds: time that a fall costs, in s
    :param push_seconds: time from a push to the next, in s
    :param changes: what changes in the course of the operation, in the order of time
    :param extended_from: durations with which the operation had ended before it went on, in min, in rising order: a
        learner that looks ahead looks no further than the next of these ends
    """

    robot: PushedConfig = field(default_factory=lambda: PushedConfig(push=SOFT_PUSHES))
    minutes: Minutes = 10.0
    settle_seconds: SettleSeconds = 2.0
    measure_seconds: MeasureSeconds = 4.0
    fall_seconds: Annotated[float, Within(0.0, 3600.0, "s")] = 20.0
    push_seconds: Annotated[float, Within(0.5, 3600.0, "s")] = 4.0
    changes: tuple[Change, ...] = ()
    extended_from: tuple[Minutes, ...] = ()

    def __post_init__(self) -> None:
        """Refuse settings that cannot be simulated, also those of robots that come later."""
        check_type("changes", self.changes, tuple)
        check_type("extended_from", self.extended_from, tuple)
        if type(self.robot) is not PushedConfig:  # the file of a session holds no settings of a task
            raise ConfigurationError(f"robot must be a PushedConfig, not a {type(self.robot).__name__}")
        check_ranges("operation.", self)
        check_extended_from(self.extended_from, "minutes", self.minutes)
        for change in self.changes:
            check_type("a change", change, Change)
        minutes = [change.minute for change in self.changes]
        if not all(0.0 <= minute <= self.minutes for minute in minutes):
            raise ConfigurationError(f"changes must be between 0 and {self.minutes:g} min, not {shortened(minutes)}")
        if minutes != sorted(minutes):
            raise ConfigurationError(f"changes must be in the order of time, not {shortened(minutes)}")
        for change in self.changes:
            check_effect(change.settings, "its change")
        for count in range(len(minutes) + 1):
            robot = self.robot_after(count)
            if robot.dimensions:
                describe_robot(robot.dimensions)
            if robot.push.duration > self.push_seconds:
                raise ConfigurationError(
                    f"push.duration must be at most the {self.push_seconds:g} s to the next push, "
                    f"not {robot.push.duration!r}"
                )
            if robot.terrain.roughness != (0.0, 0.0):
                reach = robot.terrain.reach
                raise ConfigurationError(
                    f"terrain.roughness must be 0 in an operation: bumps end {reach:g} m from the start"
                )

    @property
    def stages(self) -> tuple[float, ...]:
        """Durations at which the operation ends, or has ended before it was extended, in min."""
        return (*self.extended_from, self.minutes)

    def stages_over(self, seconds: float) -> int:
        """Number of stages that are over at a time.

        :param seconds: time of operation, in s
        """
        return sum(seconds >= round(60.0 * minutes, 9) for minutes in self.stages)

    def extended_to(self, minutes: float) -> OperationConfig:
        """The operation with a longer duration: it goes on from where it ended.

        :param minutes: the longer duration, what is over included, in min
        """
        return dataclasses.replace(self, minutes=minutes, extended_from=self.stages)

    def robot_after(self, changes: int) -> PushedConfig:
        """Settings of robot and world after some of the changes.

        :param changes: number of changes that have been made
        """
        merged: PushedConfig = functools.reduce(
            changed_alone, [change.settings for change in self.changes[:changes]], self.robot
        )
        return merged

    def changes_by(self, seconds: float) -> int:
        """Number of changes that have been made by a time.

        :param seconds: time of operation, in s
        """
        return sum(round(60.0 * change.minute, 9) <= seconds for change in self.changes)


def check_effect(settings: Any, what: str = "it") -> None:
    """Refuse settings of an episode that an operation does not know.

    :param settings: settings by name; what is no mapping names none
    :param what: what a user is to leave out
    :raises ConfigurationError: naming the setting
    """
    for name in WITHOUT_EFFECT:
        if isinstance(settings, Mapping) and _has(settings, name):
            raise ConfigurationError(f"{name} has no effect in an operation: leave {what} out")


def _has(settings: Mapping[str, Any], name: str) -> bool:
    """Whether settings by name have one whose name has dots where settings lie within others."""
    outer, _, inner = name.partition(".")
    value = settings.get(outer)
    return _has(value, inner) if inner and isinstance(value, Mapping) else outer in settings and not inner


def _plain(value: Any) -> Any:
    """Settings by name as a file could give them, whatever type their numbers are of."""
    value = plain(value)
    if isinstance(value, Mapping):
        return {plain(name): _plain(item) for name, item in value.items()}
    return [_plain(item) for item in value] if isinstance(value, (list, tuple)) else value


def controller_parameters(parameters: Parameters) -> tuple[SteppingParameters, BalanceParameters]:
    """P1 to P5 and V1 to V4 of the nine parameters.

    :param parameters: values of all nine
    """
    count = len(STEPPING_PARAMETERS)
    return SteppingParameters(*parameters[:count]), BalanceParameters(*parameters[count:])
