"""Targets of a robot that stands, and the way to others at the speeds of the controller."""

from __future__ import annotations

from sarah.control.constants import ControllerConstants
from sarah.robot.filters import ramped
from sarah.robot.reading import Targets

STANDING_TARGETS: Targets = (0.0,) * 6
"""Targets of a standing robot."""


def towards(goals: Targets, targets: Targets, constants: ControllerConstants, seconds: float) -> Targets:
    """Targets that are nearer to others, by as much as the controller moves them.

    :param goals: joint targets to move to, in rad and m
    :param targets: present joint targets, in rad and m
    :param constants: constants of the controller
    :param seconds: time in which they move, in s
    """
    hip, leg = constants.hip_speed * seconds, constants.leg_speed * seconds
    (a, b, c, d, e, f), (to_a, to_b, to_c, to_d, to_e, to_f) = targets, goals
    return (
        ramped(a, to_a, hip), ramped(b, to_b, hip), ramped(c, to_c, hip), ramped(d, to_d, hip),
        ramped(e, to_e, leg), ramped(f, to_f, leg),
    )  # fmt: skip
