"""``sarah-log``: what logs say, whether they are whole, and parts of them as other files."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from sarah.cli.next_steps import say_next
from sarah.cli.options import as_command, parse_options, printable
from sarah.errors import ConfigurationError
from sarah.streams import check_output

COMMAND = "sarah-log"
NOT_WHOLE = 1
"""Status with which ``--check`` ends if a log is not whole."""


@dataclass(frozen=True)
class LogOptions:
    """Summarise logs of robots, check that they are whole, cut them, make tables of them, or say what they cover.

    A log is an MCAP file that sarah-eval or sarah-operate has written with --log, or your own loop with RobotLog. One
    that was cut, by a full disk or because its process was killed, is read up to its last whole chunk.

    :param files: logs to read
    :param check: whether to say only if each log is whole, is cut, or has gaps because the disk was too slow. Every
        message is checked, and the exit status is 1 if a log is not whole
    :param cut: times at which a part begins and ends, in s since the run began; it is written as a log to --out
    :param out: file for the part of --cut
    :param csv: folder for a table of each topic, such as ticks.csv, with a column for each field
    :param coverage: whether to say which parameters were tried on which robots, in the windows of sessions' folders, of
        MCAP files and of CSV files with the columns of a session's windows.csv
    """

    files: Annotated[
        tuple[Path, ...], tyro.conf.Positional, tyro.conf.arg(metavar="FILE...", help_behavior_hint="(required)")
    ] = ()
    check: bool = False
    cut: Annotated[tuple[float, float] | None, tyro.conf.arg(metavar="BEGIN END")] = None
    out: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    csv: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None
    coverage: bool = False

    def __post_init__(self) -> None:
        """Refuse options that exclude each other, or need another one."""
        given = [name for name in ("check", "cut", "csv", "coverage") if getattr(self, name)]
        if len(given) > 1:
            raise ConfigurationError(f"give --{given[0]} or --{given[1]}, not both")
        if given and given[0] in ("cut", "csv") and len(self.files) > 1:
            raise ConfigurationError(f"--{given[0]} takes one log, not {len(self.files)}")
        if (self.cut is None) != (self.out is None):
            raise ConfigurationError("--cut and --out belong together: --cut BEGIN END --out FILE")
        if self.cut is not None and not self.cut[0] < self.cut[1]:
            raise ConfigurationError(f"cut must be two times in rising order, not {self.cut!r}")


@as_command(COMMAND)
def main() -> None:
    """Run the command with the arguments of the process."""
    options = parse_options(LogOptions, COMMAND, sys.argv[1:], LogOptions())
    if not options.files:
        raise ConfigurationError("give at least one log")
    from sarah.logs.export import cut, export_csv
    from sarah.logs.reading import Log

    if options.cut is not None and options.out is not None:
        cut(Log(options.files[0]), *options.cut, options.out)
        print(options.out)
        say_next(("summarise it", (COMMAND, options.out)))
    elif options.csv is not None:
        for path in export_csv(Log(options.files[0]), options.csv):
            print(path)
    elif options.check:
        _check(options.files)
    elif options.coverage:
        from sarah.cli.coverage import coverage_lines

        for line in coverage_lines(options.files):
            print(printable(line))
    else:
        _summarise(options.files)
    check_output()


def _summarise(files: Sequence[Path]) -> None:
    from sarah.cli.log_text import rows_of
    from sarah.logs.reading import Log
    from sarah.logs.summary import summarise

    for index, path in enumerate(files):
        summary = summarise(Log(path))
        print("\n" if index else "", end="")
        for label, text in rows_of(summary):
            print(f"{label:17}{printable(text)}")


def _check(files: Sequence[Path]) -> None:
    """Say of each log whether it is whole, and end the command if one is not.

    :raises SystemExit: if a log is not whole
    """
    from sarah.cli.log_text import verdict
    from sarah.logs.reading import Log
    from sarah.logs.summary import summarise

    verdicts = [verdict(summarise(Log(path), whole=True)) for path in files]
    for path, words in zip(files, verdicts, strict=True):
        print(f"{path}: {words}")
    check_output()
    if set(verdicts) != {"whole"}:
        raise SystemExit(NOT_WHOLE)
