"""Logs that are learned from: sessions' folders, MCAP files with windows, and tables that somebody else wrote."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple

from sarah.control.pattern_generator import STAND_SECONDS
from sarah.episode.from_mapping import from_mapping
from sarah.errors import ConfigurationError, SarahError, shortened
from sarah.files import is_text, read_lines
from sarah.logs.reading import Log
from sarah.logs.topics import WINDOWS
from sarah.number import number
from sarah.operation.settings import BOX, OperationConfig, Parameters
from sarah.operation.window import FELT
from sarah.recognition.recognition import LONGEST_NAME, Conditions
from sarah.robot.dimensions import check_dimensions, scale_of
from sarah.robot.scale import Scale
from sarah.runs.config_files import settings_by_key
from sarah.runs.kinds import SESSION
from sarah.runs.session import SessionSpec
from sarah.runs.session_folder import MOST_WINDOWS, SessionFolder

MCAP, TABLE = ".mcap", ".csv"
"""Endings of the names of logs that are files."""
TIMES = ("settle_seconds", "measure_seconds")
"""Names of the times of a window."""
SLACK = 0.1
"""Time by which a window may be longer or shorter than it should be, in s."""
LARGEST_VALUE = 1e6
"""Largest number in a table, by amount."""
LOWEST_REWARD, HIGHEST_REWARD = -0.01, 1.5
"""Range of observed rewards; 1 is the best that a robot can do."""


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


def read_logs(paths: Iterable[Path]) -> list[LoggedRobot]:
    """Read logs, and put the windows of the same robot together.

    :param paths: folders of sessions, MCAP files and tables
    :return: robots in the order of the logs
    :raises ConfigurationError: naming the log, if it cannot be read, has no window, or has other conditions than the
        first one
    """
    robots: dict[str, LoggedRobot] = {}
    first: Conditions | None = None
    for path in paths:
        for robot in read_log(path):
            first = first or robot.conditions
            first.check(robot.conditions, str(path))
            known = robots.get(robot.name)
            windows = robot.windows if known is None else known.windows + robot.windows
            robots[robot.name] = replace(robot, windows=windows)
    if not robots:
        raise ConfigurationError("give at least one log: a session's folder, an MCAP file, or a table of windows")
    return list(robots.values())


def read_log(path: Path) -> list[LoggedRobot]:
    """Read a log: a robot for each time that something about it was changed.

    :param path: folder of a session, MCAP file or table
    :raises ConfigurationError: naming the log, if it cannot be read or has no window
    """
    if SESSION.owns(path):
        robots = _of_session(path)
    elif path.suffix == MCAP:
        robots = _of_mcap(path)
    elif path.suffix == TABLE:
        robots = _of_table(path)
    else:
        raise ConfigurationError(f"{path} is no log: it is neither a session's folder, nor a {MCAP} or {TABLE} file")
    if not robots:
        raise ConfigurationError(f"{path} has no windows to learn from")
    return robots


def _of_session(path: Path) -> list[LoggedRobot]:
    folder = SessionFolder.open(path)
    spec = folder.spec()
    conditions, scale = Conditions.of(spec.config), spec.config.robot.scale
    return [
        LoggedRobot(
            *_names_of(folder, spec, changes),
            conditions,
            scale,
            tuple(LoggedWindow(one.parameters, one.observed_reward, one.fell, one.felt) for one in windows),
        )
        for changes, windows in groupby(folder.windows(), lambda window: window.changes)
    ]


def _names_of(folder: SessionFolder, spec: SessionSpec, changes: int) -> tuple[str, str]:
    """Names of a session's robot and of its kind; a robot that is not simulated is of a kind of its own."""
    robot = folder.robot
    if robot is None:
        kind = kind_of(spec.config, changes)
        return _robot_of(kind, spec.seed), kind
    name = f"{robot.robot} on {robot.host}"[: LONGEST_NAME // 2]
    return name, kind_of(spec.config) if robot.has_score else name


def kind_of(config: OperationConfig, changes: int = 0) -> str:
    """Kind of a simulated robot: what differs from the default one. Its seed draws masses and errors of sensors.

    :param config: settings of its operation
    :param changes: number of changes that have been made
    """
    values, usual = settings_by_key(config.robot_after(changes)), settings_by_key(OperationConfig().robot)
    physics = ("push.", "physics.")  # what the robot is put through, and how it is simulated
    differing = [f"{key} {values[key]}" for key in values if values[key] != usual[key] and not key.startswith(physics)]
    return (", ".join(differing) or "as simulated")[: LONGEST_NAME // 2]


def facts_of(config: OperationConfig, seed: int) -> dict[str, str]:
    """Facts about a simulated robot that its log needs so that one can learn from it.

    :param config: settings of its operation
    :param seed: its seed
    """
    kind, times = kind_of(config), (repr(config.settle_seconds), repr(config.measure_seconds))
    return {"seed": str(seed), "kind": kind, "robot": _robot_of(kind, seed), **dict(zip(TIMES, times, strict=True))}


def _robot_of(kind: str, seed: int) -> str:
    return f"{kind}, seed {seed}"


def _of_mcap(path: Path) -> list[LoggedRobot]:
    log = Log(path)
    values = [log.values(message) for message in log.messages() if message.topic == WINDOWS.name]
    if not values:
        raise ConfigurationError(f"{path} has no windows to learn from: sarah-operate --log writes them")
    try:
        dimensions = check_dimensions(json.loads(log.about["dimensions"]))
        times = {key: float(log.about[key]) for key in TIMES if key in log.about}
        rate, controller = 1.0 / float(log.about["dt"]), json.loads(log.about["controller"])
        shared = from_mapping(
            Conditions(), {**times, "control_rate": round(rate, 9), "controller": controller}, "about."
        )
    except KeyError as error:
        raise ConfigurationError(f"{path} does not say its {error.args[0]}: write it anew with this version") from error
    except (SarahError, ValueError, TypeError, ZeroDivisionError, RecursionError) as error:
        raise ConfigurationError(f"{path} does not say which windows it has: {error!s:.300}") from error
    _check_durations(path, values, shared)
    rows = [{**one, **{name: one.get(f"felt_{name}") for name in FELT}} for one in values]
    name = log.about.get("robot", path.stem)
    return _robots(path, rows, name, log.about.get("kind", name), shared, scale_of(dimensions))


def _check_durations(path: Path, windows: Iterable[Mapping[str, Any]], conditions: Conditions) -> None:
    """Refuse windows that took another time than their conditions say: with standing, or without it."""
    seconds = conditions.settle_seconds + conditions.measure_seconds
    for window in windows:
        duration = window.get("duration", seconds)
        if not window["fell"] and not seconds - SLACK <= duration <= seconds + STAND_SECONDS + SLACK:
            raise ConfigurationError(f"{path} has a window of {duration:g} s, not of {seconds:g} s")


def _of_table(path: Path) -> list[LoggedRobot]:
    """Robots of a table with the columns of a session's ``windows.csv``, and perhaps one that names the robot."""
    try:
        lines = (line for line in read_lines(path, MOST_WINDOWS) if not line.startswith("#"))
        rows = list(csv.DictReader(lines))
    except (OSError, csv.Error) as error:
        raise ConfigurationError(f"cannot read {path}: {getattr(error, 'strerror', None) or error}") from error
    robots: list[LoggedRobot] = []
    own = (*TIMES, "control_rate")
    for row in rows:
        given = {name: _number(path, row, name) for name in own if row.get(name)}
        if row is rows[0]:
            first = given
        if given != first:
            raise ConfigurationError(f"{path} has windows of {given}, and others of {first}")
    conditions = from_mapping(Conditions(), first if rows else {})
    for name, group in groupby(rows, lambda row: row.get("robot") or path.stem):
        its = list(group)
        robots += _robots(path, its, name, its[0].get("kind") or name, conditions, Scale())
    return robots


def _robots(
    path: Path, rows: list[dict[str, Any]], name: str, kind: str, conditions: Conditions, scale: Scale
) -> list[LoggedRobot]:
    """Robots of rows that one robot wrote. Once it is changed, it is another one, of a kind of its own."""
    for word in (name, kind):
        if not is_text(word) or len(word) > LONGEST_NAME // 2:
            most = LONGEST_NAME // 2
            raise ConfigurationError(f"{path} names a robot {shortened(word)}: a name is one line of {most} characters")
    counted = [(int(_number(path, row, "changes")) if row.get("changes") else 0, row) for row in rows]
    return [
        LoggedRobot(
            f"{name}{change}",
            f"{kind}{change}",
            conditions,
            scale,
            tuple(_window(path, row) for _, row in group),
        )
        for changes, group in groupby(counted, lambda one: one[0])
        for change in [f", change {changes}" if changes else ""]
    ]


def _window(path: Path, row: Mapping[str, Any]) -> LoggedWindow:
    try:
        parameters = BOX.checked([_number(path, row, name) for name in BOX.names])
    except ConfigurationError as error:
        raise ConfigurationError(f"{path}: {error}") from error
    reward = _number(path, row, "observed_reward")
    if not LOWEST_REWARD <= reward <= HIGHEST_REWARD:
        raise ConfigurationError(f"{path}: observed_reward must be between 0 and 1, not {reward:g}")
    fell = str(row.get("fell")) in ("1", "True")
    return LoggedWindow(parameters, reward, fell, tuple(_number(path, row, name) for name in FELT))


def _number(path: Path, row: Mapping[str, Any], name: str) -> float:
    value = row.get(name)
    if value is None:
        raise ConfigurationError(
            f"{path} has a window without {name}: the columns are those of a session's windows.csv"
        )
    try:
        read = value if isinstance(value, float) else number(str(value))
    except ValueError as error:
        raise ConfigurationError(f"{path}: {name} {error}") from error
    if not abs(read) <= LARGEST_VALUE:
        raise ConfigurationError(f"{path}: {name} must be at most {LARGEST_VALUE:g} by amount, not {read:g}")
    return read
