"""``sarah-report``: a report of a training as one HTML page."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from sarah.cli.next_steps import say_next, to_open, to_see
from sarah.cli.options import as_command, named_task, parse_options
from sarah.errors import ConfigurationError

COMMAND = "sarah-report"


@dataclass(frozen=True)
class ReportOptions:
    """Write a report of a training as one HTML page: results beside the paper's, video, figures, settings and commands.

    The page is one file that contains everything it shows, so you can send it to others, and it opens without a
    network.

    :param run: run folder of a finished training
    :param task: task of a run whose task is that of a file, such as my_task.py:JUMP
    :param out: file to write; by default report.html in the run folder
    :param episodes: number of episodes on unseen seeds for the table of results; those of which the training itself has
        noted the results are not simulated again
    :param seconds: simulated times at which the video begins and ends, in s. It is MP4 with the extra ``video``, and
        otherwise GIF
    :param workers: number of processes on this machine that simulate; with 0, this process does. It changes no result
    """

    run: Annotated[Path | None, tyro.conf.Positional, tyro.conf.arg(metavar="RUN", help_behavior_hint="(required)")] = (
        None
    )
    task: Annotated[str | None, tyro.conf.arg(metavar="TASK")] = None
    out: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    episodes: int = 10
    seconds: Annotated[tuple[float, float], tyro.conf.arg(metavar="BEGIN END")] = (1.0, 5.0)
    workers: int = 0

    def __post_init__(self) -> None:
        """Refuse numbers outside their ranges."""
        if self.episodes < 1:
            raise ConfigurationError(f"episodes must be at least 1, not {self.episodes!r}")
        if not self.seconds[0] < self.seconds[1]:
            raise ConfigurationError(f"seconds must be in rising order, not {self.seconds!r}")


@as_command(COMMAND)
def main() -> None:
    """Run the command with the arguments of the process."""
    options = parse_options(ReportOptions, COMMAND, sys.argv[1:], ReportOptions())
    if options.run is None:
        raise ConfigurationError("give a run folder")
    from sarah.episode.workers import Workers
    from sarah.reports.report import write_report
    from sarah.runs.run_folder import RunFolder
    from sarah.runs.run_record import RunRecord

    run = RunFolder.open(options.run, task=named_task(options.task))
    path = options.out or run.report_path
    with Workers(options.workers) as workers:
        write_report(RunRecord(run), path, workers, options.episodes, options.seconds)
    print(path)
    typed = [] if options.task is None else ["--task", options.task]
    say_next(to_open(path), to_see(options.run, *typed))
