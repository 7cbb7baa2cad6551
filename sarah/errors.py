"""Exceptions that a user can meet, and messages that name the nearest valid name."""

from __future__ import annotations

import re
import reprlib
from collections.abc import Iterable, Sequence
from difflib import SequenceMatcher
from itertools import pairwise
from typing import Any

from sarah.number import is_number, plain

LONGEST_NAME = 100
"""Length in characters up to which a name is shown whole, and the nearest valid one is looked for."""
LEAST_LIKENESS = 0.5
"""Smallest ratio of :class:`difflib.SequenceMatcher` at which a name is near to another one."""
SHORTEST_PART = 4
"""Length in letters from which a word that is a part of another one counts as the same, as ``foot`` in ``forefoot``."""


class SarahError(Exception):
    """Root of the package's exceptions; its message is one line that a command prints as it is."""


class DescriptionError(SarahError, ValueError):
    """The robot's dimensions or its URDF do not describe SARAH."""


class ConfigurationError(SarahError, ValueError):
    """A setting, name or value is not allowed."""


class TaskError(ConfigurationError):
    """A task's file, or a function of a task, has a mistake."""


class RunFolderError(SarahError, OSError):
    """A run folder is missing, not empty, or lacks a file that it should have."""


class ResumeError(RunFolderError):
    """A training cannot be resumed: it would not go on exactly, or another process runs it."""


class SimulationError(SarahError, RuntimeError):
    """An episode cannot be simulated, or has no usable result."""


class WorkersError(SarahError, RuntimeError):
    """Workers cannot be reached, or they die again and again."""


class RobotError(SarahError, ConnectionError):
    """A robot cannot be reached or listened for, or it does not answer."""


class LearningError(SarahError, RuntimeError):
    """A learning algorithm does not return finite numbers."""


class TrainingInterruptedError(SarahError):
    """A training or a session was stopped before its end; it can be resumed."""


def check_range(key: str, value: Any, low: float, high: float, unit: str = "") -> Any:
    """Refuse a number outside its range.

    :param key: name of the setting, as the user gives it
    :param value: number of any type
    :param low: smallest allowed value
    :param high: largest allowed value
    :param unit: unit of the value and of its limits
    :return: the value, as a number of Python's own
    :raises ConfigurationError: naming key, value and range
    """
    value = plain(value)
    if not is_number(value) or not low <= value <= high:
        raise ConfigurationError(f"{key} must be {_span(low, high, unit)}, not {shortened(value)}")
    return value


def check_whole(key: str, value: Any, low: float, high: float, unit: str = "") -> int:
    """Refuse what is not a whole number within a range.

    :param key: name of the setting, as the user gives it
    :param value: number of any type
    :param low: smallest allowed value
    :param high: largest allowed value
    :param unit: unit of the value and of its limits
    :return: the value, as a number of Python's own
    :raises ConfigurationError: naming key, value and range
    """
    value = plain(value)
    if is_number(value) and not isinstance(value, int):
        raise ConfigurationError(f"{key} must be a whole number, not {shortened(value)}")
    return int(check_range(key, value, low, high, unit))


def check_ends(key: str, ends: Any, low: float, high: float, unit: str = "") -> tuple[float, float]:
    """Refuse a range that is not within another one.

    :param key: name of the setting, as the user gives it
    :param ends: lowest and highest value, which must be in rising order
    :param low: smallest allowed value
    :param high: largest allowed value
    :param unit: unit of the values and of their limits
    :return: both ends
    :raises ConfigurationError: naming key, value and range
    """
    given = plain(ends)
    given = tuple(map(plain, given)) if isinstance(given, (list, tuple)) else given
    if not isinstance(given, tuple) or len(given) != 2 or given[0] == given[1]:
        value = given[0] if isinstance(given, tuple) and len(given) == 2 else given
        number = float(check_range(key, value, low, high, unit))
        return number, number
    if not all(map(is_number, given)) or not low <= given[0] <= given[1] <= high:
        raise ConfigurationError(f"{key} must be {_span(low, high, unit)} and in rising order, not {shortened(given)}")
    return float(given[0]), float(given[1])


def check_extended_from(earlier: Sequence[float], name: str, budget: float) -> None:
    """Refuse budgets of before an extension that are not in rising order and below the present one.

    :param earlier: budgets with which a training or a session had ended before it went on
    :param name: name of the budget's setting
    :param budget: its present value
    :raises ConfigurationError: naming what was given
    """
    if not all(before < after for before, after in pairwise((0, *earlier, budget))):
        raise ConfigurationError(f"extended_from must be in rising order and below {name}, not {shortened(earlier)}")


def _span(low: float, high: float, unit: str) -> str:
    return f"between {low:.10g} and {high:.10g}{unit and f' {unit}'}"


def check_type(key: str, value: object, expected: type) -> None:
    """Refuse a value of another type.

    :param key: name of the argument
    :param value: value that was given
    :param expected: type that it must have
    :raises ConfigurationError: naming argument, type and value
    """
    if not isinstance(value, expected):
        raise ConfigurationError(f"{key} must be a {expected.__name__}, not {shortened(value)}")


def one_line(error: BaseException) -> str:
    """What an exception says, on one line that begins with its type.

    :param error: exception of any type
    """
    words = " ".join(str(error).split())
    return f"{type(error).__name__}: {words}" if words else type(error).__name__


def shortened(value: object) -> str:
    """Representation of a value on one short line, for a message.

    :param value: value of any type
    """
    return reprlib.repr(value)


def unknown_name(kind: str, name: str, allowed: Iterable[str]) -> str:
    """Message that a name is unknown, with the nearest valid name and all valid names.

    :param kind: kind of thing that the name stands for, such as ``"task"``
    :param name: name that was given
    :param allowed: valid names
    :return: one line for an exception's message
    """
    names = sorted(allowed)
    if len(name) > LONGEST_NAME:
        return f"unknown {kind} {shortened(name)} (allowed: {', '.join(names) or 'none'})"
    nearest = _nearest(name, names)
    guess = f", did you mean {nearest!r}?" if nearest else ""
    return f"unknown {kind} {name!r}{guess} (allowed: {', '.join(names) or 'none'})"


def _nearest(name: str, allowed: Iterable[str]) -> str | None:
    """Name that is alike; of several the one that shares a word, the first above all, and then the one most alike."""
    words = _words(name)
    likeness = {one: SequenceMatcher(None, one.lower(), name.lower()).ratio() for one in allowed}

    def shared(candidate: str) -> list[bool]:
        others = _words(candidate)
        return [any(_is_same(word, other) for other in others) for word in words]

    alike = (one for one in likeness if likeness[one] >= LEAST_LIKENESS)
    return max(alike, key=lambda one: (shared(one), likeness[one]), default=None)


def _words(name: str) -> list[str]:
    return re.findall(r"[^\W_]+", name.lower())


def _is_same(word: str, other: str) -> bool:
    """Whether words are the same, or one of them is a part of the other and not too short."""
    shorter, longer = sorted((word, other), key=len)
    return word == other or (len(shorter) >= SHORTEST_PART and shorter in longer)
