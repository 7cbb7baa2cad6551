"""Journals' files: rows of a checksum and a JSON object, after a first row that says what all others depend on."""

from __future__ import annotations

import hashlib
import json
import os
import zlib
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO, TypeVar

from sarah.errors import ResumeError
from sarah.files import open_locked

SelfJournalFile = TypeVar("SelfJournalFile", bound="JournalFile")

LONGEST_ROW = 100_000
"""Largest number of bytes in a row of a journal; an episode's has some 1500."""


class JournalFile(ABC):
    """The file of a journal, as a context in which no other process can use it.

    A new one, or one that was cut in its first row, begins anew. The lock ends with its process, however that ends.

    :param path: path of the file, which must exist
    :param kind: kind of run that writes it, for messages
    :raises ResumeError: on entering, if the file is missing, if another process uses it, or if it was begun with other
        settings, code or versions
    """

    is_new: bool
    """Whether the run begins with this journal, in its context."""

    def __init__(self, path: Path, kind: str) -> None:
        self.is_new = False
        self._path = path
        self._run = kind
        self._file: BinaryIO
        self._seed = 0

    def __enter__(self: SelfJournalFile) -> SelfJournalFile:
        """Lock the file, and read it."""
        self._file = _opened(self._path, self._run)  # closed on leaving
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

    def _read(self) -> None:
        expected = self._first_row()
        with open(self._path, "rb") as reader:
            first = reader.readline(LONGEST_ROW)
            if not expected.startswith(first) or first == expected:
                self._check_first_row(first)
                self._seed = checksum_seed(first)
                self._read_rows(reader)
                return
        self.is_new = True
        self._file.truncate(0)
        self._append(expected)
        self._seed = checksum_seed(expected)

    def _append(self, row: bytes, at_once: bool = True) -> None:
        """Append a row as a whole; if ``at_once``, it is on the disk when this returns."""
        left = memoryview(row)
        while left:  # a disk that is nearly full takes only a part
            left = left[self._file.write(left) :]
        if at_once:
            os.fsync(self._file.fileno())

    def _other_stages(self, stages: Sequence[float], unit: str) -> ResumeError:
        """Error of a run that was extended otherwise than its settings say.

        :param stages: budgets at which it should have ended before it went on, and its present one
        :param unit: unit of the budgets
        """
        budgets = ", then ".join(f"{budget:g}" for budget in stages)
        return ResumeError(f"{self._path.parent} cannot be resumed: its budget was not {budgets} {unit}")

    @abstractmethod
    def _first_row(self) -> bytes:
        """First row that a new file would have."""

    @abstractmethod
    def _check_first_row(self, first: bytes) -> None:
        """Refuse a file that begins otherwise than the run would go on."""

    @abstractmethod
    def _read_rows(self, reader: BinaryIO) -> None:
        """Read what follows the first row."""


def _opened(path: Path, kind: str) -> BinaryIO:
    """The file to append to, locked."""
    try:
        file = open_locked(path, os.O_RDWR | os.O_APPEND, wait=False)
    except OSError as error:
        reason = f"it has no {path.name}" if isinstance(error, FileNotFoundError) else str(error)
        raise ResumeError(f"{path.parent} cannot be resumed: {reason}") from error
    if file is None:
        raise ResumeError(f"run folder {path.parent} is in use by another {kind}")
    return file


def compact_json(row: Mapping[str, Any]) -> bytes:
    """A row as JSON without spaces.

    :param row: values by name
    """
    return json.dumps(row, allow_nan=False, separators=(",", ":")).encode()


def first_row(origin: Mapping[str, Any]) -> bytes:
    """First row of a journal: a hash and a JSON object.

    :param origin: what all other rows depend on
    """
    text = compact_json(origin)
    return b"%s %s\n" % (_digest(text), text)


def read_first_row(first: bytes) -> dict[str, Any] | None:
    """What a first row says; ``None`` if it is damaged.

    :param first: first row of a journal
    """
    digest, _, text = first.rstrip(b"\n").partition(b" ")
    try:
        origin = json.loads(text) if digest == _digest(text) else None
    except (ValueError, RecursionError):
        return None
    return origin if isinstance(origin, dict) else None


def checksum_seed(first: bytes) -> int:
    """Number that the checksums of all other rows begin from.

    :param first: first row of the journal
    """
    return int(first[:8], 16)


def checksummed(row: Mapping[str, Any], seed: int) -> bytes:
    """A row with its checksum.

    :param row: values by name
    :param seed: number that the checksum begins from
    """
    text = compact_json(row)
    return b"%08x %s\n" % (zlib.crc32(text, seed), text)


def read_checksummed(line: bytes, seed: int) -> dict[str, Any] | None:
    """Values of a row; ``None`` if it is damaged.

    :param line: row of a journal
    :param seed: number that its checksum begins from
    """
    checksum, _, text = line.rstrip(b"\n").partition(b" ")
    try:
        row = json.loads(text) if int(checksum, 16) == zlib.crc32(text, seed) else None
    except (ValueError, RecursionError):
        return None
    return row if isinstance(row, dict) else None


def _digest(text: bytes) -> bytes:
    return hashlib.sha256(text).hexdigest()[:16].encode()
