"""``sarah-figures``: the paper's figures from run folders."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from sarah.cli.next_steps import Step, say_next, to_open
from sarah.cli.options import as_command, named_task, parse_options
from sarah.errors import ConfigurationError

COMMAND = "sarah-figures"


@dataclass(frozen=True)
class FigureOptions:
    """Draw the paper's figures as PNG and PDF, in a style for print.

    Figures 4 and 5 show First Trainings, 6 and 7 Second Trainings. Several runs of one algorithm become a median and a
    band between quartiles; each algorithm has its colour. Figure 2 shows the robot of the first run, and Figure 3 the
    pattern generator's state machine. A gait cycle shows the learned parameters of the first run of each task.

    :param runs: run folders of finished trainings
    :param task: task of runs whose task is that of a file, such as my_task.py:JUMP: their gait cycle is drawn with it
    :param out: folder for the figures; by default ``figures`` in the run folder, if there is one run
    """

    runs: Annotated[
        tuple[Path, ...], tyro.conf.Positional, tyro.conf.arg(metavar="RUN...", help_behavior_hint="(required)")
    ] = ()
    task: Annotated[str | None, tyro.conf.arg(metavar="TASK")] = None
    out: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None


@as_command(COMMAND)
def main() -> None:
    """Run the command with the arguments of the process."""
    options = parse_options(FigureOptions, COMMAND, sys.argv[1:], FigureOptions())
    if not options.runs:
        raise ConfigurationError("give at least one run folder")
    if options.out is None and len(options.runs) > 1:
        raise ConfigurationError("several runs need a folder for their figures: --out DIR")
    from sarah.runs.run_folder import RunFolder
    from sarah.runs.run_record import RunRecord

    task = named_task(options.task)
    runs = [RunFolder.open(path, task=task) for path in options.runs]
    folder = options.out or runs[0].figures_path
    from sarah.reports.all_figures import draw_all_figures

    records = [RunRecord(run) for run in runs]
    files = sorted(draw_all_figures(records, folder))
    for file in files:
        print(file)
    learned = records[0].config.task
    typed = [] if learned.file is None else ["--task", options.task or learned.reference]
    reports: list[Step] = [("have it on one page", ("sarah-report", options.runs[0], *typed))] if len(runs) == 1 else []
    say_next(to_open(next(file for file in files if file.suffix == ".png")), *reports)
