"""``sarah-log --coverage``: which parameters logs have seen, and on which robots."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

from sarah.operation.settings import BOX
from sarah.recognition.logged import LoggedRobot
from sarah.recognition.logs import read_logs

LONGEST_SHOWN = 40
"""Number of characters of a robot's name that are shown."""


def coverage_lines(paths: Sequence[Path]) -> Iterator[str]:
    """Lines about the windows of logs: for each robot the ranges of the parameters that were seen on it.

    :param paths: folders of sessions, MCAP files and tables
    """
    robots = read_logs(paths)
    rows = [("robot", "windows", "sets", "falls", *BOX.names), *map(_row, robots)]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for name, *cells in rows:
        yield f"{name:{widths[0]}}" + "".join(
            f"  {cell:>{width}}" for cell, width in zip(cells, widths[1:], strict=True)
        )
    seen = Counter(parameters for robot in robots for parameters in {window.parameters for window in robot.windows})
    shared = sum(count > 1 for count in seen.values())
    yield f"{len(seen)} sets in all, {shared} of them on more than one robot: only these compare robots"
    yield "what a set is worth on a robot that never ran it, no log can tell"


def _row(robot: LoggedRobot) -> tuple[str, ...]:
    sets = {window.parameters for window in robot.windows}
    ranges = [f"{min(values):.2f} to {max(values):.2f}" for values in zip(*sets, strict=True)]
    falls = sum(window.fell for window in robot.windows)
    return (robot.name[:LONGEST_SHOWN], str(len(robot.windows)), str(len(sets)), str(falls), *ranges)
