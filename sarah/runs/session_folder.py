"""The folder of a session: only this module knows its layout.

session.yaml  command.txt  versions.txt    the specification, the command and the versions of the session
journal.jsonl                              every window in full, from which a session is resumed
windows.csv                                one row per window
robot.yaml                                 a robot that runs by itself: where it listens, and what it says it is
events.out.tfevents.*                      curves for TensorBoard
parameters.json                            the parameters that the robot is left with
session.png  session.pdf                   score over time, with falls and changes
recognition.json                           what logs teach, if it was given to learner recognise
frozen/                                    the same session without learning, if it is compared with that
"""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping
from contextlib import AbstractContextManager
from dataclasses import asdict
from pathlib import Path

from sarah.errors import shortened
from sarah.files import read_lines, replace_text
from sarah.number import number, whole_number
from sarah.operation.settings import BOX, PARAMETERS, Parameters
from sarah.operation.window import FELT, Window
from sarah.recorded.folder import Folder, unreadable
from sarah.recorded.journal import Journal
from sarah.runs.config_files import read_config, settings_by_key, write_config
from sarah.runs.kinds import SESSION
from sarah.runs.run_folder import read_parameters
from sarah.runs.session import SessionSpec
from sarah.runs.session_robot import SessionRobot

NAMES = tuple(parameter.name for parameter in PARAMETERS)
COLUMNS = ("index", "begin", "seconds", "changes", *NAMES, "score", "observed_reward", "fell", *FELT)
"""Columns of ``windows.csv``."""
MOST_WINDOWS = 100_000
"""Largest number of windows that are read."""


class SessionFolder(Folder):
    """The files of a session.

    :param path: path of the folder; :meth:`create` makes a new one, :meth:`open` checks an existing one
    """

    def __init__(self, path: Path) -> None:
        super().__init__(path, SESSION)
        self.picture_path = path / "session"
        self.frozen_path = path / "frozen"
        self.recognition_path = path / "recognition.json"
        self._windows_path = path / "windows.csv"
        self._robot_path = path / "robot.yaml"

    @classmethod
    def create(
        cls,
        path: Path,
        spec: SessionSpec,
        compare_frozen: bool = False,
        robot: SessionRobot | None = None,
        recognition: str = "",
    ) -> SessionFolder:
        """Make a new folder, and write the specification.

        :param path: path of the folder, which must be new or empty
        :param spec: specification of the session
        :param compare_frozen: whether it is to be compared with the same session without learning
        :param robot: robot that runs by itself, if the session does not simulate one
        :param recognition: text of the recognition, if the specification names one
        :raises RunFolderError: if the folder is not empty or cannot be written
        """
        folder = cls(path)

        def write() -> None:
            if compare_frozen:
                folder.add_frozen(spec)
            if robot is not None:
                write_config(robot, folder._robot_path)
            if recognition:
                replace_text(folder.recognition_path, recognition)
            write_config(spec, folder.specification_path)

        folder.begin(write)
        return folder

    @classmethod
    def open(cls, path: Path) -> SessionFolder:
        """Open the folder of a session.

        :param path: path of the folder
        :raises RunFolderError: if it is not one
        """
        folder = cls(path)
        folder.check()
        return folder

    @property
    def robot(self) -> SessionRobot | None:
        """Robot that runs by itself; ``None`` if the session simulates its robot.

        :raises ConfigurationError: naming file, key and value, if a value is not allowed
        """
        return read_config(SessionRobot, self._robot_path) if self._robot_path.is_file() else None

    @property
    def frozen(self) -> SessionFolder | None:
        """Folder of the same session without learning; ``None`` if there is none."""
        return SessionFolder(self.frozen_path) if SESSION.owns(self.frozen_path) else None

    def add_frozen(self, spec: SessionSpec) -> None:
        """Make the folder of the same session without learning.

        :param spec: specification of the session with learning
        :raises RunFolderError: if it cannot be written
        """
        self.create(self.frozen_path, spec.frozen())

    def extend(self, spec: SessionSpec) -> None:
        """Make a finished session, and the one without learning, unfinished ones with a longer duration.

        :param spec: specification with the longer duration
        """
        frozen = SessionFolder(self.frozen_path)
        write_config(spec, self.specification_path, frozen.result_path, self.result_path)

    def journal_of(self, spec: SessionSpec) -> AbstractContextManager[Journal]:
        """Journal of the session, as a context.

        :param spec: specification of the session
        :raises ResumeError: if it was begun with other settings, code or versions, or is in use
        """
        settings = settings_by_key(spec)
        settings["config.minutes"] = spec.config.stages[0]
        del settings["config.extended_from"]  # the journal has a row for each extension
        if (robot := self.robot) is not None:
            settings["robot"] = robot.robot
        return self.journal(settings, MOST_WINDOWS)

    def spec(self) -> SessionSpec:
        """Read the specification.

        :raises ConfigurationError: naming file, key and value, if a value is not allowed
        """
        return read_config(SessionSpec, self.specification_path)

    def append_window(self, window: Window) -> None:
        """Add a window to the table.

        :param window: window that follows those of the table
        """
        is_new = not self._windows_path.exists()
        with self._windows_path.open("a", newline="", encoding="utf-8") as file:
            csv.writer(file).writerows([*[COLUMNS] * is_new, _row(window)])

    def windows(self) -> list[Window]:
        """Read the windows of the table.

        :raises RunFolderError: if it cannot be read
        """
        try:
            windows = [_window(row) for row in csv.DictReader(read_lines(self._windows_path, MOST_WINDOWS))]
            if any(window.index != index for index, window in enumerate(windows)):
                raise ValueError("they are not in order")
            return windows
        except (OSError, csv.Error, KeyError, TypeError, ValueError) as error:
            raise unreadable(self._windows_path, error) from error

    def remove_records(self) -> None:
        """Remove the table and the curves of the windows: a session that goes on writes them anew."""
        for path in (self._windows_path, *self.event_files()):
            path.unlink(missing_ok=True)

    def write_parameters(self, parameters: Parameters) -> None:
        """Write the parameters that the robot is left with, which ends the session.

        :param parameters: P1 to P5 and V1 to V4
        """
        config = self.spec().config
        robot = config.robot_after(len(config.changes))
        content = {
            "parameters": dict(zip(NAMES, parameters, strict=True)),
            "controller": asdict(robot.controller),
            "control_rate": robot.physics.control_rate,
        }
        replace_text(self.result_path, json.dumps(content, indent=2) + "\n")

    def parameters(self) -> Parameters:
        """Read the parameters that the robot was left with.

        :raises RunFolderError: if the session is not finished, or the file is damaged
        """
        self.check(finished=True)
        return read_parameters(self.result_path, BOX)


def _row(window: Window) -> tuple[object, ...]:
    return (
        *(window.index, window.begin, window.seconds, window.changes),
        *window.parameters,
        *("" if window.score is None else window.score, window.observed_reward, int(window.fell)),
        *window.felt,
    )


def _window(row: Mapping[str, str]) -> Window:
    return Window(
        index=whole_number(row["index"]),
        begin=number(row["begin"]),
        seconds=number(row["seconds"]),
        changes=whole_number(row["changes"]),
        parameters=BOX.checked([number(row[name]) for name in NAMES]),
        score=number(row["score"]) if row["score"] else None,
        observed_reward=number(row["observed_reward"]),
        fell=_fell(row["fell"]),
        felt=tuple(number(row[name]) for name in FELT),
    )


def _fell(text: str) -> bool:
    if text not in ("0", "1"):
        raise ValueError(f"fell must be 0 or 1, not {shortened(text)}")
    return text == "1"
