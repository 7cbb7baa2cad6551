"""The journal of a session: one row per window, from which an interrupted session goes on exactly.

A session is deterministic, so a resumed one asks its learner again for all parameters, and takes the windows that the
journal has instead of simulating them. Only those since the robot stood up last are simulated again, because they led
to where it is.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, BinaryIO

from sarah.errors import ResumeError
from sarah.operation.window import Window
from sarah.runs.config_files import settings_by_key
from sarah.runs.rows import LONGEST_ROW, JournalFile, checksummed, first_row, read_checksummed, read_first_row
from sarah.sessions.session import SessionSpec
from sarah.versions import differences, versions


class SessionJournal(JournalFile):
    """The journal of a session.

    :param path: path of the file, which must exist
    :param spec: specification of the session
    """

    known: tuple[Window, ...]
    """Windows that the file had, up to the first damaged row."""

    def __init__(self, path: Path, spec: SessionSpec) -> None:
        super().__init__(path, "session")
        self.known = ()
        self._origin: dict[str, Any] = {**settings_by_key(spec), **versions()}

    def add(self, window: Window) -> None:
        """Write a window; it is on the disk when this returns.

        :param window: window to write
        """
        self._append(checksummed(window.plain(), self._seed))

    def _first_row(self) -> bytes:
        return first_row(self._origin)

    def _check_first_row(self, first: bytes) -> None:
        there = read_first_row(first)
        if there is None:
            raise ResumeError(f"{self._path.parent} cannot be resumed: the first row of {self._path.name} is damaged")
        if different := differences(self._origin, there, "in this session"):
            raise ResumeError(f"{self._path.parent} cannot be resumed: {different}: put that back, or begin anew")

    def _read_rows(self, reader: BinaryIO) -> None:
        windows: list[Window] = []
        whole = reader.tell()
        while (line := reader.readline(LONGEST_ROW)) and (window := self._window(line, len(windows))):
            windows.append(window)
            whole = reader.tell()
        self._file.truncate(whole)  # what follows a damaged row is simulated again
        self.known = tuple(windows)

    def _window(self, line: bytes, index: int) -> Window | None:
        row = read_checksummed(line, self._seed) if line.endswith(b"\n") else None
        try:
            window = None if row is None else Window.of_plain(row)
        except TypeError:
            return None
        return window if window is not None and window.index == index else None
