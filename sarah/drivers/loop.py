"""The control loop: read, decide, send, a control period after the other."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

from sarah.control.hip_law import LOCKED_HIPS, BalanceParameters
from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import STAND_SECONDS, PatternGenerator, PhaseChange, SteppingParameters
from sarah.control.supervisor import Controller, Supervisor
from sarah.drivers.driver import Driver
from sarah.episode.robot_settings import RobotSettings
from sarah.robot.reading import SensorReading

SPIN_SECONDS = 0.0005
"""Time before a deadline from which the loop waits without sleeping, in s: as inexact as sleeping is."""

LATE_SECONDS = 0.002
"""Time after its deadline from which a tick counts as late, in s."""


class LoopTick(NamedTuple):
    """What happened in a tick of the loop.

    :param seconds: time since the loop began, in s
    :param reading: newest reading; ``None`` if there is none
    :param age: age of the reading, in s
    :param controller: controller, with its targets
    :param change: end of a phase in this tick
    :param late_seconds: time by which the tick began after its deadline, in s
    """

    seconds: float
    reading: SensorReading | None
    age: float
    controller: Controller
    change: PhaseChange | None
    late_seconds: float


LoopObserver = Callable[[LoopTick], None]
"""Function that is called in each tick, before the targets are sent."""


def controller_for(config: RobotSettings, limits: Sequence[tuple[float, float]]) -> Controller:
    """Make the controller of a robot, which has the paper's parameters until it is given others.

    :param config: settings, with those of controller and supervisor
    :param limits: lowest and highest position of the joints, in rad and m
    """
    stepping, dt = SteppingParameters(*PAPER_STEPPING), config.physics.control_dt
    if config.supervisor.enabled:
        return Supervisor(stepping, LOCKED_HIPS, dt, limits, config.controller, config.supervisor)
    return PatternGenerator(stepping, LOCKED_HIPS, dt, limits, config.controller)


class Pacing(Protocol):
    """What waits for the next tick."""

    def wait(self) -> float:
        """Wait for the next tick, and return by how much it is late, in s."""


class Lockstep:
    """No waiting: the next tick begins at once."""

    def wait(self) -> float:
        """Do not wait."""
        return 0.0


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


@dataclass
class ControlLoop:
    """A robot and its controller, tick by tick. The controller is given its parameters when the robot has stood.

    :param driver: driver of the robot
    :param controller: controller
    :param parameters: values of P1 to P5
    :param balance: values of V1 to V4
    :param dt: control period, in s
    :param pacing: what waits for the next tick
    :param observers: functions that are called in each tick
    :param is_read_only: whether nothing is sent to the robot
    """

    driver: Driver
    controller: Controller
    parameters: SteppingParameters
    balance: BalanceParameters
    dt: float
    pacing: Pacing
    observers: Sequence[LoopObserver] = ()
    is_read_only: bool = False

    def __post_init__(self) -> None:
        """Begin before the first tick."""
        self.ticks = 0
        """Number of ticks so far."""
        self._standing_ticks = round(STAND_SECONDS / self.dt)
        self._began = self._last = 0.0

    def tick(self) -> bool:
        """Wait for the next tick, and make it.

        :return: whether the robot goes on
        """
        late = self.pacing.wait()
        driver, controller = self.driver, self.controller
        taken = driver.read()
        if driver.ended:
            return False
        now = driver.now()
        if self.ticks == 0:
            self._began, self._last = now, now - self.dt
        if self.ticks == self._standing_ticks:
            controller.set_parameters(self.parameters, self.balance)
        passed, self._last = now - self._last, now
        reading, age = (None, 0.0) if taken is None else (taken.reading, now - taken.taken)
        change = _decide(controller, reading, passed, age)
        tick = LoopTick(now - self._began, reading, age, controller, change, late)
        for observer in self.observers:
            observer(tick)
        if not self.is_read_only:
            driver.send(controller.targets)
        self.ticks += 1
        return True

    def run(self) -> None:
        """Make ticks until the robot ends."""
        while self.tick():
            pass


def _decide(controller: Controller, reading: SensorReading | None, passed: float, age: float) -> PhaseChange | None:
    """End of a phase in a tick of the controller; one without a supervisor is not told the age of its reading."""
    if isinstance(controller, Supervisor):
        return controller.tick(reading, passed, age)
    return None if reading is None else controller.tick(reading, passed)
