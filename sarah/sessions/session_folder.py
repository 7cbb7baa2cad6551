"""The folder of a session: only this module knows its layout.

session.yaml  command.txt  versions.txt    the specification, the command and the versions of the session
journal.jsonl                              every window in full, from which a session is resumed
windows.csv                                one row per window
events.out.tfevents.*                      curves for TensorBoard
parameters.json                            the parameters that the robot is left with
session.png  session.pdf                   score over time, with falls and changes
frozen/                                    the same session without learning, if it is compared with that
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from pathlib import Path

from sarah.errors import RunFolderError
from sarah.files import check_name, quoted, read_lines, read_text, replace_text, write_command
from sarah.formats import read_json
from sarah.number import finite_number, whole_number
from sarah.operation.settings import PARAMETERS, Parameters, checked_parameters
from sarah.operation.window import FELT, Window
from sarah.runs.config_files import read_config, write_config
from sarah.runs.run_folder import EVENTS
from sarah.runs.run_record import LONGEST_REASON
from sarah.sessions import SPECIFICATION, is_session
from sarah.sessions.session import SessionSpec
from sarah.versions import versions

NAMES = tuple(parameter.name for parameter in PARAMETERS)
COLUMNS = ("index", "begin", "seconds", "changes", *NAMES, "score", "observed_reward", "fell", *FELT)
"""Columns of ``windows.csv``."""
MOST_WINDOWS = 100_000
"""Largest number of windows that are read."""


class SessionFolder:
    """The files of a session.

    :param path: path of the folder; :meth:`create` makes a new one, :meth:`open` checks an existing one
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.journal_path = path / "journal.jsonl"
        self.picture_path = path / "session"
        self.frozen_path = path / "frozen"
        self._spec_path = path / SPECIFICATION
        self._windows_path = path / "windows.csv"
        self._parameters_path = path / "parameters.json"

    @classmethod
    def create(cls, path: Path, spec: SessionSpec, compare_frozen: bool = False) -> SessionFolder:
        """Make a new folder, and write the specification.

        :param path: path of the folder, which must be new or empty
        :param spec: specification of the session
        :param compare_frozen: whether it is to be compared with the same session without learning
        :raises RunFolderError: if the folder is not empty or cannot be written
        """
        check_name(path)
        folder = cls(path)
        try:
            path.mkdir(parents=True, exist_ok=True)
            if any(path.iterdir()):
                can_go_on = folder._spec_path.is_file() and not folder.is_finished
                go_on = f", or go on with sarah-operate --resume {quoted(path)}" if can_go_on else ""
                raise RunFolderError(f"folder {path} is not empty: name another with --out{go_on}")
            folder.journal_path.touch(exist_ok=False)
            write_command(path / "command.txt")
            replace_text(path / "versions.txt", "".join(f"{name} {version}\n" for name, version in versions().items()))
            if compare_frozen:
                folder.add_frozen(spec)
            write_config(spec, folder._spec_path)  # last, because a folder that has it can be resumed
        except RunFolderError:
            raise
        except OSError as error:
            raise RunFolderError(f"cannot write folder {path}: {error.strerror or error}") from error
        return folder

    @classmethod
    def open(cls, path: Path) -> SessionFolder:
        """Open the folder of a session.

        :param path: path of the folder
        :raises RunFolderError: if it is not one
        """
        folder = cls(path)
        if not path.is_dir():
            raise RunFolderError(f"session folder {path} does not exist")
        if not is_session(path):
            raise RunFolderError(f"{path} is not the folder of a session: it has no {folder._spec_path.name}")
        return folder

    @property
    def is_finished(self) -> bool:
        """Whether the session has finished, with parameters that can be read."""
        return self._left() is not None

    @property
    def frozen(self) -> SessionFolder | None:
        """Folder of the same session without learning; ``None`` if there is none."""
        return SessionFolder(self.frozen_path) if is_session(self.frozen_path) else None

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
        for folder in (self.frozen, self):  # first: without them, the sessions of before would only be finished again
            if folder is not None:
                folder._parameters_path.unlink(missing_ok=True)
        write_config(spec, self._spec_path)

    def spec(self) -> SessionSpec:
        """Read the specification.

        :raises ConfigurationError: naming file, key and value, if a value is not allowed
        """
        return read_config(SessionSpec, self._spec_path)

    def write_windows(self, windows: Iterable[Window]) -> None:
        """Write the table anew.

        :param windows: windows of the session so far
        """
        text = io.StringIO()
        writer = csv.writer(text)
        writer.writerow(COLUMNS)
        writer.writerows(map(_row, windows))
        replace_text(self._windows_path, text.getvalue())

    def append_window(self, window: Window) -> None:
        """Add a window to the table.

        :param window: window that follows those of the table
        """
        with self._windows_path.open("a", newline="", encoding="utf-8") as file:
            csv.writer(file).writerow(_row(window))

    def windows(self) -> list[Window]:
        """Read the windows of the table.

        :raises RunFolderError: if it cannot be read
        """
        try:
            windows = [_window(row) for row in csv.DictReader(read_lines(self._windows_path, MOST_WINDOWS))]
            if any(window.index != index for index, window in enumerate(windows)):
                raise ValueError("they are not in order")
            return windows
        except OSError as error:
            raise RunFolderError(f"cannot read {self._windows_path}: {error.strerror}") from error
        except (csv.Error, KeyError, TypeError, ValueError) as error:
            reason = repr(error)[:LONGEST_REASON]
            raise RunFolderError(f"the windows of {self.path} cannot be read: {reason}") from error

    def remove_events(self) -> None:
        """Remove TensorBoard's files, before they are written anew."""
        for path in self.path.glob(f"{EVENTS}*"):
            path.unlink()

    def write_parameters(self, parameters: Parameters) -> None:
        """Write the parameters that the robot is left with, which ends the session.

        :param parameters: P1 to P5 and V1 to V4
        """
        config = self.spec().config
        controller = config.robot_after(len(config.changes)).controller
        content = {"parameters": dict(zip(NAMES, parameters, strict=True)), "controller": asdict(controller)}
        replace_text(self._parameters_path, json.dumps(content, indent=2) + "\n")

    def parameters(self) -> Parameters:
        """Read the parameters that the robot was left with.

        :raises RunFolderError: if the session is not finished, or the file is damaged, which going on mends
        """
        left = self._left()
        if left is None:
            go_on = f"go on with sarah-operate --resume {quoted(self.path)}"
            raise RunFolderError(f"{self.path} is not the folder of a finished session: {go_on}")
        return left

    def _left(self) -> Parameters | None:
        """Parameters that the robot was left with; ``None`` if there are none, or if the file is damaged."""
        try:
            values = read_json(read_text(self._parameters_path))["parameters"]
            return checked_parameters([values[name] for name in NAMES])
        except (OSError, ValueError, KeyError, TypeError):
            return None


def _row(window: Window) -> tuple[object, ...]:
    return (
        *(window.index, window.begin, window.seconds, window.changes),
        *window.parameters,
        *(window.score, window.observed_reward, int(window.fell)),
        *window.felt,
    )


def _window(row: Mapping[str, str]) -> Window:
    return Window(
        index=whole_number(row["index"]),
        begin=finite_number(row["begin"]),
        seconds=finite_number(row["seconds"]),
        changes=whole_number(row["changes"]),
        parameters=checked_parameters([finite_number(row[name]) for name in NAMES]),
        score=finite_number(row["score"]),
        observed_reward=finite_number(row["observed_reward"]),
        fell=row["fell"] == "1",
        felt=tuple(finite_number(row[name]) for name in FELT),
    )
