"""The push of the balance task: its ranges, and one episode's draw."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass

from sarah.control.pattern_generator import STAND_SECONDS
from sarah.episode.settings import LONGEST_EPISODE
from sarah.errors import check_fields
from sarah.robot.reading import Vector

PLAUSIBLE = {
    "newtons": (0.0, 10_000.0, "N"),
    "degrees": (0.0, 720.0, "degrees"),
    "at_seconds": (STAND_SECONDS, LONGEST_EPISODE, "s"),
    "duration": (0.0, 10.0, "s"),
}
"""Lowest and highest value that a push can have, and its unit. Beyond, somebody has mistaken the unit."""


@dataclass(frozen=True)
class Push:
    """The push of the balance task, drawn for each episode from its seed. Equal ends of a range fix the value.

    It acts on the torso's centre, horizontally and with constant force.

    :param newtons: uniform range of the force, in N; the paper's is up to 100 N
    :param degrees: uniform range of the direction: 0 pushes to the robot's right, 90 forward
    :param at_seconds: uniform range of when it begins; the paper's is after the first second
    :param duration: in s
    """

    newtons: tuple[float, float] = (0.0, 100.0)
    degrees: tuple[float, float] = (0.0, 360.0)
    at_seconds: tuple[float, float] = (1.0, 4.0)
    duration: float = 0.15

    def __post_init__(self) -> None:
        """Refuse what is no push, or comes while the robot is still held to be standing."""
        check_fields("push", self, PLAUSIBLE)


@dataclass(frozen=True)
class DrawnPush:
    """One episode's push.

    :param force: on the torso's centre, in the world's frame, in N
    :param begin: simulated time at which it begins, in s
    :param duration: in s
    """

    force: Vector
    begin: float
    duration: float


def draw_push(ranges: Push, seed: int) -> DrawnPush:
    """Draw one episode's push, independently of its conditions.

    :param ranges: what to draw from
    :param seed: of the episode; the same seed draws the same direction and time at any force
    """
    generator = random.Random(f"push {seed}")
    newtons = generator.uniform(*ranges.newtons)
    direction = math.radians(generator.uniform(*ranges.degrees))
    begin = generator.uniform(*ranges.at_seconds)
    return DrawnPush((newtons * math.cos(direction), newtons * math.sin(direction), 0.0), begin, ranges.duration)
