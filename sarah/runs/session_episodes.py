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
from sarah.runs.session import SessionSpec
from sarah.runs.session_folder import SessionFolder

STEPPING_COUNT = len(PARAMETERS) - len(BALANCE.parameters)
"""Number of the parameters that the task balance has among its settings: P1 to P5."""


def learned_of_session(path: Path) -> RunEpisode:
    """Episode of the parameters that a session left its robot with, on the robot of its last window.

    :param path: path of the session's folder
    :raises RunFolderError: if the session is not finished, or a file of it cannot be read
    """
    folder = SessionFolder.open(path)
    spec, windows = folder.spec(), _windows(folder)
    left = episode_spec(folder.parameters(), spec, windows[-1].changes)
    return RunEpisode("learned", "parameters that the session ended with", left)


def episodes_of_session(path: Path) -> list[RunEpisode]:
    """Episodes of a session: the parameters that it ended with, those of the best window, and those of every window.

    The viewer plays each window as it was, and goes on with the next one. For other commands it is an episode of its
    own, from standing, on the robot as it was in the window. So it is for the viewer if the robot ran by itself.

    :param path: path of the session's folder, which need not be finished
    :raises RunFolderError: if a file of it cannot be read, or if it has no window
    """
    folder = SessionFolder.open(path)
    spec, windows = folder.spec(), _windows(folder)
    shown = [learned_of_session(path)] if folder.is_finished else []
    replay = SessionReplay(spec, windows) if folder.robot is None else None
    episodes = [_episode(spec, replay, window, window is windows[-1]) for window in windows]
    best = episodes[max(range(len(windows)), key=lambda index: windows[index].worth)]
    return [*shown, replace(best, name="best", label=f"best: {best.label}"), *episodes]


def _windows(folder: SessionFolder) -> list[Window]:
    """The windows of a session, of which there must be one."""
    windows = folder.windows()
    if not windows:
        raise RunFolderError(f"{folder.path} has no windows to show yet")
    return windows


def _episode(spec: SessionSpec, replay: SessionReplay | None, window: Window, is_last: bool) -> RunEpisode:
    fell, worth = ", fell" if window.fell else "", "score" if window.score is not None else "observed reward"
    label = f"window {window.index} · {window.begin / 60.0:.1f} min · {worth} {window.worth:.2f}{fell}"
    return RunEpisode(
        str(window.index),
        label,
        episode_spec(window.parameters, spec, window.changes),
        recorded=None if replay is None else partial(replay.record, window.index),
        next_name=None if is_last or replay is None else str(window.index + 1),
    )


class SessionReplay:
    """A session's robot, which runs its windows again.

    :param spec: specification of the session
    :param windows: its windows, in order
    """

    def __init__(self, spec: SessionSpec, windows: Sequence[Window]) -> None:
        self._spec = spec
        self._windows = windows
        self._robot: RobotInOperation | None = None

    def record(self, index: int) -> EpisodeResult:
        """Run one window again: on from the one before if that was the last, or else from where the robot stood up.

        :param index: number of the window
        :return: it as the result of an episode, with a trace
        """
        robot, self._robot = self._robot, None
        if robot is None or robot.windows != index:
            if robot is not None:
                robot.close()
            robot = RobotInOperation(self._spec.config, self._spec.seed)
            for before in self._windows[:index]:
                robot.skip(before)
        result = robot.replay(self._windows[index])
        self._robot = robot
        return result


def episode_spec(parameters: Parameters, spec: SessionSpec, changes: int) -> EpisodeSpec:
    """Episode of a session's robot.

    :param parameters: P1 to P5 and V1 to V4
    :param spec: specification of the session
    :param changes: number of changes that had been made
    """
    episode = BALANCE.config_of(spec.config.robot_after(changes), stepping=parameters[:STEPPING_COUNT])
    return EpisodeSpec(parameters[STEPPING_COUNT:], spec.seed, BALANCE, episode)
