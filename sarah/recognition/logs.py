"""Logs that are learned from: sessions' folders, MCAP files with windows, and tables that somebody else wrote."""

from __future__ import annotations

import csv
import hashlib
import json
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import Any

from sarah.control.pattern_generator import STAND_SECONDS
from sarah.episode.from_mapping import from_mapping
from sarah.errors import ConfigurationError, SarahError, shortened
from sarah.files import read_lines
from sarah.logs.reading import Log
from sarah.logs.topics import WINDOWS
from sarah.operation.settings import BOX, OperationConfig
from sarah.operation.window import FELT, Window
from sarah.recognition.logged import (
    LONGEST_ROBOT,
    LoggedRobot,
    LoggedWindow,
    check_names,
    logged_robots,
    logged_window,
    number_of,
)
from sarah.recognition.recognition import Conditions
from sarah.robot.dimensions import check_dimensions, scale_of
from sarah.robot.scale import Scale
from sarah.runs.config_files import settings_by_key
from sarah.runs.kinds import SESSION
from sarah.runs.session import LARGEST_SEED, SessionSpec
from sarah.runs.session_folder import MOST_WINDOWS, SessionFolder

MCAP, TABLE = ".mcap", ".csv"
"""Endings of the names of logs that are files."""
TIMES = ("settle_seconds", "measure_seconds")
"""Names of the times of a window."""
LONGEST_KIND, DIGEST_LENGTH = LONGEST_ROBOT - len(f", seed {LARGEST_SEED}"), 8
"""Largest number of characters in the name of a simulated robot's kind, and in the digest of a longer one."""
BYTE_ORDER_MARK = "\N{ZERO WIDTH NO-BREAK SPACE}"
"""First character of a table that a spreadsheet has written."""
SLACK = 0.1
"""Time by which a window may be longer or shorter than it should be, in s."""


def read_logs(paths: Sequence[Path]) -> list[LoggedRobot]:
    """Read logs, and put the windows of the same robot together; those that a log before has, too, count once.

    :param paths: folders of sessions, MCAP files and tables
    :return: robots in the order of the logs
    :raises ConfigurationError: naming the log, if it cannot be read, has no window, or has other conditions than most
    """
    if not paths:
        raise ConfigurationError("give at least one log: a session's folder, an MCAP file, or a table of windows")
    logs = [_read_log(path, name) for path, name in zip(paths, _names(paths), strict=True)]
    usual, _ = Counter(its[0].conditions for its in logs).most_common(1)[0]
    robots: dict[tuple[str, str], LoggedRobot] = {}
    seen: set[LoggedWindow] = set()
    for path, its in zip(paths, logs, strict=True):
        read: set[LoggedWindow] = set()
        for robot in its:
            usual.check(robot.conditions, str(path))
            new = tuple(window for window in robot.windows if window not in seen)
            known = robots.get((robot.kind, robot.name))
            if new:
                windows = new if known is None else known.windows + new
                robots[robot.kind, robot.name] = replace(robot, windows=windows)
            read.update(new)
        seen |= read
    return list(robots.values())


def _names(paths: Sequence[Path]) -> list[str]:
    """Names of logs that name no robot: those of the files, with as many folders as tell them apart."""
    whole = [(path.resolve().parent / path.resolve().stem).parts for path in paths]
    names = []
    for parts in whole:
        others = [other for other in whole if other != parts]
        length = next(n for n in range(1, len(parts) + 1) if all(other[-n:] != parts[-n:] for other in others))
        names.append("/".join(parts[-length:]))
    return names


def _read_log(path: Path, name: str) -> list[LoggedRobot]:
    """Robots of a log: one for each time that something about it was changed; of the given name if it names none."""
    if SESSION.owns(path):
        robots = _of_session(path)
    elif path.suffix == MCAP:
        robots = _of_mcap(path, name)
    elif path.suffix == TABLE:
        robots = _of_table(path, name)
    else:
        raise ConfigurationError(f"{path} is no log: it is neither a session's folder, nor a {MCAP} or {TABLE} file")
    if not robots:
        raise ConfigurationError(f"{path} has no windows to learn from")
    return robots


def _of_session(path: Path) -> list[LoggedRobot]:
    folder = SessionFolder.open(path)
    spec = folder.spec()
    conditions, scale = Conditions.of(spec.config), spec.config.robot.scale
    robots = []
    for changes, windows in groupby(folder.windows(), lambda window: window.changes):
        if not 0 <= changes <= len(spec.config.changes):
            raise ConfigurationError(f"{path} has a window after {changes} changes, of {len(spec.config.changes)}")
        names = _names_of(folder, spec, changes)
        check_names(path, *names)
        its = tuple(logged_window(path, _row(one)) for one in windows)
        robots.append(LoggedRobot(*names, conditions, scale, its))
    return robots


def _row(window: Window) -> dict[str, Any]:
    """Values of a window by name."""
    named = zip((*BOX.names, *FELT), (*window.parameters, *window.felt), strict=True)
    return {"observed_reward": window.observed_reward, "fell": window.fell, **dict(named)}


def _names_of(folder: SessionFolder, spec: SessionSpec, changes: int) -> tuple[str, str]:
    """Names of a session's robot and of its kind; a robot that is not simulated is of a kind of its own."""
    robot = folder.robot
    if robot is None:
        kind = kind_of(spec.config, changes)
        return _robot_of(kind, spec.seed), kind
    name = _fitting(f"{robot.robot} on {robot.host}")
    return name, kind_of(spec.config) if robot.has_score else name


def kind_of(config: OperationConfig, changes: int = 0) -> str:
    """Kind of a simulated robot: what differs from the default one. Its seed draws masses and errors of sensors.

    :param config: settings of its operation
    :param changes: number of changes that have been made
    """
    values, usual = settings_by_key(config.robot_after(changes)), settings_by_key(OperationConfig().robot)
    physics = ("push.", "physics.")  # what the robot is put through, and how it is simulated
    differing = [f"{key} {values[key]}" for key in values if values[key] != usual[key] and not key.startswith(physics)]
    return _fitting(", ".join(differing) or "as simulated")


def _fitting(name: str) -> str:
    """A name that a log may have, also with a seed after it; of a longer one the beginning, and a digest of all."""
    if len(name) <= LONGEST_KIND:
        return name
    digest = hashlib.sha256(name.encode()).hexdigest()[:DIGEST_LENGTH]
    return f"{name[: LONGEST_KIND - DIGEST_LENGTH - 1]} {digest}"


def facts_of(config: OperationConfig, seed: int) -> dict[str, str]:
    """Facts about a simulated robot that its log needs so that one can learn from it.

    :param config: settings of its operation
    :param seed: its seed
    """
    kind, times = kind_of(config), (repr(config.settle_seconds), repr(config.measure_seconds))
    return {"seed": str(seed), "kind": kind, "robot": _robot_of(kind, seed), **dict(zip(TIMES, times, strict=True))}


def _robot_of(kind: str, seed: int) -> str:
    return f"{kind}, seed {seed}"


def _of_mcap(path: Path, name: str) -> list[LoggedRobot]:
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
    name = log.about.get("robot", name)
    return logged_robots(path, rows, name, log.about.get("kind", name), shared, scale_of(dimensions))


def _check_durations(path: Path, windows: Iterable[Mapping[str, Any]], conditions: Conditions) -> None:
    """Refuse windows that took another time than their conditions say: with standing, or without it."""
    seconds = conditions.settle_seconds + conditions.measure_seconds
    for window in windows:
        duration = window.get("duration", seconds)
        if not window["fell"] and not seconds - SLACK <= duration <= seconds + STAND_SECONDS + SLACK:
            raise ConfigurationError(f"{path} has a window of {duration:g} s, not of {seconds:g} s")


def _of_table(path: Path, name: str) -> list[LoggedRobot]:
    """Robots of a table with the columns of a session's ``windows.csv``, and perhaps one that names the robot."""
    rows = _rows_of(path)
    robots: list[LoggedRobot] = []
    first: dict[str, float] | None = None
    for row in rows:
        given = {name: number_of(path, row, name) for name in (*TIMES, "control_rate") if row.get(name)}
        first = given if first is None else first
        if given != first:
            raise ConfigurationError(f"{path} has windows of {given}, and others of {first}")
    conditions = from_mapping(Conditions(), first or {})
    for (robot, kind), its in groupby(rows, lambda row: (row.get("robot") or name, row.get("kind"))):
        robots += logged_robots(path, list(its), robot, kind or robot, conditions, Scale())
    return robots


def _rows_of(path: Path) -> list[dict[str, str]]:
    """Rows of a table, without lines that begin with a number sign."""
    try:
        lines = (line.removeprefix(BYTE_ORDER_MARK) for line in read_lines(path, MOST_WINDOWS))
        reader = csv.DictReader((line for line in lines if not line.startswith("#")), strict=True)
        columns = reader.fieldnames or ()
        if repeated := next((name for name in columns if columns.count(name) > 1), None):
            raise ConfigurationError(f"{path} has two columns {shortened(repeated)}")
        rows = list(reader)
    except (OSError, csv.Error) as error:
        raise ConfigurationError(f"cannot read {path}: {getattr(error, 'strerror', None) or error}") from error
    if any(None in row for row in rows):
        raise ConfigurationError(f"{path} has a row with more cells than columns: numbers have a point, not a comma")
    return rows
