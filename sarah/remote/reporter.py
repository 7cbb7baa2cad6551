"""Telemetry of a control loop, twenty times a second."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

from sarah.control.supervisor import Supervisor
from sarah.drivers.loop import LoopTick
from sarah.drivers.real_time import LATE_SECONDS
from sarah.operation.settings import PARAMETERS
from sarah.remote.answers import Telemetry
from sarah.remote.moment import present
from sarah.robot.reading import SensorReading

RATE = 20.0
"""Telemetry per second."""
STEP_SECONDS = 2.0
"""Time over which steps are counted, in s."""


class Reporter:
    """Makes telemetry of the ticks of a control loop.

    :param clock: clock, in s
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock, self._next = clock, -1.0
        self._ticks = self._late = 0
        self._steps: deque[float] = deque()
        self._reason = ""

    def tick(self, tick: LoopTick, supervisor: Supervisor) -> bool:
        """Count a tick.

        :param tick: what happened in it
        :param supervisor: controller of the loop
        :return: whether it is time for telemetry
        """
        self._ticks += 1
        self._late += tick.late_seconds > LATE_SECONDS
        if tick.change is not None and tick.change.is_step:
            self._steps.append(tick.seconds)
        while self._steps and self._steps[0] <= tick.seconds - STEP_SECONDS:
            self._steps.popleft()
        if supervisor.state_change is not None:
            self._reason = supervisor.state_change.reason
        now = self._clock()
        is_due = now >= self._next
        if is_due:
            following = self._next + 1.0 / RATE
            self._next = following if following > now else now + 1.0 / RATE
        return is_due

    def telemetry(self, tick: LoopTick, supervisor: Supervisor) -> Telemetry:
        """Telemetry of the tick that was counted last.

        :param tick: what happened in it
        :param supervisor: controller of the loop
        """
        names = [parameter.name for parameter in PARAMETERS]
        return Telemetry(
            self._ticks - 1,
            round(tick.seconds, 4),
            supervisor.state.value,
            self._reason,
            supervisor.phase.value,
            len(self._steps) / STEP_SECONDS,
            round(supervisor.tilt, 4),
            dict(zip(names, present(supervisor), strict=True)),
            self._late,
            supervisor.stance.value,
            _signals(tick.reading),
        )


def _signals(reading: SensorReading | None) -> dict[str, list[float]] | None:
    """Signals of a reading that is whole."""
    if reading is None or not reading.is_finite:
        return None
    return {name: [round(float(value), 5) for value in signal] for name, signal in reading._asdict().items()}
