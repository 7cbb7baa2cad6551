"""Ctrl-C and SIGTERM: the first signal stops after the present episode, the second one at once."""

from __future__ import annotations

import contextlib
import os
import signal
from types import FrameType, TracebackType
from typing import Any

SIGNALS = (signal.SIGINT, signal.SIGTERM)


class Interruption:
    """A context in which the first signal is only recorded, and the second has its usual effect.

    :param command: name of the command, for the message
    :param unit: what is completed before it stops, for the message
    """

    signal: int | None
    """Number of the signal that came; ``None`` before."""

    def __init__(self, command: str, unit: str = "episode") -> None:
        self.signal = None
        self._message = f"\n{command}: stopping when this {unit} is over; a second signal stops at once\n".encode()
        self._before: dict[int, Any] = {}

    def __enter__(self) -> Interruption:
        """Record signals from now on, except for those that the process ignores."""
        self._before = {number: signal.getsignal(number) for number in SIGNALS}
        for number, before in self._before.items():
            if before != signal.SIG_IGN:
                signal.signal(number, self._note)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Restore the usual effect of the signals."""
        for number, before in self._before.items():
            signal.signal(number, before)

    def came(self) -> bool:
        """Whether a signal has come."""
        return self.signal is not None

    def _note(self, number: int, frame: FrameType | None) -> None:
        self.signal = number
        self.__exit__(None, None, None)
        with contextlib.suppress(OSError):  # nobody need read it
            os.write(2, self._message)  # a handler must not use the buffers of print
