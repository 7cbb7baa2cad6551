"""Ctrl-C and SIGTERM: what runs is finished first, and a second one stops at once."""

from __future__ import annotations

import os
import signal
from types import FrameType, TracebackType
from typing import Any

SIGNALS = (signal.SIGINT, signal.SIGTERM)


class Interruption:
    """A context in which the first signal is noted, and the second has its usual effect.

    :param command: its name, for the message
    """

    signal: int | None
    """The one that came."""

    def __init__(self, command: str) -> None:
        self.signal = None
        self._message = f"\n{command}: stopping when this simulation is over; once more stops at once\n".encode()
        self._before: dict[int, Any] = {}

    def __enter__(self) -> Interruption:
        """Note signals from now on, but for those that the process ignores."""
        self._before = {number: signal.getsignal(number) for number in SIGNALS}
        for number, before in self._before.items():
            if before != signal.SIG_IGN:
                signal.signal(number, self._note)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Give the signals their usual effect back."""
        for number, before in self._before.items():
            signal.signal(number, before)

    def came(self) -> bool:
        """Whether a signal has come."""
        return self.signal is not None

    def _note(self, number: int, frame: FrameType | None) -> None:
        self.signal = number
        self.__exit__(None, None, None)
        os.write(2, self._message)  # a handler must not use the buffers of print
