"""Standard streams of a command: its work goes on when nobody reads them, and its status says whether it was done."""

from __future__ import annotations

import contextlib
import errno
import io
import os
import select
import signal
import sys
from typing import Any

NAMES = {1: "stdout", 2: "stderr"}
"""Streams that a command writes to, by the number of their file."""
ENCODING_ERRORS = "backslashreplace"
"""What becomes of a letter that the encoding lacks, or of a byte of a file's name: it is escaped."""


class _Kept(io.FileIO):
    """A stream that takes everything. Once it cannot be written any more, it is as ``/dev/null``."""

    lost: OSError | None = None
    """Error with which the first text was lost."""

    def write(self, data: Any) -> int:
        """Write all of some bytes, to nowhere if need be."""
        content = memoryview(data).cast("B")
        left = content
        try:
            while left:
                written = super().write(left)
                if written is None:  # somebody has made it non-blocking, and its reader takes his time
                    select.select([], [self], [])
                left = left[written or 0 :]
        except OSError as error:
            self.lost = self.lost or error
            with contextlib.suppress(OSError):  # also for the engines, and for other programs that write there
                _put_null(self.fileno())
        return len(content)


def _put_null(number: int) -> None:
    null = os.open(os.devnull, os.O_RDWR)
    if null == number:
        os.set_inheritable(number, True)
    else:
        os.dup2(null, number)
        os.close(null)


def keep_streams() -> None:
    """Let this process have all standard streams, and let nothing that becomes of them stop it.

    A stream that is closed is as ``/dev/null``, so that no file gets its number. Whoever has put something else in the
    place of ``sys.stdout`` or ``sys.stderr`` keeps it.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            _put_null(number)
    sys.stdin = sys.stdin or os.fdopen(0, closefd=False)
    for number, name in NAMES.items():
        before = getattr(sys, name)
        if before is getattr(sys, f"__{name}__"):
            setattr(sys, name, _kept(number, before))


def _kept(number: int, before: Any) -> io.TextIOWrapper:
    """Stream over a file that is kept, and otherwise as the one before, if there was one."""
    kept = _Kept(number, "w", closefd=False)
    if before is None:
        return io.TextIOWrapper(kept, "utf-8", ENCODING_ERRORS, write_through=True)
    return io.TextIOWrapper(
        kept if before.write_through else io.BufferedWriter(kept),
        before.encoding,
        ENCODING_ERRORS,
        line_buffering=before.line_buffering,
        write_through=before.write_through,
    )


def check_output() -> None:
    """End the command if its output, which is all that it was asked for, was lost.

    :raises OSError: if it could not be written
    :raises SystemExit: quietly, with the usual status of Unix, if its reader has left
    """
    sys.stdout.flush()
    buffer = getattr(sys.stdout, "buffer", None)
    kept = getattr(buffer, "raw", buffer)
    error = kept.lost if isinstance(kept, _Kept) else None
    if error is None:
        return
    if error.errno == errno.EPIPE:
        raise SystemExit(128 + signal.SIGPIPE)
    raise OSError(error.errno, error.strerror, "standard output")
