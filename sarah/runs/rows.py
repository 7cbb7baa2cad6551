"""Rows of a journal: a checksum and a JSON object, after a first row that says what all others depend on."""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any, BinaryIO

from sarah.errors import ResumeError
from sarah.files import open_regular

LONGEST_ROW = 100_000
"""Largest number of bytes in a row of a journal; an episode's has some 1500."""


def open_journal(path: Path, kind: str) -> BinaryIO:
    """Open a journal, and lock it; the system releases the lock when the process ends, however it ends.

    :param path: path of the file, which must exist
    :param kind: kind of run that writes it, for messages
    :return: the file, to append to
    :raises ResumeError: if it cannot be opened, or another process has the lock
    """
    try:
        file = open_regular(path, os.O_RDWR | os.O_APPEND)
    except OSError as error:
        reason = f"it has no {path.name}" if isinstance(error, FileNotFoundError) else str(error)
        raise ResumeError(f"{path.parent} cannot be resumed: {reason}") from error
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BaseException as error:
        file.close()
        if isinstance(error, BlockingIOError):
            raise ResumeError(f"run folder {path.parent} is in use by another {kind}") from None
        raise
    return file


def append(file: BinaryIO, row: bytes) -> None:
    """Append a row as a whole.

    :param file: journal, unbuffered
    :param row: row to append
    """
    left = memoryview(row)
    while left:  # a disk that is nearly full takes only a part
        left = left[file.write(left) :]


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
