"""The journal of a recorded program: what it asked for, and what came of it, from which it goes on exactly.

A recorded program is deterministic: what it asks for next follows from its settings and from the outcomes so far. So
one that was interrupted runs again from its beginning, but takes the outcomes that its journal has instead of asking
the world. It restores random generators, models and schedules of any kind, because they go through the same states
again.

The first row says what all others depend on: settings, this package's code, others' versions. A row is a checksum and a
JSON object, and is on the disk before the program goes on. A damaged row is ignored, and the world is asked again.
Checksums begin from the hash of the first row, so rows of other programs count as damaged.
"""

from __future__ import annotations

import hashlib
import json
import logging
import os
import zlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, BinaryIO, TypeVar

from sarah.errors import ResumeError, SarahError
from sarah.files import open_locked, quoted
from sarah.recorded.kind import Kind
from sarah.versions import differences

Outcome = TypeVar("Outcome")

LONGEST_ROW = 100_000
"""Largest number of bytes in a row; an episode's has some 1500."""
ROOM_PER_REQUEST = 10_000
"""Number of bytes for each request in a journal that is read."""

_log = logging.getLogger(__name__)


class Journal:
    """A journal, as a context in which no other process can use its file.

    A new file, or one that was cut in its first row, begins anew. The lock ends with its process, however that ends.

    :param path: path of the file, which must exist, in the folder of what is recorded
    :param origin: what all outcomes depend on: settings and versions by name, as JSON has them
    :param kind: kind of what is recorded
    :param most_requests: number of requests that a journal of this program has at most
    :raises ResumeError: on entering, if the file is missing, if another process uses it, or if it was begun with
        something else
    """

    is_new: bool
    """Whether the program begins with this journal, in its context."""

    def __init__(self, path: Path, origin: Mapping[str, Any], kind: Kind, most_requests: int) -> None:
        self.is_new = False
        self._path, self._origin, self._kind = path, origin, kind
        self._most_bytes = ROOM_PER_REQUEST * most_requests
        self._file: BinaryIO
        self._seed = 0
        self._known: dict[int, dict[str, Any]] = {}
        self._held: list[Callable[[], None]] = []

    def __enter__(self) -> Journal:
        """Lock the file, and read it."""
        self._file = self._locked(os.O_RDWR | os.O_APPEND)
        try:
            self._read()
        except BaseException:
            self._file.close()
            raise
        return self

    def _locked(self, flags: int) -> BinaryIO:
        """Open the file with flags of :func:`os.open`, and lock it."""
        try:
            file = open_locked(self._path, flags, wait=False)
        except OSError as error:
            reason = f"it has no {self._path.name}" if isinstance(error, FileNotFoundError) else str(error)
            raise self._refusal(reason) from error
        if file is None:
            raise ResumeError(f"{self._kind.folder} {self._path.parent} is in use by another {self._kind.name}")
        return file

    def __exit__(self, *error: object) -> None:
        """Close the file, and release the lock."""
        self._file.close()

    @property
    def replaying(self) -> bool:
        """Whether the journal has outcomes that the program has not yet asked for."""
        return bool(self._known)

    def known(self, request: Mapping[str, Any], read: Callable[[Any], Outcome]) -> Outcome | None:
        """Outcome of a request, if the journal has it.

        :param request: what the program asks for, as JSON has it, and its ``index``: the number of the request
        :param read: function that makes the outcome of what JSON has
        :raises ResumeError: if the program asked for something else when the journal was written
        """
        row = self._known.pop(request["index"], None)
        if row is None:
            return None
        there = {name: value for name, value in row.items() if name != "outcome"}
        if there != request:
            raise self._other_request(request, there)
        try:
            return read(row["outcome"])
        except (ValueError, TypeError, LookupError, ArithmeticError, AttributeError, SarahError, RecursionError):
            _log.warning("%s: damaged rows: 1; what it has is asked for again", self._path)
            return None

    def add(self, request: Mapping[str, Any], outcome: Any) -> None:
        """Write an outcome, which is on the disk when this returns.

        :param request: what the program asked for
        :param outcome: outcome, as JSON has it
        """
        self._append(_signed({**request, "outcome": outcome}, self._checksum))

    def extend(self, index: int, budget: float) -> None:
        """Note that the program goes on to a larger budget, or check that it did so before.

        :param index: number of the request
        :param budget: the larger budget
        :raises ResumeError: if it was extended to another one
        """
        request = {"index": index, "extended_to": budget}
        if self.known(request, bool) is None:
            self.add(request, True)

    def hold(self, action: Callable[[], None]) -> None:
        """Do something once the program asks for what the journal has not: until then, its files may stay as they are.

        :param action: function that writes a part of what the program leaves behind
        """
        self._held.append(action)
        if not self.replaying:
            self.release()

    def release(self) -> None:
        """Do what is held back."""
        held, self._held = self._held, []
        for action in held:
            action()

    def check_asked(self) -> None:
        """Refuse a program that has come to its end without asking for all that the journal has.

        :raises ResumeError: if there is more
        """
        if self._known:
            raise self._other_request({}, self._known[min(self._known)])

    def _read(self) -> None:
        if (size := os.fstat(self._file.fileno()).st_size) > self._most_bytes:
            raise ResumeError(
                f"{self._path} has {size} bytes, but such a {self._kind.name} writes at most {self._most_bytes}"
            )
        expected = _signed(self._origin, _hash)
        with open(self._path, "rb") as reader:
            first = reader.readline(LONGEST_ROW)
            if not expected.startswith(first) or first == expected:
                self._check_first_row(first)
                self._seed = int(first[:8], 16)
                self._read_rows(reader)
                return
        self.is_new = True
        self._file.truncate(0)
        self._append(expected)
        self._seed = int(expected[:8], 16)

    def _check_first_row(self, first: bytes) -> None:
        there = _read_signed(first, _hash)
        if there is None:
            raise self._refusal(
                f"the first row of {self._path.name}, which says with what the {self._kind.name} was begun, is damaged "
                "or missing"
            )
        if different := differences(self._origin, there, f"in this {self._kind.name}"):
            has_them = quoted(self._path.with_name(self._kind.specification))
            raise self._refusal(f"{different}: put that back, or begin anew ({has_them} has the settings)")

    def _read_rows(self, reader: BinaryIO) -> None:
        damaged, whole = 0, reader.tell()
        while line := reader.readline(LONGEST_ROW):
            has_end = line.endswith(b"\n")
            row = _read_signed(line, self._checksum) if has_end else None
            whole = reader.tell() if has_end else whole
            if row is None or type(row.get("index")) is not int:
                damaged += 1
            else:
                self._known[row["index"]] = row
        if damaged:
            self._file.truncate(whole)  # a row that was cut has no end
            _log.warning("%s: damaged rows: %d; what they have is asked for again", self._path, damaged)

    def _checksum(self, text: bytes) -> bytes:
        """What signs a row but the first."""
        return b"%08x" % zlib.crc32(text, self._seed)

    def _append(self, row: bytes) -> None:
        """Append a row as a whole."""
        left = memoryview(row)
        while left:  # a disk that is nearly full takes only a part
            left = left[self._file.write(left) :]
        os.fsync(self._file.fileno())

    def _other_request(self, here: Mapping[str, Any], there: Mapping[str, Any]) -> ResumeError:
        """Error of a program that does not ask what it asked before."""
        budgets = [request.get("extended_to") for request in (there, here)]
        if any(budgets):
            was, would = (f"extended to {budget:g}" if budget else "not extended" for budget in budgets)
            return self._refusal(f"it was {was} there, and would be {would} here")
        return ResumeError(
            f"{self._path.parent} cannot be resumed here: it does not repeat what it did before its interruption, as "
            "the kind of processor differs, or something else that arithmetic depends on"
        )

    def _refusal(self, reason: str) -> ResumeError:
        return ResumeError(f"{self._path.parent} cannot be resumed: {reason}")


def _signed(row: Mapping[str, Any], sign: Callable[[bytes], bytes]) -> bytes:
    """A row: what signs it, and a JSON object."""
    text = json.dumps(row, allow_nan=False, separators=(",", ":")).encode()
    return b"%s %s\n" % (sign(text), text)


def _read_signed(line: bytes, sign: Callable[[bytes], bytes]) -> dict[str, Any] | None:
    """Values of a row; ``None`` if it is damaged."""
    signature, _, text = line.rstrip(b"\n").partition(b" ")
    try:
        value = json.loads(text) if signature == sign(text) else None
    except (ValueError, RecursionError):
        return None
    return value if isinstance(value, dict) else None


def _hash(text: bytes) -> bytes:
    """What signs the first row."""
    return hashlib.sha256(text).hexdigest()[:16].encode()
