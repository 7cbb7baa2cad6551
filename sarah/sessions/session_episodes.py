"""The parameters of a session as episodes, which every command can look at."""

from __future__ import annotations

import csv
from pathlib import Path

from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE
from sarah.errors import RunFolderError, SarahError
from sarah.operation.settings import OperationConfig, Parameters
from sarah.runs.run_episodes import LONGEST_REASON, RunEpisode
from sarah.sessions.session_folder import NAMES, SessionFolder

STEPPING_COUNT = len(NAMES) - len(BALANCE.parameters)
"""Number of the parameters that the task balance has among its settings: P1 to P5."""


def learned_of_session(path: Path) -> RunEpisode:
    """Episode of the parameters that a session left its robot with, on that robot after all changes.

    :param path: path of the session's folder
    :raises RunFolderError: if the session is not finished, or a file of it cannot be read
    """
    folder = SessionFolder.open(path)
    spec = folder.spec()
    left = episode_spec(folder.parameters(), spec.config, len(spec.config.changes))
    return RunEpisode("learned", "parameters that the session ended with · seed 0", left)


def episodes_of_session(path: Path) -> list[RunEpisode]:
    """Episodes of a session: the parameters that it ended with, those of the best window, and those of every window.

    Each is an episode of its own, from standing, on the robot as it was in the window.

    :param path: path of the session's folder, which need not be finished
    :raises RunFolderError: if a file of it cannot be read, or if it has no window
    """
    folder = SessionFolder.open(path)
    config = folder.spec().config
    shown = [learned_of_session(path)] if folder.is_finished else []
    windows: list[tuple[float, RunEpisode]] = []
    try:
        for row in csv.DictReader(folder.window_lines()):
            parameters = tuple(float(row[name]) for name in NAMES)
            score, minute = float(row["score"]), float(row["begin"]) / 60.0
            fell = ", fell" if row["fell"] == "1" else ""
            label = f"window {row['index']} · {minute:.1f} min · score {score:.2f}{fell}"
            spec = episode_spec(parameters, config, int(row["changes"]))
            windows.append((score, RunEpisode(row["index"], label, spec)))
    except (OSError, csv.Error, KeyError, TypeError, ValueError, SarahError) as error:
        raise RunFolderError(f"the windows of {path} cannot be read: {repr(error)[:LONGEST_REASON]}") from error
    if not windows:
        raise RunFolderError(f"{path} has no windows to show yet")
    _, best = max(windows, key=lambda window: window[0])
    shown.append(RunEpisode("best", f"best: {best.label}", best.spec))
    return shown + [episode for _, episode in windows]


def episode_spec(parameters: Parameters, config: OperationConfig, changes: int) -> EpisodeSpec:
    """Episode of a robot in operation, with seed 0.

    :param parameters: P1 to P5 and V1 to V4
    :param config: settings of the operation
    :param changes: number of changes that had been made
    """
    stepping = parameters[:STEPPING_COUNT]
    episode = BALANCE.config_of(config.robot_after(changes), stepping=stepping)
    return EpisodeSpec(parameters[STEPPING_COUNT:], 0, BALANCE, episode)
