"""What a controller does, tick by tick, in a log: of a simulation, and of a control loop."""

from __future__ import annotations

from sarah.control.pattern_generator import Phase, PhaseChange
from sarah.control.supervisor import PUT_BACK, Controller, State, Supervisor
from sarah.drivers.loop import ControlLoop, LoopTick
from sarah.logs.robot_log import RobotLog
from sarah.robot.reading import SensorReading

REASONS = {"standing": "set upright", "stepping": "stood for a second", "fallen": "lay down"}
"""Reasons for the states of a robot that has no supervisor."""


class ControllerLog:
    """Ticks, phase changes and states of a controller, in a log.

    :param log: log
    """

    def __init__(self, log: RobotLog) -> None:
        self._log = log
        self._state = ""

    def tick(
        self,
        seconds: float,
        controller: Controller,
        change: PhaseChange | None,
        reading: SensorReading | None,
        reading_seconds: float,
        late_seconds: float = 0.0,
    ) -> None:
        """Log a tick, and the changes of phase and state in it. Times are since the run began.

        :param seconds: time of the tick, in s
        :param controller: controller, with its targets
        :param change: end of a phase in this tick
        :param reading: reading that it acted on; ``None`` if there was none
        :param reading_seconds: time at which the reading was taken, in s
        :param late_seconds: delay behind the tick's deadline, in s
        """
        if isinstance(controller, Supervisor):
            self._follow(controller, seconds)
        elif controller.has_fallen:
            self.enter(seconds, "fallen")
        else:
            self.enter(seconds, "standing" if controller.phase is Phase.STAND else "stepping")
        if change is not None:
            self._log.phase_change(seconds, change, controller.stance)
        self._log.tick(
            seconds=seconds,
            reading=reading,
            reading_seconds=reading_seconds,
            targets=controller.targets,
            state=self._state,
            phase=controller.phase,
            stance=controller.stance,
            tilt=controller.tilt,
            rate=controller.rate,
            late_seconds=late_seconds,
        )

    def enter(self, seconds: float, state: str, reason: str = "") -> None:
        """Log a new state; the present one is not logged again.

        :param seconds: time since the run began, in s
        :param state: state
        :param reason: reason of the change; by default that of a robot without a supervisor
        """
        if state != self._state:
            self._log.state(seconds, state, self._state, reason or REASONS[state])
            self._state = state

    def _follow(self, supervisor: Supervisor, seconds: float) -> None:
        """Log what a supervisor did."""
        if not self._state:
            self.enter(seconds, State.STANDING.value)
        if supervisor.state_change is not None:
            state, before, reason = supervisor.state_change
            self._log.state(seconds, state.value, before.value, reason)
        self._state = supervisor.state.value


class _Parameters:
    """Parameters of a loop's robot: its own, when it has stood, and those that take their place."""

    def __init__(self, loop: ControlLoop, log: RobotLog, by: str) -> None:
        self._loop, self._log, self._by = loop, log, by
        self._present = loop.parameters, loop.balance

    def look(self, tick: LoopTick) -> None:
        """Log parameters that the robot was given in a tick."""
        loop, supervisor = self._loop, tick.controller
        if loop.ticks == loop.standing_ticks:
            self._applied(tick.seconds, 0.0, self._by, "")
        if loop.ticks < loop.standing_ticks or not isinstance(supervisor, Supervisor):
            return
        if supervisor.asked != self._present:
            self._present = supervisor.asked
            reason = supervisor.state_change.reason if supervisor.state_change else ""
            by, why = ("supervisor", reason) if reason.startswith(PUT_BACK) else ("push", "")
            self._applied(tick.seconds, tick.seconds, by, why)

    def _applied(self, seconds: float, asked_seconds: float, by: str, reason: str) -> None:
        stepping, balance = self._present
        self._log.parameters(seconds, {**vars(stepping), **vars(balance)}, asked_seconds, by, True, reason)


def log_loop(loop: ControlLoop, log: RobotLog, by: str) -> None:
    """Log a control loop from its next tick on.

    :param loop: control loop
    :param log: log
    :param by: name of who gives the robot its own parameters
    """
    controller_log, parameters = ControllerLog(log), _Parameters(loop, log, by)

    def observe(tick: LoopTick) -> None:
        parameters.look(tick)
        taken = tick.seconds - tick.age
        controller_log.tick(tick.seconds, tick.controller, tick.change, tick.reading, taken, tick.late_seconds)

    loop.observers = (*loop.observers, observe)
