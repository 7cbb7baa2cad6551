"""The push: its ranges, the settings that have it, and one episode's draw."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass
from typing import Annotated

from sarah.control.pattern_generator import STAND_SECONDS
from sarah.episode.robot_settings import LONGEST_EPISODE
from sarah.episode.settings import EpisodeConfig
from sarah.errors import ConfigurationError
from sarah.number import is_finite, plain, to_floats
from sarah.ranges import Range, Within, check_ranges
from sarah.robot.reading import Vector
from sarah.robot.scale import Sized

PUSH_SHOWN_SECONDS = 0.6
"""Shortest time for which pictures show a push, in s: most are over before a viewer has noticed them."""
DIRECTIONS = (
    "to its right",
    "right and forward",
    "forward",
    "left and forward",
    "to its left",
    "left and backward",
    "backward",
    "right and backward",
)
SAGITTAL_DEGREES = 30.0
"""Largest angle between a sagittal push and the robot's forward or backward direction, in degrees."""


@dataclass(frozen=True)
class Push:
    """The push, drawn for each episode from its seed. One number for a range, or equal ends, fix the value.

    It acts horizontally on the torso's centre, with constant force.

    :param newtons: uniform range of the force, in N; the paper pushed its robot of 30 kg with up to 100 N
    :param degrees: uniform range of the direction, in degrees: 0 pushes to the robot's right, 90 forward
    :param at_seconds: uniform range of the simulated time at which the push begins, in s; the paper pushed after the
        first second
    :param duration: duration of the push, in s
    :param sagittal_share: share of the pushes that point within 30 degrees of forward or backward, half of them each
        way, instead of anywhere in the range of directions
    """

    newtons: Annotated[Range, Sized(0.0, 10_000.0, "N")] = Range((0.0, 100.0))
    degrees: Annotated[Range, Within(0.0, 720.0, "degrees")] = Range((0.0, 360.0))
    at_seconds: Annotated[Range, Within(STAND_SECONDS, LONGEST_EPISODE, "s")] = Range((1.0, 4.0))
    duration: Annotated[float, Sized(0.0, 10.0, "s")] = 0.15
    sagittal_share: Annotated[float, Within(0.0, 1.0)] = 0.0

    def __post_init__(self) -> None:
        """Refuse impossible pushes, and pushes that begin while the robot stands."""
        check_ranges("push.", self)


NO_PUSH = Push(newtons=(0.0, 0.0))
"""Push without force, where a task has none."""


@dataclass(frozen=True)
class DrawnPush:
    """One episode's push.

    :param force: force on the torso's centre, in the world's frame, in N
    :param begin: simulated time at which it begins, in s
    :param duration: duration, in s
    """

    force: Vector
    begin: float
    duration: float

    def __post_init__(self) -> None:
        """Refuse a push that is no number, and make floats of numbers of any type."""
        force = plain(self.force)
        is_vector = isinstance(force, (list, tuple)) and len(force) == 3
        if not is_vector or not all(map(is_finite, (*force, self.begin, self.duration))):
            raise ConfigurationError(
                f"a push must consist of finite numbers, three of them its force, not {self!r:.200}"
            )
        object.__setattr__(self, "force", tuple(float(plain(newtons)) for newtons in force))
        to_floats(self, "begin", "duration")


def push_words(force: Vector) -> tuple[str, str]:
    """A push in words: its force, and its direction as the robot has it.

    :param force: force of the push, in N
    """
    x, y, z = force
    newtons = math.hypot(x, y, z)
    direction = DIRECTIONS[round(math.atan2(y, x) / (math.tau / len(DIRECTIONS))) % len(DIRECTIONS)]
    if abs(z) > math.hypot(x, y):
        direction = "upward" if z > 0.0 else "downward"
    number = f"{newtons:.0f}" if newtons >= 10.0 else f"{newtons:.2g}"
    return f"push of {number} N", direction


def draw_push(ranges: Push, seed: int) -> DrawnPush:
    """Draw one episode's push, independently of its conditions.

    :param ranges: ranges to draw from
    :param seed: seed of the episode; the same seed draws the same direction and time at any force
    """
    generator = random.Random(f"push {seed}")
    newtons = generator.uniform(*ranges.newtons)
    degrees = generator.uniform(*ranges.degrees)
    begin = generator.uniform(*ranges.at_seconds)
    if generator.random() < ranges.sagittal_share:
        forward_or_backward = 90.0 if generator.random() < 0.5 else 270.0
        degrees = forward_or_backward + generator.uniform(-SAGITTAL_DEGREES, SAGITTAL_DEGREES)
    direction = math.radians(degrees)
    return DrawnPush((newtons * math.cos(direction), newtons * math.sin(direction), 0.0), begin, ranges.duration)


@dataclass(frozen=True)
class PushedConfig(EpisodeConfig):
    """Settings that all episodes of an experiment share when the robot is pushed.

    :param push: ranges that each episode's push is drawn from; by default those for the robot's size
    """

    push: Push = None  # type: ignore[assignment]  # that of the robot's size

    def __post_init__(self) -> None:
        """Refuse settings that cannot be simulated, and a push shorter than a control tick."""
        super().__post_init__()
        if self.push.duration < self.physics.control_dt:
            tick = f"a control tick, {self.physics.control_dt:g} s"
            raise ConfigurationError(f"push.duration must be at least {tick}, not {self.push.duration!r}")

    def check_for_training(self) -> None:
        """Refuse a push that begins after the end of every episode."""
        begin, limit = self.push.at_seconds, self.time_limit
        if begin[0] >= limit:
            raise ConfigurationError(
                f"episode.push.at_seconds must begin before the time_limit of {limit:g} s, not {begin!r}"
            )


def push_of_settings(config: EpisodeConfig, seed: int) -> DrawnPush | None:
    """Draw the push of an episode, if its settings have one.

    :param config: settings of the episode
    :param seed: seed of the episode
    """
    return draw_push(config.push, seed) if isinstance(config, PushedConfig) else None
