"""Filters that run once per control tick, on plain floats."""

from __future__ import annotations

import math

from sarah.errors import ConfigurationError


class LowPass:
    """First-order low-pass filter.

    :param time_constant: time constant, in s
    :param dt: control period, in s
    """

    def __init__(self, time_constant: float, dt: float) -> None:
        self.value = 0.0
        self._gain = low_pass_gain(time_constant, dt)

    def __call__(self, sample: float) -> float:
        """Filter one sample, and return the filtered value."""
        self.value += self._gain * (sample - self.value)
        return self.value


def low_pass_gain(time_constant: float, dt: float) -> float:
    """Share of the way to a constant signal that a first-order low-pass covers in one tick.

    :param time_constant: time constant, in s
    :param dt: control period, in s
    :raises ConfigurationError: if the period is not finite and above zero
    """
    if not 0.0 < dt < math.inf:
        raise ConfigurationError(f"dt must be finite and above zero, not {dt!r}")
    return 1.0 - math.exp(-dt / time_constant)


def clipped(value: float, limit: float) -> float:
    """Clip a value to [-limit, limit].

    :param value: value to clip
    :param limit: largest magnitude, not negative
    """
    if value < -limit:
        return -limit
    return value if value < limit else limit


def ramped(now: float, goal: float, largest_change: float) -> float:
    """Move a value towards its goal, by the largest change of one tick at most.

    :param now: present value
    :param goal: value to move to
    :param largest_change: largest change in one tick, not negative
    """
    change = goal - now
    if change > largest_change:
        return now + largest_change
    return goal if change >= -largest_change else now - largest_change
