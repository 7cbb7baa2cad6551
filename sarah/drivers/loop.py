"""The control loop: read, decide, send, a control period after the other."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

from sarah.control.hip_law import LOCKED_HIPS, BalanceParameters
from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import STAND_SECONDS, PatternGenerator, PhaseChange, SteppingParameters
from sarah.control.supervisor import Controller, Supervisor
from sarah.drivers.driver import Driver, check_first
from sarah.episode.robot_settings import RobotSettings
from sarah.robot.reading import SensorReading


class LoopTick(NamedTuple):
    """What happened in a tick of the loop.

    :param seconds: time since the loop began, in s, which never goes back
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
        self.standing_ticks = round(STAND_SECONDS / self.dt)
        """Number of ticks before the controller is given its parameters."""
        self._began = self._last = 0.0
        self._is_checked = False

    def tick(self) -> bool:
        """Wait for the next tick, and make it.

        :return: whether the robot goes on
        """
        late = self.pacing.wait()
        driver, controller = self.driver, self.controller
        taken = driver.read()
        if driver.ended:
            return False
        now = float(driver.now())  # a clock of numpy's would be in all that is logged and sent
        if taken is not None and not self._is_checked:
            check_first(taken, now, self.dt)
            self._is_checked = True
        if self.ticks == 0:
            self._began, self._last = now, now - self.dt
        if self.ticks == self.standing_ticks:
            controller.set_parameters(self.parameters, self.balance)
        passed, self._last = now - self._last, now
        if passed < 0.0:  # the clock has jumped back: the loop's time goes on
            self._began += passed - self.dt
        reading, age = (None, 0.0) if taken is None else (taken.reading, now - taken.taken)
        if not age >= -self.dt:  # of a clock that has jumped: nobody knows how old it is
            reading, age = None, 0.0
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
