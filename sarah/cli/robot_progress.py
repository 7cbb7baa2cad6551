"""What ``sarah-robot`` prints while a robot runs, and at the end."""

from __future__ import annotations

import contextlib
import math
import sys
import threading
from queue import SimpleQueue
from typing import TextIO

from sarah.control.pattern_generator import Phase
from sarah.control.supervisor import Supervisor
from sarah.drivers.driver import Driver
from sarah.drivers.loop import LoopTick
from sarah.drivers.real_time import LATE_SECONDS
from sarah.drivers.simulated_robot import SimulatedRobot
from sarah.episode.ending import ending_words
from sarah.robot.reading import SensorReading

PATIENCE_SECONDS = 1.0
"""Time to wait at the end for whoever reads, in s."""
MOST_LINES = 1000
"""Largest number of lines that wait; more are left out."""


class Printer:
    """Lines that a thread prints, so that whoever prints them never waits for a terminal that does not read."""

    def __init__(self) -> None:
        self._lines: SimpleQueue[tuple[str, TextIO] | None] = SimpleQueue()
        self._thread = threading.Thread(target=self._print, name="printer", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Print what is left, if somebody reads it."""
        self._lines.put(None)
        self._thread.join(PATIENCE_SECONDS)

    def say(self, line: str, file: TextIO) -> None:
        """Print a line.

        :param line: the line
        :param file: stream
        """
        if self._lines.qsize() < MOST_LINES:
            self._lines.put((line, file))

    def _print(self) -> None:
        while (said := self._lines.get()) is not None:
            line, file = said
            with contextlib.suppress(OSError, ValueError):  # nobody need read it
                print(line, file=file, flush=True)


class Progress(Printer):
    """Observer that prints a line a second, and what happened at the end.

    :param dt: control period, in s
    :param shows_signals: whether the lines show what the sensors say
    """

    seconds: float
    """Time of the last tick since the loop began, in s."""

    def __init__(self, dt: float, shows_signals: bool = False) -> None:
        super().__init__()
        self._dt, self._shows_signals = dt, shows_signals
        self._next = 1.0
        self._ticks = self._late = self._steps = self._steps_before = 0
        self._worst = self.seconds = 0.0

    def __call__(self, tick: LoopTick) -> None:
        """Count a tick, and print what the supervisor did."""
        self._ticks += 1
        self.seconds = tick.seconds
        if tick.late_seconds > LATE_SECONDS:
            self._late += 1
        self._worst = max(self._worst, tick.late_seconds)
        if tick.change is not None and tick.change.is_step:
            self._steps += 1
        controller = tick.controller
        if isinstance(controller, Supervisor) and controller.state_change is not None:
            reason = controller.state_change.reason
            self.say(f"{tick.seconds:8.2f} s  {controller.state.value}: {reason}", sys.stdout)
        if tick.seconds >= self._next - self._dt / 2:
            self._next += 1.0
            self._line(tick)

    def _line(self, tick: LoopTick) -> None:
        """Print a line of progress on standard error."""
        controller, steps = tick.controller, self._steps - self._steps_before
        self._steps_before = self._steps
        words = ["unsupervised"]
        if isinstance(controller, Supervisor):
            words = [controller.state.value, f"tilt {math.degrees(controller.torso_tilt):.0f}°"]
        words[0] += "" if controller.phase is Phase.STAND else f", {controller.phase.value}"
        words += [f"{steps} steps per second", f"{self._late} late ticks"]
        if self._shows_signals:
            words += ["no reading"] if tick.reading is None else _signals(tick.reading)
        self.say(f"{tick.seconds:8.2f} s  {'; '.join(words)}", sys.stderr)

    def report(self, driver: Driver, is_real_time: bool) -> None:
        """Print what happened.

        :param driver: driver of the robot
        :param is_real_time: whether ticks had deadlines
        """
        print(f"{self._ticks} ticks in {self.seconds + self._dt:.2f} s, {self._steps} steps")
        if is_real_time:
            print(f"{self._late} ticks later than {1000 * LATE_SECONDS:g} ms; the worst by {1000 * self._worst:.2f} ms")
        if isinstance(driver, SimulatedRobot):
            x, y, _ = driver.result().final_position
            print(f"the robot is {100.0 * math.hypot(x, y):.0f} cm from where it began")
        if driver.ended and driver.ended != "time_limit":
            print(f"the robot ended: {ending_words(driver.ended)}")


def _signals(reading: SensorReading) -> list[str]:
    """What the sensors say, in words."""
    acceleration, angular_rate = (" ".join(f"{value:+.2f}" for value in signal) for signal in reading[:2])
    left_fore, left_hind, right_fore, right_hind = reading.pressures
    loads = f"{left_fore + left_hind:.0f} {right_fore + right_hind:.0f}"
    joints = " ".join(f"{value:+.2f}" for value in reading.joints)
    return [f"acceleration {acceleration}", f"angular rate {angular_rate}", f"loads {loads}", f"joints {joints}"]
