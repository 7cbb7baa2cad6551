"""``sarah-log --coverage``: which parameters were tried in logs, and on which robots."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

from sarah.operation.settings import BOX, SHIPPED
from sarah.recognition.learning import is_same
from sarah.recognition.logged import LoggedRobot
from sarah.recognition.logs import read_logs

BEGINNING, END = 18, 21
"""Number of characters at both ends of a long name that are shown, unless two robots then look the same."""


def coverage_lines(paths: Sequence[Path]) -> Iterator[str]:
    """Lines about the windows of logs: for each robot the ranges of the parameters that were seen on it.

    :param paths: folders of sessions, MCAP files and tables
    """
    robots = read_logs(paths)
    head = ("robot", "windows", "shipped", "sets", "falls", *BOX.names)
    names = names_shown([robot.name for robot in robots])
    rows = [head, *((name, *_cells(robot)) for name, robot in zip(names, robots, strict=True))]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for name, *cells in rows:
        yield f"{name:{widths[0]}}" + "".join(
            f"  {cell:>{width}}" for cell, width in zip(cells, widths[1:], strict=True)
        )
    seen = Counter(parameters for robot in robots for parameters in {window.parameters for window in robot.windows})
    shared = sum(count > 1 for count in seen.values())
    yield "shipped: windows with the shipped parameters, by which robots are recognised"
    yield f"{len(seen)} sets in all, {shared} of them on more than one robot: only these compare robots"
    yield "no log can tell what a set is worth on a robot that never ran it"


def names_shown(names: Sequence[str]) -> list[str]:
    """Names without the middle of long ones, or whole if two would look the same.

    :param names: names of robots
    """
    longest = BEGINNING + 1 + END
    short = [name if len(name) <= longest else f"{name[:BEGINNING]}…{name[-END:]}" for name in names]
    looks = Counter(dict(zip(names, short, strict=True)).values())
    return [name if looks[one] > 1 else one for name, one in zip(names, short, strict=True)]


def _cells(robot: LoggedRobot) -> tuple[str, ...]:
    sets = {window.parameters for window in robot.windows}
    ranges = [f"{min(values):.2f} to {max(values):.2f}" for values in zip(*sets, strict=True)]
    falls = sum(window.fell for window in robot.windows)
    shipped = sum(is_same(window.parameters, SHIPPED) for window in robot.windows)
    return (str(len(robot.windows)), str(shipped), str(len(sets)), str(falls), *ranges)
