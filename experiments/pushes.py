"""Pushed episodes of the shipped parameters, which all pages push and judge at the same times."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.push import Push
from sarah.episode.tasks import BALANCE, BalanceConfig

PUSHED_AT = (2.0, 3.0)
"""Range of the simulated times at which pushes begin, in s."""
TIME_LIMIT = 8.0
"""Time limit of the episodes, in s: a robot that reaches it has survived, at least 4.85 s after its push."""
SHIPPED = PARAMETER_SETS["balance"].spec
CONTROLLERS: Mapping[str, tuple[float, ...]] = {"shipped V": SHIPPED.parameters, "V = 0": (0.0,) * 4}
"""Values of V1 to V4 by name. P1 to P5 are the shipped ones in either case."""
SETTINGS = (
    "P1 to P5 are the shipped ones, pushes of 0.15 s begin at 2 to 3 s, and a robot that reaches 8 s has survived"
)
"""What the caption of a table with pushes says."""


def pushed(newtons: float, **changes: Any) -> BalanceConfig:
    """Settings of episodes with pushes from anywhere.

    :param newtons: force of the pushes, in N; 0 for none
    :param changes: other settings, by name
    """
    push = Push((newtons, newtons), at_seconds=PUSHED_AT)
    return BALANCE.config_of(SHIPPED.config, **{"time_limit": TIME_LIMIT, **changes}, push=push)
