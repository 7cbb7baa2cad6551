"""Real time: ticks that begin at absolute deadlines, and a process that is disturbed as little as can be."""

from __future__ import annotations

import contextlib
import gc
import os
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence

SPIN_SECONDS = 0.0005
"""Time before a deadline from which the loop waits without sleeping, in s: as inexact as sleeping is."""
PRIORITY = 50
"""Priority in the real-time scheduling class."""
SWITCH_SECONDS = 0.0005
"""Time for which another thread may hold the interpreter, in s."""
LATE_SECONDS = 0.002
"""Time after its deadline from which a tick counts as late, in s."""


class RealTime:
    """Absolute deadlines, one each control period from the first tick on. Those that have passed are left out.

    :param dt: control period, in s
    :param clock: clock, in s
    :param sleep: function that sleeps for a time in s
    """

    def __init__(
        self, dt: float, clock: Callable[[], float] = time.monotonic, sleep: Callable[[float], None] = time.sleep
    ) -> None:
        self._dt, self._clock, self._sleep = dt, clock, sleep
        self._deadline: float | None = None

    def wait(self) -> float:
        """Wait for the next deadline, and return by how much the tick is late, in s."""
        now = self._clock()
        if self._deadline is None:
            self._deadline = now
            return 0.0
        self._deadline += self._dt
        if now < self._deadline:
            if self._deadline - now > SPIN_SECONDS:
                self._sleep(self._deadline - now - SPIN_SECONDS)
            while (now := self._clock()) < self._deadline:
                pass
        late = now - self._deadline
        self._deadline += self._dt * (late // self._dt)
        return late


@contextlib.contextmanager
def undisturbed(helpers: Sequence[threading.Thread] = ()) -> Iterator[str]:
    """Context in which this process is disturbed as little as the system grants.

    :param helpers: threads for which the loop may have to wait, because they hold the interpreter for moments; they
        come right behind this thread
    :return: how it is scheduled, in words
    """
    switch = sys.getswitchinterval()
    with _scheduled([thread.native_id or 0 for thread in helpers]) as words:
        sys.setswitchinterval(SWITCH_SECONDS)
        gc.freeze()
        gc.disable()
        try:
            yield words
        finally:
            gc.enable()
            gc.unfreeze()
            sys.setswitchinterval(switch)


@contextlib.contextmanager
def _scheduled(helpers: Sequence[int]) -> Iterator[str]:
    """Context in the real-time scheduling class, where the system has one and grants it."""
    priorities = {**dict.fromkeys(helpers, PRIORITY - 1), 0: PRIORITY}
    try:
        before = {thread: (os.sched_getscheduler(thread), os.sched_getparam(thread)) for thread in priorities}
        for thread, priority in priorities.items():
            os.sched_setscheduler(thread, os.SCHED_FIFO, os.sched_param(priority))
    except (OSError, AttributeError) as error:
        yield f"real-time scheduling is not granted ({error}): other processes can make ticks late"
        return
    try:
        yield f"real-time scheduling: SCHED_FIFO, priority {PRIORITY}"
    finally:
        for thread, (policy, parameter) in before.items():
            os.sched_setscheduler(thread, policy, parameter)
