"""All figures of run folders: the paper's Figures 2 to 7, and gait cycles."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from pathlib import Path

from sarah.episode.episode import simulate
from sarah.episode.result import EpisodeResult
from sarah.episode.task_answers import controller_of
from sarah.errors import ConfigurationError
from sarah.pictures.gait_figure import draw_gait_cycle
from sarah.pictures.robot_figure import draw_robot
from sarah.pictures.state_machine_figure import draw_state_machine
from sarah.reports.training_figures import draw_figures
from sarah.robot.description import describe_robot
from sarah.runs.recorded_task import RecordedTask
from sarah.runs.run_episodes import learned_episode
from sarah.runs.run_record import RunRecord

_log = logging.getLogger(__name__)


def draw_all_figures(runs: Sequence[RunRecord], folder: Path, shown: EpisodeResult | None = None) -> list[Path]:
    """Draw Figures 4 to 7 of all runs, robot and state machine of the first run, and a gait cycle of each task.

    :param runs: records of finished trainings
    :param folder: folder for the figures, which is made if it does not exist
    :param shown: episode of the first run's learned parameters, with a trace, if it has been simulated
    :return: the files, PNG and PDF
    :raises RunFolderError: if a run folder has no episodes, or damaged ones; nothing is drawn then
    """
    files = draw_figures(runs, folder)
    files += _draw_robot(runs[0], folder / "figure_2_robot")
    files += draw_state_machine(folder / "figure_3_pattern_generator", runs[0].config.episode.controller)
    first_of_task = {run.config.task.name: run for run in reversed(runs)}
    for name, run in first_of_task.items():
        if not isinstance(run.config.task, RecordedTask):  # which cannot simulate
            files += _draw_cycle(run, folder / f"gait_cycle_{name}", shown if run is runs[0] else None)
    return files


def _draw_robot(run: RunRecord, path: Path) -> list[Path]:
    """Draw a training's robot, if the renderer is installed."""
    try:
        return draw_robot(describe_robot(run.config.episode.dimensions), path)
    except ConfigurationError as error:
        _log.warning("no %s: %s", path.name, error)
        return []


def _draw_cycle(run: RunRecord, path: Path, shown: EpisodeResult | None) -> list[Path]:
    """Draw a gait cycle with a training's learned parameters, if the robot completes one."""
    spec = learned_episode(run).spec
    trace = (shown or simulate(spec, record_trace=True)).trace
    assert trace is not None
    stepping, _ = controller_of(spec.task, spec.parameters, spec.config)
    try:
        return draw_gait_cycle(trace, stepping, path, spec.config.controller)
    except ConfigurationError as error:
        _log.warning("no gait cycle of %s: %s", run.folder.path, error)
        return []
