"""``sarah-figures``: the paper's figures from run folders."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from sarah.cli.options import parse_options, run_command
from sarah.errors import ConfigurationError
from sarah.tasks import STEPPING

if TYPE_CHECKING:
    from sarah.runs import RunFolder

COMMAND = "sarah-figures"


@dataclass(frozen=True)
class FigureOptions:
    """Draw the paper's figures as PNG and PDF, in a style for print.

    Figures 4 and 5 of First Trainings, 6 and 7 of Second Trainings: several runs of one algorithm become a median and a
    band between quartiles; several algorithms, several colours. Figure 2, the robot of the first run; Figure 3, the
    pattern generator's state machine; and a gait cycle with what the first run of each task learned.

    :param runs: run folders
    :param out: folder for the figures; by default the folder figures of the run, if it is only one
    """

    runs: Annotated[tuple[Path, ...], tyro.conf.Positional, tyro.conf.arg(metavar="RUN...")] = ()
    out: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None


def main() -> None:
    """Run the command with the arguments of the process."""
    run_command(COMMAND, _draw)


def _draw(arguments: Sequence[str]) -> None:
    options = parse_options(FigureOptions, COMMAND, arguments, FigureOptions())
    if not options.runs:
        raise ConfigurationError("give at least one run folder")
    if options.out is None and len(options.runs) > 1:
        raise ConfigurationError("several runs need a folder for their figures: --out DIR")
    from sarah.runs import RunFolder

    runs = [RunFolder.open(path) for path in options.runs]
    folder = options.out or runs[0].figures_path
    from sarah.description import describe_robot
    from sarah.figures import draw_figures
    from sarah.robot_figure import draw_robot
    from sarah.state_machine_figure import draw_state_machine

    files = draw_figures(runs, folder)
    files += draw_robot(describe_robot(runs[0].config().episode.dimensions), folder / "figure_2_robot")
    files += draw_state_machine(folder / "figure_3_pattern_generator")
    first_of_task = {run.config().task: run for run in reversed(runs)}
    for task, run in first_of_task.items():
        files += _draw_cycle(run, folder / f"gait_cycle_{task}")
    for file in sorted(files):
        print(file)


def _draw_cycle(run: RunFolder, path: Path) -> list[Path]:
    """Draw a gait cycle with a run's learned parameters, if they make one."""
    from sarah.episode import EpisodeSpec, simulate
    from sarah.gait_figure import draw_gait_cycle
    from sarah.pattern_generator import SteppingParameters

    config, learned = run.config(), run.parameters()
    trace = simulate(EpisodeSpec(learned, 0, config.task, config.episode), record_trace=True).trace
    assert trace is not None
    stepping = learned if config.task == STEPPING.name else config.episode.stepping
    try:
        return draw_gait_cycle(trace, SteppingParameters(*stepping), path)
    except ConfigurationError as error:
        print(f"{COMMAND}: no gait cycle of {run.path}: {error}", file=sys.stderr)
        return []
