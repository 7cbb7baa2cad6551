"""The journal of a session: one row per window, from which an interrupted session goes on exactly.

A session is deterministic, so a resumed one asks its learner again for all parameters, and takes the windows that the
journal has instead of simulating them. Only those since the robot stood up last are simulated again, because they led
to where it is.
"""

from __future__ import annotations

import os
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO

from sarah.errors import ResumeError
from sarah.operation.window import Window
from sarah.runs.config_files import settings_by_key
from sarah.runs.rows import (
    LONGEST_ROW,
    append,
    checksum_seed,
    checksummed,
    first_row,
    open_journal,
    read_checksummed,
    read_first_row,
)
from sarah.sessions.session import SessionSpec
from sarah.versions import differences, versions


class SessionJournal:
    """A journal's file, as a context in which no other session can use it.

    :param path: path of the file, which must exist
    :param spec: specification of the session
    :raises ResumeError: on entering, if the file is missing or in use, or if it was begun with another specification,
        code or versions
    """

    known: tuple[Window, ...]
    """Windows that the file had, up to the first damaged row."""

    def __init__(self, path: Path, spec: SessionSpec) -> None:
        self.known = ()
        self._path = path
        self._origin: dict[str, Any] = {**settings_by_key(spec), **versions()}
        self._seed = 0
        self._file: BinaryIO

    def __enter__(self) -> SessionJournal:
        """Lock the file, and read it; a new one, or one that was cut in its first row, begins anew."""
        self._file = open_journal(self._path, "session")  # closed on leaving
        try:
            self._read()
        except BaseException:
            self._file.close()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the file, and release the lock."""
        self._file.close()

    def add(self, window: Window) -> None:
        """Write a window; it is on the disk when this returns.

        :param window: window to write
        """
        self._append(checksummed(window.plain(), self._seed))

    def _append(self, row: bytes) -> None:
        append(self._file, row)
        os.fsync(self._file.fileno())

    def _read(self) -> None:
        expected = first_row(self._origin)
        with open(self._path, "rb") as reader:
            first = reader.readline(LONGEST_ROW)
            if expected.startswith(first) and first != expected:
                self._file.truncate(0)
                self._append(expected)
                self._seed = checksum_seed(expected)
                return
            self._check(first)
            self._seed = checksum_seed(first)
            windows: list[Window] = []
            whole = reader.tell()
            while (line := reader.readline(LONGEST_ROW)) and (window := self._window(line, len(windows))):
                windows.append(window)
                whole = reader.tell()
        self._file.truncate(whole)  # what follows a damaged row is simulated again
        self.known = tuple(windows)

    def _check(self, first: bytes) -> None:
        there = read_first_row(first)
        if there is None:
            raise ResumeError(f"{self._path.parent} cannot be resumed: the first row of {self._path.name} is damaged")
        if different := differences(self._origin, there, "in this session"):
            raise ResumeError(f"{self._path.parent} cannot be resumed: {different}: put that back, or begin anew")

    def _window(self, line: bytes, index: int) -> Window | None:
        row = read_checksummed(line, self._seed) if line.endswith(b"\n") else None
        try:
            window = None if row is None else Window.of_plain(row)
        except TypeError:
            return None
        return window if window is not None and window.index == index else None
