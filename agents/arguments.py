"""Checks of arguments, which refuse a bad value in one line that names the argument, the value and what is allowed."""

import re
import reprlib
import sys
from functools import partial
from numbers import Integral, Real
from typing import Any, TypeAlias

import numpy as np
from gymnasium import spaces
from stable_baselines3.common.type_aliases import Schedule
from stable_baselines3.common.utils import ConstantSchedule, FloatSchedule, LinearSchedule

Deviations: TypeAlias = float | str | list[float] | np.ndarray | Schedule
"""Number, linear schedule by its text, array or schedule."""
LINEAR = re.compile(r"lin_(\d*\.?\d+(e[+-]?\d+)?)")
"""Text of RL Zoo for a linear schedule."""


def checked_number(
    name: str,
    value: Any,
    lowest: float,
    highest: float = sys.float_info.max,
    above: bool = False,
    whole: bool = False,
) -> Any:
    """
    Refuse what is no number in a range, and make one of Python's own of any other, such as NumPy's.

    :param name: Name of the argument
    :param value: Its value
    :param lowest: Lowest value
    :param highest: Highest value; by default any finite one
    :param above: Whether the lowest value itself is too low
    :param whole: Whether only whole numbers are allowed
    :return: The number
    """
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    is_number = isinstance(value, Integral if whole else Real) and not isinstance(value, bool)
    if is_number and lowest <= value <= highest and not (above and value == lowest):
        return int(value) if isinstance(value, Integral) else float(value)
    ends = f"{'above' if above else 'from'} {lowest:g}" + (f" to {highest:g}" if highest < sys.float_info.max else "")
    raise ValueError(f"{name} must be a {'whole ' if whole else ''}number {ends}, not {value!r}")


def checked_disturbances(values: Any, number: int | None) -> np.ndarray:
    """
    Refuse disturbances of an episode that are not finite, or more or fewer than those of others.

    :param values: A list, tuple or array of numbers
    :param number: Number of those of the episodes before; ``None`` for the first episode
    :return: The numbers, of shape (number,)
    """
    try:
        numbers = np.array(values, dtype=float)
        values = numbers.tolist()
    except (ValueError, TypeError, OverflowError):
        numbers = np.array(np.nan)
    is_list = numbers.ndim == 1 and number in (None, len(numbers))
    if not is_list or not np.isfinite(numbers).all():
        allowed = "finite numbers" if number is None else f"finite numbers as in the episodes before, {number} of them"
        raise ValueError(f'info["disturbances"] must be a list of {allowed}, not {reprlib.repr(values)}')
    return numbers


def checked_schedule(
    name: str,
    value: Deviations,
    lowest: float,
    highest: float = sys.float_info.max,
    shape: tuple[int, ...] = (),
) -> Schedule:
    """
    Make a schedule, and refuse a number out of its range, or a schedule that begins or ends out of it.

    :param name: Name of the argument
    :param value: A number, a function of the current progress remaining (from 1 to 0), or text such as ``"lin_0.3"``,
        which goes down to 0 as in RL Zoo
    :param lowest: Lowest value
    :param highest: Highest value; by default any finite one
    :param shape: Shape of the array that may stand in place of a number; by default none may
    :return: The schedule
    """
    if isinstance(value, str) and (linear := LINEAR.fullmatch(value)):
        value = LinearSchedule(float(linear[1]), 0.0, 1.0)
    if shape and isinstance(value, list | tuple | np.ndarray):
        if np.shape(value) != shape:
            raise ValueError(f"{name} must be one number, or as many as an action has: {shape}, not {np.shape(value)}")
        for one in np.ravel(value):
            checked_number(f"each of {name}", one, lowest, highest)
        return ConstantSchedule(np.array(value, dtype=float))  # type: ignore[arg-type]  # as many numbers
    if not callable(value):
        return FloatSchedule(float(checked_number(name, value, lowest, highest)))
    for progress_remaining in (1, 0):
        checked_number(f"{name}({progress_remaining})", value(progress_remaining), lowest, highest)
    return FloatSchedule(partial(_within, value, lowest, highest))


def _within(schedule: Schedule, lowest: float, highest: float, progress_remaining: float) -> float:
    """Value of a schedule, which keeps its end in steps beyond those asked for, and its range whatever the rounding."""
    return min(max(schedule(max(progress_remaining, 0.0)), lowest), highest)


def check_actions(space: spaces.Box) -> None:
    """
    Refuse an action space in which an action has no range or an endless one, as actions are scaled to [-1, 1].

    :param space: Action space
    """
    low, high = space.low, space.high
    if not (low < high).all():
        raise ValueError(
            f"every action must have a range, but the lowest are {low.tolist()}, the highest {high.tolist()}"
        )
    with np.errstate(over="ignore"):
        if not np.isfinite(high - low).all():
            raise ValueError(f"the range of every action must be finite, not {low.tolist()} to {high.tolist()}")
