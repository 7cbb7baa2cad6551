"""The end of an episode: the paper's three criteria, a fall, and a simulation that diverges."""

from __future__ import annotations

import math

from sarah.robot.reading import Vector
from sarah.simulation.simulator import TorsoState

BOX_HALF_WIDTH = 0.25
"""Displacement of the torso along any axis at which an episode ends, in m; the paper's second criterion."""
OSCILLATION_SECONDS = 5.0
"""Simulated time by which the robot must oscillate, in s; the paper's third criterion."""
OSCILLATION_STEPS = 2
"""Number of steps that make an oscillation: one with each leg."""
LEAST_UPRIGHT = math.cos(math.radians(45.0))
"""Cosine of the torso's tilt beyond which the robot has fallen."""
TERMINATIONS = {
    "time_limit": "ran to the end",
    "left_box": "left its place",
    "no_oscillation": "did not step",
    "fell": "fell",
    "diverged": "diverged",
}
"""Ways in which an episode can end, with the words of the pages for each: the paper's three criteria, a tilt beyond 45
degrees, and a state or signal that is not finite or far beyond what a robot can have."""


def termination(
    torso: TorsoState, start: Vector, steps: int, time: float, time_limit: float, control_dt: float
) -> str | None:
    """Check whether an episode ends, and how.

    :param torso: state of the torso
    :param start: position of the torso's centre when the episode began, in m
    :param steps: number of completed steps
    :param time: simulated time, in s
    :param time_limit: time limit of the episode, in s
    :param control_dt: duration of a control tick, in s; half of it is the tolerance for rounding
    :return: one of :data:`TERMINATIONS`; ``None`` if the episode goes on
    """
    if not torso.is_finite:
        return "diverged"
    (x, y, z), (start_x, start_y, start_z) = torso.position, start
    if max(abs(x - start_x), abs(y - start_y), abs(z - start_z)) > BOX_HALF_WIDTH:
        return "left_box"
    if torso.upright < LEAST_UPRIGHT:
        return "fell"
    half_tick = control_dt / 2
    if steps < OSCILLATION_STEPS and time > OSCILLATION_SECONDS - half_tick:
        return "no_oscillation"
    return "time_limit" if time > time_limit - half_tick else None
