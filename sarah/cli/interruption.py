"""The end of a command before its time: by Ctrl-C, SIGTERM or a mistake. Its last words say how to go on."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from types import FrameType

from sarah.errors import ResumeError, RunFolderError, SarahError, TaskError, TrainingInterruptedError

SIGNALS = (signal.SIGINT, signal.SIGTERM)


@contextlib.contextmanager
def first_signal_noted(message: str, signals: Sequence[signal.Signals] = SIGNALS) -> Iterator[Callable[[], bool]]:
    """Context in which the first signal is only recorded, and the second has its usual effect.

    :param message: line to print on standard error at the first one
    :param signals: signals for which this holds
    :return: function that says whether a signal has come
    """
    before = {number: signal.getsignal(number) for number in signals}
    came: list[int] = []

    def restore() -> None:
        for number, usual in before.items():
            signal.signal(number, usual)

    def note(number: int, frame: FrameType | None) -> None:
        came.append(number)
        restore()
        with contextlib.suppress(OSError):  # nobody need read it
            os.write(2, f"\n{message}\n".encode())  # a handler must not use the buffers of print

    for number, usual in before.items():
        if usual != signal.SIG_IGN:
            signal.signal(number, note)
    try:
        yield lambda: bool(came)
    except (TrainingInterruptedError, KeyboardInterrupt) as error:
        error.args = (came[0] if came else signal.SIGINT,)
        raise
    finally:
        restore()


@contextlib.contextmanager
def interruptible(command: str, unit: str, go_on: str) -> Iterator[Callable[[], bool]]:
    """The same for what is completed, and can go on.

    :param command: name of the command, for the messages
    :param unit: what is completed before it stops, for the messages
    :param go_on: words for how to go on
    :return: function that says whether a signal has come
    :raises RunFolderError: for whatever else stops it but a folder that cannot be resumed or a mistake in a task's file
    """
    message = f"{command}: stopping when this {unit} is over; a second signal stops at once"
    try:
        with first_signal_noted(message) as came:
            yield came
    except (TrainingInterruptedError, KeyboardInterrupt) as error:
        print(f"\n{command}: interrupted; {go_on}", file=sys.stderr)
        raise SystemExit(128 + error.args[0]) from None
    except (ResumeError, TaskError):
        raise
    except (SarahError, OSError) as error:
        raise RunFolderError(f"{error}; finished {unit}s are kept, {go_on}") from error
