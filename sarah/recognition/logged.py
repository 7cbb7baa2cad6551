"""What logs say of robots, checked value by value, whoever wrote it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple

from sarah.errors import ConfigurationError, shortened
from sarah.files import is_text
from sarah.number import number, plain
from sarah.operation.settings import BOX, Parameters
from sarah.operation.window import FELT
from sarah.recognition.recognition import LONGEST_NAME, Conditions
from sarah.robot.scale import Scale

LARGEST_VALUE = 1e6
"""Largest number in a log, by amount."""
LOWEST_REWARD, HIGHEST_REWARD = -0.01, 1.5
"""Range of observed rewards; 1 is the best that a robot can do."""
LONGEST_ROBOT = LONGEST_NAME // 2
"""Largest number of characters in the name of a robot or a kind, to which its change is added."""
FALLS = {"0": False, "1": True, "false": False, "true": True}
"""What tells whether a robot fell, in small letters."""


class LoggedWindow(NamedTuple):
    """A window of a log: all that a robot knows of it.

    :param parameters: P1 to P5 and V1 to V4
    :param reward: observed reward
    :param fell: whether the robot fell
    :param felt: what the robot felt, in the order of :data:`~sarah.operation.window.FELT`
    """

    parameters: Parameters
    reward: float
    fell: bool
    felt: tuple[float, ...]


@dataclass(frozen=True)
class LoggedRobot:
    """What logs say of a robot from one change to the next.

    :param name: name of the robot
    :param kind: name of its kind, which robots have in common that differ only in what chance draws
    :param conditions: conditions of the windows
    :param scale: size of the robot
    :param windows: its windows
    """

    name: str
    kind: str
    conditions: Conditions
    scale: Scale
    windows: tuple[LoggedWindow, ...]


def logged_robots(
    path: Path, rows: Sequence[Mapping[str, Any]], name: str, kind: str, conditions: Conditions, scale: Scale
) -> list[LoggedRobot]:
    """Robots of rows that one robot wrote. Once it is changed, it is another one, of a kind of its own.

    :param path: path of the log, which errors name
    :param rows: values of its windows by name, as texts or of their own types
    :param name: name of the robot
    :param kind: name of its kind
    :param conditions: conditions of the windows
    :param scale: size of the robot
    :raises ConfigurationError: naming the log and what is wrong in it
    """
    check_names(path, name, kind)
    return [
        LoggedRobot(
            f"{name}{change}", f"{kind}{change}", conditions, scale, tuple(logged_window(path, row) for row in its)
        )
        for changes, its in groupby(rows, lambda row: _changes(path, row))
        for change in [f", change {changes}" if changes else ""]
    ]


def check_names(path: Path, *names: str) -> None:
    """Refuse names that no table can show.

    :param path: path of the log, which errors name
    :param names: names of robots and kinds
    :raises ConfigurationError: naming the log and the name
    """
    for name in names:
        if not is_text(name) or len(name) > LONGEST_ROBOT:
            raise ConfigurationError(
                f"{path} names a robot {shortened(name)}: a name is one line of {LONGEST_ROBOT} characters"
            )


def logged_window(path: Path, row: Mapping[str, Any]) -> LoggedWindow:
    """A window of a log.

    :param path: path of the log, which errors name
    :param row: values by name, as texts or of their own types
    :raises ConfigurationError: naming the log and what is wrong in it
    """
    values = [number_of(path, row, name) for name in BOX.names]
    try:
        parameters = BOX.checked(values)
    except ConfigurationError as error:
        raise ConfigurationError(f"{path}: {error}") from error
    reward = number_of(path, row, "observed_reward")
    if not LOWEST_REWARD <= reward <= HIGHEST_REWARD:
        raise ConfigurationError(f"{path}: observed_reward must be between 0 and 1, not {reward:g}")
    fell = FALLS.get(str(_value(path, row, "fell")).lower())
    if fell is None:
        raise ConfigurationError(f"{path}: fell must be 0 or 1, not {shortened(row['fell'])}")
    return LoggedWindow(parameters, reward, fell, tuple(number_of(path, row, name) for name in FELT))


def number_of(path: Path, row: Mapping[str, Any], name: str) -> float:
    """A number of a window.

    :param path: path of the log, which errors name
    :param row: values by name, as texts or of their own types
    :param name: name of the number
    :raises ConfigurationError: naming the log and what is wrong
    """
    value = plain(_value(path, row, name))
    try:
        read = float(value) if isinstance(value, (int, float)) else number(str(value))
    except (ValueError, OverflowError) as error:
        raise ConfigurationError(f"{path}: {name} {error}") from error
    if not abs(read) <= LARGEST_VALUE:
        raise ConfigurationError(f"{path}: {name} must be at most {LARGEST_VALUE:g} by amount, not {read:g}")
    return read


def _value(path: Path, row: Mapping[str, Any], name: str) -> Any:
    value = row.get(name)
    if value is None:
        raise ConfigurationError(
            f"{path} has a window without {name}: the columns are those of a session's windows.csv"
        )
    return value


def _changes(path: Path, row: Mapping[str, Any]) -> int:
    """Number of changes before a window; none where nobody counted them."""
    changes = number_of(path, row, "changes") if row.get("changes") else 0.0
    if changes < 0.0 or changes % 1.0:
        raise ConfigurationError(f"{path}: changes must be a whole number from 0 on, not {changes:g}")
    return int(changes)
