"""The end of an episode: the paper's three criteria, a fall, and a simulation that diverges."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

from sarah.episode.robot_settings import RobotSettings
from sarah.episode.tick import Tick
from sarah.robot.scale import Sized

OSCILLATION_SECONDS = 5.0
"""Simulated time by which the robot must oscillate, in s; the paper's third criterion."""
OSCILLATION_STEPS = 2
"""Number of steps that make an oscillation: one with each leg."""
LEAST_UPRIGHT = math.cos(math.radians(45.0))
"""Cosine of the torso's tilt from gravity's vertical beyond which the robot has fallen."""
LONGEST_ENDING = 40
"""Longest name of a way in which an episode ends, in characters."""
TERMINATIONS = {
    "time_limit": "ran to the end",
    "left_box": "left its place",
    "no_oscillation": "did not step",
    "fell": "fell",
    "diverged": "diverged",
}
"""Ways in which an episode can end, with the words of the pages for each: the paper's three criteria, a tilt beyond 45
degrees, and a state or signal that is not finite or far beyond what a robot can have. A task can add its own."""


@dataclass(frozen=True)
class EndingSettings(RobotSettings):
    """Settings of the end of an episode, beside its time limit.

    :param box_half_width: displacement along any axis at which an episode ends, in m; the paper's second criterion
    """

    box_half_width: Annotated[float, Sized(0.001, 100.0, "m", usual=0.25)] = None  # type: ignore[assignment]


def is_fallen(upright: float) -> bool:
    """Whether a robot is tilted as far as one that has fallen, in episodes and in operation alike.

    :param upright: cosine of the torso's tilt
    """
    return upright < LEAST_UPRIGHT


def paper_ending(tick: Tick, config: EndingSettings) -> str | None:
    """Check the paper's second and third criterion, and whether the robot has fallen: the endings of both its tasks.

    :param tick: what is known at the end of a control tick
    :param config: settings of the episode
    :return: one of :data:`TERMINATIONS`; ``None`` if the episode goes on
    """
    (x, y, z), (start_x, start_y, start_z) = tick.torso.position, tick.start
    if max(abs(x - start_x), abs(y - start_y), abs(z - start_z)) > config.box_half_width:
        return "left_box"
    if is_fallen(tick.upright):
        return "fell"
    half_tick = config.physics.control_dt / 2  # the tolerance for rounding
    if tick.steps < OSCILLATION_STEPS and tick.time > OSCILLATION_SECONDS - half_tick:
        return "no_oscillation"
    return None


def is_ending(termination: object) -> bool:
    """Whether something can name the way in which an episode ended: a short identifier.

    :param termination: name to check, of any type
    """
    return isinstance(termination, str) and termination.isidentifier() and len(termination) <= LONGEST_ENDING


def ending_words(termination: str) -> str:
    """Words for the way in which an episode ended: those of the table, or the name that a task of your own gave.

    :param termination: name of the ending
    """
    return TERMINATIONS.get(termination, termination.replace("_", " "))
