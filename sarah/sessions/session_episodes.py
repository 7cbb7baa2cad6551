"""The parameters of a session as episodes, which every command can look at."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from sarah.episode.result import EpisodeResult
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE
from sarah.errors import RunFolderError
from sarah.operation.robot_in_operation import RobotInOperation
from sarah.operation.settings import PARAMETERS, Parameters
from sarah.operation.window import Window
from sarah.runs.run_episodes import RunEpisode
from sarah.sessions.session import SessionSpec
from sarah.sessions.session_folder import SessionFolder

STEPPING_COUNT = len(PARAMETERS) - len(BALANCE.parameters)
"""Number of the parameters that the task balance has among its settings: P1 to P5."""


def learned_of_session(path: Path) -> RunEpisode:
    """Episode of the parameters that a session left its robot with, on that robot after all changes.

    :param path: path of the session's folder
    :raises RunFolderError: if the session is not finished, or a file of it cannot be read
    """
    folder = SessionFolder.open(path)
    spec = folder.spec()
    left = episode_spec(folder.parameters(), spec, len(spec.config.changes))
    return RunEpisode("learned", "parameters that the session ended with", left)


def episodes_of_session(path: Path) -> list[RunEpisode]:
    """Episodes of a session: the parameters that it ended with, those of the best window, and those of every window.

    The viewer plays each window as it was. For other commands it is an episode of its own, from standing, on the robot
    as it was in the window.

    :param path: path of the session's folder, which need not be finished
    :raises RunFolderError: if a file of it cannot be read, or if it has no window
    """
    folder = SessionFolder.open(path)
    spec, windows = folder.spec(), folder.windows()
    shown = [learned_of_session(path)] if folder.is_finished else []
    if not windows:
        raise RunFolderError(f"{path} has no windows to show yet")
    episodes = [_episode(spec, windows, window) for window in windows]
    best = episodes[max(range(len(windows)), key=lambda index: windows[index].score)]
    return [*shown, replace(best, name="best", label=f"best: {best.label}"), *episodes]


def _episode(spec: SessionSpec, windows: Sequence[Window], window: Window) -> RunEpisode:
    fell = ", fell" if window.fell else ""
    label = f"window {window.index} · {window.begin / 60.0:.1f} min · score {window.score:.2f}{fell}"
    episode = episode_spec(window.parameters, spec, window.changes)
    return RunEpisode(str(window.index), label, episode, recorded=partial(replayed, spec, windows, window))


def replayed(spec: SessionSpec, windows: Sequence[Window], window: Window) -> EpisodeResult:
    """Simulate one window of a session again, from where the robot stood up last.

    :param spec: specification of the session
    :param windows: all windows before it, and perhaps others
    :param window: window to simulate
    :return: it as the result of an episode, with a trace
    """
    robot = RobotInOperation(spec.config, spec.seed)
    try:
        for before in windows[: window.index]:
            robot.skip(before)
        return robot.replay(window)
    finally:
        robot.close()


def episode_spec(parameters: Parameters, spec: SessionSpec, changes: int) -> EpisodeSpec:
    """Episode of a session's robot.

    :param parameters: P1 to P5 and V1 to V4
    :param spec: specification of the session
    :param changes: number of changes that had been made
    """
    episode = BALANCE.config_of(spec.config.robot_after(changes), stepping=parameters[:STEPPING_COUNT])
    return EpisodeSpec(parameters[STEPPING_COUNT:], spec.seed, BALANCE, episode)
