"""The simulated robot as a driver: an episode whose controller is outside of it."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Sequence
from dataclasses import dataclass

from sarah.control.hip_law import LOCKED_HIPS
from sarah.control.pattern_generator import STAND_SECONDS, PhaseChange
from sarah.control.targets import STANDING_TARGETS, towards
from sarah.drivers.driver import Driver, TimedReading
from sarah.drivers.faults import FAULTS, Fault
from sarah.drivers.loop import ControlLoop, Lockstep, LoopObserver, LoopTick, Pacing, controller_for
from sarah.episode.ending import is_fallen
from sarah.episode.episode import Episode
from sarah.episode.result import EpisodeResult
from sarah.episode.robot_settings import conditions_put_up
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.task_answers import controller_of
from sarah.episode.tasks import Task
from sarah.robot.reading import ACTUATED_JOINTS, SensorReading, Targets, Vector

LIES_SECONDS = 2.0
"""Time for which a robot that goes on lies before it is set upright, in s: its supervisor has noticed by then."""


@dataclass(frozen=True)
class FaultPlan:
    """A fault and when it begins.

    :param fault: fault
    :param begin: time after standing at which it begins, in s
    """

    fault: Fault = FAULTS["none"]
    begin: float = 3.0


NO_FAULT = FaultPlan()
"""A robot of which nothing fails."""


class SimulatedRobot(Driver):
    """A robot in an episode. A control period passes each time that it is read again, with the targets sent last.

    In lockstep its clock is that of the simulation, so the period passes however long the controller takes. Otherwise
    its clock is the computer's, and whoever reads late finds that several periods have passed.

    :param config: settings of robot, world and episode
    :param seed: seed of the episode
    :param task: task whose episode it is
    :param plan: fault, and when it begins
    :param is_lockstep: whether time passes with the readings alone
    :param record_trace: whether to record every control tick after standing in a trace
    :param goes_on: whether it goes on where an episode would end: after a fall it is set upright, and nothing is
        recorded
    """

    def __init__(
        self,
        config: EpisodeConfig,
        seed: int,
        task: Task,
        plan: FaultPlan = NO_FAULT,
        is_lockstep: bool = True,
        record_trace: bool = False,
        goes_on: bool = False,
    ) -> None:
        if plan.fault.delay_seconds is not None:
            randomisation = dataclasses.replace(config.randomisation, delay_seconds=plan.fault.delay_seconds)
            config = dataclasses.replace(config, randomisation=randomisation)
        self.episode = Episode(config, seed, task, record_trace)
        """Episode of the robot, which knows what is true of it."""
        self.limits = [self.episode.robot.description.limits[joint] for joint in ACTUATED_JOINTS]
        self._dt, self._is_lockstep = config.physics.control_dt, is_lockstep
        self._constants = config.controller
        self._plan = plan
        self._first_wrong = round((STAND_SECONDS + plan.begin) / self._dt)
        self._standing_ticks = round(STAND_SECONDS / self._dt)
        self._ticks = 0
        self._targets = STANDING_TARGETS
        self._change: PhaseChange | None = None
        self._heard: SensorReading | None = None
        self._began: float | None = None
        self._goes_on, self._seed = goes_on, seed
        self._falls = self._lay_ticks = 0
        self._is_held_up = False

    @property
    def position(self) -> Vector:
        """True position of the torso's centre, in m."""
        return self.episode.robot.torso.position

    @property
    def has_fallen(self) -> bool:
        """Whether it lies, or its simulation has diverged."""
        robot = self.episode.robot
        return robot.termination is not None or is_fallen(robot.torso.upright(robot.vertical))

    @property
    def seconds(self) -> float:
        """Simulated time, in s."""
        return self._ticks * self._dt

    def now(self) -> float:
        """Simulated time in lockstep, or time since somebody asked for it first, in s."""
        if self._is_lockstep:
            return self.seconds
        self._began = time.monotonic() if self._began is None else self._began
        return time.monotonic() - self._began

    def read(self) -> TimedReading | None:
        """Let time pass, and read the sensors; ``None`` once the episode has ended."""
        if self._heard is None:
            self.now()  # from here on time passes
            return self._sensed()
        self._advance()
        sent = self._ticks
        while not self.ended and (self._is_missed() or self._has_fallen_behind()):
            self._sensed()
            if (self._ticks - sent) * self._dt >= self._plan.fault.to_zero_after:
                self._targets = towards(STANDING_TARGETS, self._targets, self._constants, self._dt)
            self._change = None
            self._advance()
            if self._goes_on and (self._ticks - sent) * self._dt >= self.episode.config.time_limit:
                self.ended = "time_limit"  # there are no ticks any more
        return self._sensed()

    def send(self, targets: Targets) -> None:
        """Set the targets of the period that begins."""
        self._targets = targets

    def decided(self, tick: LoopTick) -> None:
        """Learn what the controller decided, which rewards and recordings need.

        :param tick: what happened in a tick of the loop
        """
        self.episode.robot.generator, self._change = tick.controller, tick.change

    def result(self) -> EpisodeResult:
        """Result of the episode so far."""
        return self.episode.result()

    def close(self) -> None:
        """Give the physics engine's resources back."""
        self.episode.close()

    def _advance(self) -> None:
        """Let a control period pass."""
        if self._goes_on:
            self._go_on()
        elif self._ticks < self._standing_ticks:
            self.episode.robot.act(self._targets, self._change)
        else:
            self.episode.act(self._targets, self._change)
        self._ticks += 1
        if not self._goes_on:
            if self._ticks == self._standing_ticks:
                self.episode.record()
            self.ended = self.episode.termination or ""

    def _go_on(self) -> None:
        """Let a control period pass. Whoever puts a robot up holds its joints at zero until its targets are."""
        self._is_held_up = self._is_held_up and any(self._targets)
        targets = STANDING_TARGETS if self._is_held_up else self._targets
        if self.episode.termination is None:
            self.episode.robot.act(targets, self._change, self._push())
        self._lay_ticks = self._lay_ticks + 1 if self.has_fallen else 0
        if self._lay_ticks * self._dt >= LIES_SECONDS:
            self._put_up()

    def _push(self) -> Vector | None:
        """Force of the push now, in N, which comes once."""
        push = self.episode.push
        if push is None or not -self._dt / 2 <= self.seconds - push.begin < push.duration - self._dt / 2:
            return None
        return push.force

    def _put_up(self) -> None:
        """Put the robot where it began: it is the same, but for the noise of its sensors."""
        task, config = self.episode.task, self.episode.config
        self._falls, self._lay_ticks, self._is_held_up = self._falls + 1, 0, True
        self.episode.close()
        self.episode = Episode(config, self._seed, task, conditions=conditions_put_up(config, self._seed, self._falls))

    def _has_fallen_behind(self) -> bool:
        """Whether more than a period has passed by the clock since the simulated time."""
        return not self._is_lockstep and self.now() > self.seconds + self._dt

    def _is_missed(self) -> bool:
        since = self._ticks - self._first_wrong
        return since >= 0 and self._plan.fault.misses(since * self._dt, since)

    def _sensed(self) -> TimedReading | None:
        """Reading that the controller hears."""
        if self.ended or not self.episode.robot.sense():
            if not self._goes_on:
                self.ended = self.episode.termination or ""
            return None
        reading, since = self.episode.robot.last_reading, self._ticks - self._first_wrong
        if self._heard is None or since < 0:
            self._heard = reading
        elif self._plan.fault.when(since * self._dt, since):
            reading = self._plan.fault.change(reading, self._heard)
        return TimedReading(reading, self.seconds)


def simulated_loop(
    spec: EpisodeSpec,
    plan: FaultPlan = NO_FAULT,
    pacing: Pacing | None = None,
    observers: Sequence[LoopObserver] = (),
    record_trace: bool = False,
    goes_on: bool = False,
) -> tuple[SimulatedRobot, ControlLoop]:
    """Make the control loop of an episode's robot. In lockstep it has the bytes of the episode as it is simulated.

    :param spec: specification of the episode
    :param plan: fault, and when it begins
    :param pacing: what waits for the next tick; by default ticks follow each other in lockstep
    :param observers: functions that are called in each tick
    :param record_trace: whether to record every control tick after standing in a trace
    :param goes_on: whether the robot goes on where an episode would end
    :return: the robot, and its loop
    """
    robot = SimulatedRobot(spec.config, spec.seed, spec.task, plan, pacing is None, record_trace, goes_on)
    stepping, balance = controller_of(spec.task, spec.parameters, spec.config)
    loop = ControlLoop(
        robot,
        controller_for(spec.config, robot.limits),
        stepping,
        balance or LOCKED_HIPS,
        spec.config.physics.control_dt,
        pacing or Lockstep(),
        (robot.decided, *observers),
    )
    return robot, loop
