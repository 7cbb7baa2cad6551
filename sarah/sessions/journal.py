"""The journal of a session: one row per window, from which an interrupted session goes on exactly.

A session is deterministic, so a resumed one asks its learner again for all parameters, and takes the windows that the
journal has instead of simulating them. Only those since the robot stood up last are simulated again, because they led
to where it is.

A session that was extended has a row for each extension, before the first window after it.
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

EXTENDED = "extended_to"
"""Name of the only value of an extension's row: the longer duration, in min."""


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
        self._config = spec.config
        self._extensions = 0
        self._origin = _origin_of(spec)

    def add(self, window: Window) -> None:
        """Write a window; it is on the disk when this returns.

        :param window: window to write
        """
        while self._extensions < self._config.stages_over(window.begin):
            self._append(checksummed(self._next_extension(), self._seed))
            self._extensions += 1
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
        while row := self._row(reader.readline(LONGEST_ROW)):
            if EXTENDED in row:
                self._count_extension(row)
            elif window := _window(row, len(windows)):
                windows.append(window)
            else:
                break
            whole = reader.tell()
        self._file.truncate(whole)  # what follows a damaged row is simulated again
        self.known = tuple(windows)

    def _row(self, line: bytes) -> dict[str, Any] | None:
        return read_checksummed(line, self._seed) if line.endswith(b"\n") else None

    def _count_extension(self, row: dict[str, Any]) -> None:
        """Check that the session went on then as its specification says."""
        if self._extensions == len(self._config.extended_from) or row != self._next_extension():
            raise self._other_stages(self._config.stages, "min")
        self._extensions += 1

    def _next_extension(self) -> dict[str, Any]:
        return {EXTENDED: self._config.stages[self._extensions + 1]}


def _origin_of(spec: SessionSpec) -> dict[str, Any]:
    settings = settings_by_key(spec)
    settings["config.minutes"] = spec.config.stages[0]
    del settings["config.extended_from"]  # the journal has a row for each extension
    return {**settings, **versions()}


def _window(row: dict[str, Any], index: int) -> Window | None:
    try:
        window = Window.of_plain(row)
    except TypeError:
        return None
    return window if window.index == index else None
