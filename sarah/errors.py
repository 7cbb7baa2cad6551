"""The exceptions a user can meet, and the nearest valid name they are told."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches


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


def unknown_name(kind: str, name: str, allowed: Iterable[str]) -> str:
    """Say that a name is unknown, which one was probably meant, and which there are.

    :param kind: what the name stands for, such as ``"task"``
    :param name: the name that was given
    :param allowed: the valid names
    :return: one line for an exception's message
    """
    names = sorted(allowed)
    nearest = get_close_matches(name, names, n=1, cutoff=0.5)
    guess = f", did you mean {nearest[0]!r}?" if nearest else ""
    return f"unknown {kind} {name!r}{guess} (allowed: {', '.join(names)})"
