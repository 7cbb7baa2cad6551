"""The exceptions a user can meet, and the nearest valid name they are told."""

from __future__ import annotations

import reprlib
from collections.abc import Iterable, Mapping
from difflib import get_close_matches

LONGEST_NAME = 100
"""For which a nearest one is looked for."""


class SarahError(Exception):
    """Root of the package's exceptions; its message is one line that a command prints as it is."""


class DescriptionError(SarahError, ValueError):
    """The robot's dimensions or its URDF are not those of a robot that can be simulated."""


class ConfigurationError(SarahError, ValueError):
    """A setting, name or value is not allowed."""


class RunFolderError(SarahError, OSError):
    """A run folder is missing, not empty, or does not hold what it should."""


class SimulationError(SarahError, RuntimeError):
    """The physics engine cannot do what is asked of it."""


class WorkersError(SarahError, RuntimeError):
    """Workers that were asked for cannot be reached, or die again and again."""


class LearningError(SarahError, RuntimeError):
    """What learns no longer returns numbers."""


class TrainingInterruptedError(SarahError):
    """A training was asked to stop, and has; it can be resumed."""


def check_range(key: str, value: float | tuple[float, float], low: float, high: float, unit: str = "") -> None:
    """Refuse what is out of a range.

    :param key: what the value is of
    :param value: a number, or the two ends of a range, which must be in rising order
    :param low: smallest that is allowed
    :param high: largest that is allowed
    :param unit: of all of them
    :raises ConfigurationError: naming key, value and range
    """
    first, last = value if isinstance(value, tuple) else (value, value)
    if not low <= first <= last <= high:
        order = " and in rising order" if isinstance(value, tuple) else ""
        raise ConfigurationError(
            f"{key} must be between {low:g} and {high:g}{unit and f' {unit}'}{order}, not {shortened(value)}"
        )


def check_fields(key: str, config: object, plausible: Mapping[str, tuple[float, float, str]]) -> None:
    """Refuse a configuration one of whose fields is out of its range.

    :param key: what the names of the fields begin with
    :param config: the configuration
    :param plausible: lowest and highest value and unit of the fields, by name
    :raises ConfigurationError: naming key, value and range
    """
    for name, (low, high, unit) in plausible.items():
        check_range(f"{key}.{name}", getattr(config, name), low, high, unit)


def shortened(value: object) -> str:
    """A value as a message shows it: in one line that is not too long.

    :param value: of any kind
    """
    return reprlib.repr(value)


def unknown_name(kind: str, name: str, allowed: Iterable[str]) -> str:
    """Say that a name is unknown, which one was probably meant, and which there are.

    :param kind: what the name stands for, such as ``"task"``
    :param name: the name that was given
    :param allowed: the valid names
    :return: one line for an exception's message
    """
    names = sorted(allowed)
    nearest = get_close_matches(name, names, n=1, cutoff=0.5) if len(name) < LONGEST_NAME else []
    guess = f", did you mean {nearest[0]!r}?" if nearest else ""
    return f"unknown {kind} {shortened(name)}{guess} (allowed: {', '.join(names) or 'none'})"
