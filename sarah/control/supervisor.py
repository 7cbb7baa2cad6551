"""The supervisor: a pattern generator that stops by itself when something fails.

It has four states::

    STANDING   the targets are zero: before the first step, and after a stop until it is asked to step
    STEPPING   the pattern generator moves the targets, and the watches look; while readings are missing, the targets
               go to zero
    STOPPING   the targets go to zero, as fast as the controller moves them
    FALLEN     the targets stay where they are

It is plain Python of the standard library, and knows no clock: readings and times go in, targets and state come out.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from enum import Enum
from typing import NamedTuple

from sarah.control.constants import STANDARD_CONSTANTS, ControllerConstants
from sarah.control.hearing import Hearing
from sarah.control.hip_law import LOCKED_HIPS, NO_LIMITS, BalanceParameters
from sarah.control.pattern_generator import PatternGenerator, Phase, PhaseChange, SteppingParameters
from sarah.control.supervisor_settings import STANDARD_SUPERVISOR, SupervisorSettings
from sarah.control.targets import STANDING_TARGETS, towards
from sarah.control.watches import Watches
from sarah.robot.reading import SensorReading, Side, Targets

PUT_BACK = "the parameters before are back"
"""Beginning of the reason for which parameters were replaced by the last ones that worked."""
ASKED_TO_STAND = "asked to stand"
"""Reason for which a supervisor stops that somebody asked to."""
PROVEN_SECONDS = 5.0
"""Time of stepping after which new parameters count as working, in s."""


class State(Enum):
    """State of a supervised robot."""

    STANDING = "standing"
    STEPPING = "stepping"
    STOPPING = "stopping"
    FALLEN = "fallen"


class StateChange(NamedTuple):
    """What a supervisor did in a tick.

    :param state: state that it is in now
    :param before: state that it was in
    :param reason: reason for it
    """

    state: State
    before: State
    reason: str


class Supervisor:
    """A pattern generator with its watches. It takes the place of a generator: call :meth:`tick` once per period.

    :param parameters: values of P1 to P5
    :param balance: values of V1 to V4
    :param dt: control period, in s
    :param limits: lowest and highest position of the joints, in rad and m
    :param constants: constants of the controller
    :param settings: from when on something is a fault
    :raises ConfigurationError: as :class:`~sarah.control.pattern_generator.PatternGenerator` does
    """

    state: State
    """State that it is in."""
    state_change: StateChange | None
    """What it did in the last tick; most of the time, nothing."""
    targets: Targets
    """Joint targets in the order of ``ACTUATED_JOINTS``, in rad and m."""
    generator: PatternGenerator
    """Pattern generator, which is a new one each time that the robot begins to step."""
    asked: tuple[SteppingParameters, BalanceParameters]
    """Parameters that were set last; or the ones before, if the robot did not step with them."""

    def __init__(
        self,
        parameters: SteppingParameters,
        balance: BalanceParameters = LOCKED_HIPS,
        dt: float = 0.01,
        limits: Sequence[tuple[float, float]] = NO_LIMITS,
        constants: ControllerConstants = STANDARD_CONSTANTS,
        settings: SupervisorSettings = STANDARD_SUPERVISOR,
    ) -> None:
        self._dt, self._limits, self._settings = dt, limits, settings
        self.asked, self.constants = (parameters, balance), constants
        self._proven: tuple[SteppingParameters, BalanceParameters] | None = None
        self.state_change = None
        self.targets = STANDING_TARGETS
        self._hearing = Hearing(settings.stale_seconds)
        self._told, self._stopped_for = "", ""
        self._begin()

    def _begin(self) -> None:
        """Stand, with a new generator that steps after its second of standing."""
        self.generator = PatternGenerator(*self.asked, self._dt, self._limits, self.constants)
        self.state = State.STANDING
        self._watches = Watches(self._settings, self._dt, self.constants)
        self._is_to_step, self._stop_reason = True, ""
        self._stepped_seconds = 0.0
        self._is_paused, self._is_catching_up = False, self.targets != STANDING_TARGETS

    def set_parameters(
        self, parameters: SteppingParameters | None = None, balance: BalanceParameters | None = None
    ) -> None:
        """Take new parameters, at any time, as :meth:`PatternGenerator.set_parameters` does.

        If the robot then does not step, those that it stepped with before come back.

        :param parameters: values of P1 to P5; without them the present ones stay
        :param balance: values of V1 to V4; without them the present ones stay
        :raises ConfigurationError: if a value is not finite or of another type; all values stay as they were
        """
        self.generator.set_parameters(parameters, balance)
        asked = parameters or self.asked[0], balance or self.asked[1]
        if asked != self.asked:
            self.asked, self._stepped_seconds = asked, 0.0
            self._watches.forgive()

    def stand(self, reason: str = ASKED_TO_STAND) -> None:
        """Stop from the next tick on.

        :param reason: reason for it
        """
        self._is_to_step, self._stop_reason = False, reason

    def step(self) -> None:
        """Step again, after a second of standing with a new generator; without effect while it steps."""
        if self.state is State.STOPPING:
            self._is_to_step = True
        elif not self._is_to_step:
            self._begin()

    def tick(self, reading: SensorReading | None, seconds: float | None = None, age: float = 0.0) -> PhaseChange | None:
        """Advance by one control tick.

        :param reading: newest sensor reading; ``None`` if there is none
        :param seconds: measured time since the last tick, in s; by default, and if it is negative or no number, a
            control period
        :param age: age of the reading, in s
        :return: the phase change that this tick made, if it made one
        """
        self.state_change = None
        passed = self._dt if seconds is None or not 0.0 <= seconds < math.inf else seconds
        found, heard = self._hearing.hear(reading, age, passed)
        if self.state in (State.STANDING, State.STEPPING) and self._is_to_step:
            if self._hearing.is_stale:
                self._wait(passed)
                return None
            return self._control(found, heard, seconds, passed)
        self._stand_still(found, heard, passed)
        return None

    def _control(
        self, reading: SensorReading, heard: SensorReading, seconds: float | None, passed: float
    ) -> PhaseChange | None:
        """A tick of the generator, which the watches look at."""
        if self._is_paused and self.state is State.STANDING:
            self._begin()
        self._is_paused = False
        targets, phase = self.targets, self.generator.phase
        change = self.generator.tick(self._without_lost_joints(heard), seconds)
        wrong = self._watches.tick(reading, heard, passed, targets, phase, change)
        if change is not None and change.ended is Phase.STAND:
            self._told = ""
            self._enter(State.STEPPING, "stood for a second")
        if self.generator.has_fallen:
            self._enter(State.FALLEN, "fallen: the torso lies")
        elif wrong:
            self._react(wrong)
        elif self._watches.warnings.new and self.state_change is None:
            self._enter(self.state, f"warning: {self._watches.warnings.take()}")
        else:
            self._approve(passed)
        if self.state in (State.STANDING, State.STEPPING):
            self._follow(self.generator.targets)
        return change

    def _wait(self, seconds: float) -> None:
        """Stand while there is nothing to act on; the generator waits, or stands for a whole second afterwards."""
        if not self._is_paused:
            self._is_paused = self._is_catching_up = True
            self._enter(self.state, "no new reading: the targets go to zero until there is one")
        self.targets = towards(STANDING_TARGETS, self.targets, self.constants, self._dt)
        unheard = self._hearing.unheard_seconds
        if self.state is State.STEPPING and (wrong := self._watches.nothing_heard(unheard, seconds)):
            self._react(wrong)

    def _follow(self, goals: Targets) -> None:
        """Take the generator's targets, after a pause at the speeds of the controller."""
        if self._is_catching_up:
            self.targets = towards(goals, self.targets, self.constants, self._dt)
            self._is_catching_up = self.targets != goals
        else:
            self.targets = goals

    def _without_lost_joints(self, heard: SensorReading) -> SensorReading:
        """A reading in which joints that do not follow are at their targets: a wrong sensor is worse than none."""
        lost = self._watches.lost_joints
        if not lost:
            return heard
        joints = [self.targets[index] if index in lost else joint for index, joint in enumerate(heard.joints)]
        return heard._replace(joints=tuple(joints))  # type: ignore[arg-type]  # as long

    def _stand_still(self, reading: SensorReading, heard: SensorReading, seconds: float) -> None:
        """Stop if it steps, and stand; a robot that has fallen keeps its targets."""
        if self.state is State.STOPPING:
            self.targets = towards(STANDING_TARGETS, self.targets, self.constants, self._dt)
            if not any(self.targets):
                self._enter(State.STANDING, f"stopped: {self._stopped_for}")
                if self._is_to_step:
                    self._begin()
            return
        wrong = self._watches.tick_standing(reading, heard, seconds, self.targets)
        if self._stop_reason:
            self._enter(State.STOPPING if self.is_moving else self.state, self._stop_reason)
            self._stop_reason = ""
        elif wrong.startswith("tilt") and self.state is State.STANDING:
            self._enter(State.FALLEN, wrong)

    def _react(self, wrong: str) -> None:
        """Do what a fault asks for; before the first step, stand for another second."""
        proven = self._proven
        if self.state is State.STANDING:
            kind, _, _ = wrong.partition(":")
            if kind != self._told:  # a sensor that is dead from the beginning is told of once
                self._told = kind
                self._enter(State.STANDING, f"stands for another second: {wrong}")
            self._begin()
        elif wrong.startswith("tilt"):
            self._enter(State.FALLEN, wrong)
        elif wrong.startswith("no step") and proven is not None and proven != self.asked:
            self.set_parameters(*proven)
            self._enter(State.STEPPING, f"{PUT_BACK}: {wrong}")
        else:
            self._enter(State.STOPPING, wrong)

    def _approve(self, seconds: float) -> None:
        """Count the time for which the present parameters have worked."""
        if self.state is State.STEPPING:
            self._stepped_seconds += seconds
            if self._stepped_seconds > PROVEN_SECONDS:
                self._proven = self.asked

    def _enter(self, state: State, reason: str) -> None:
        self.state_change = StateChange(state, self.state, reason)
        self.state = state
        if state in (State.STOPPING, State.FALLEN):
            self._is_to_step = False
        if state is State.STOPPING:
            self._stopped_for = reason
        elif state is State.FALLEN:  # it does not step again with parameters that may have felled it
            self.asked = self._proven or self.asked

    @property
    def is_proven(self) -> bool:
        """Whether the robot has stepped with its present parameters for long enough, now or before."""
        return self._proven == self.asked

    @property
    def is_waiting(self) -> bool:
        """Whether it stands or has fallen, and steps only when it is asked to."""
        return self.state in (State.STANDING, State.FALLEN) and not self._is_to_step

    @property
    def is_moving(self) -> bool:
        """Whether its targets move, or are not yet those of standing."""
        return self.state in (State.STEPPING, State.STOPPING)

    @property
    def torso_tilt(self) -> float:
        """Tilt of the torso against standing, in rad, as it was when the watches looked last."""
        return self._watches.torso_tilt

    @property
    def is_upright(self) -> bool:
        """Whether the torso tilts by less than what is a fault."""
        return self.torso_tilt < self._settings.largest_tilt

    @property
    def phase(self) -> Phase:
        """Phase of the generator; STAND while the robot stops, stands or has fallen."""
        return self.generator.phase if self.state is State.STEPPING else Phase.STAND

    @property
    def stance(self) -> Side:
        """Leg that carries the robot, if it steps."""
        return self.generator.stance

    @property
    def swing(self) -> Side:
        """Other leg."""
        return self.generator.swing

    @property
    def has_fallen(self) -> bool:
        """Whether the robot has fallen."""
        return self.state is State.FALLEN

    @property
    def stable_x(self) -> float:
        """Low-passed lateral acceleration of the generator, in m/s^2."""
        return self.generator.stable_x

    @property
    def tilt(self) -> float:
        """Lateral acceleration towards the stance leg, in m/s^2; 0 while the generator does not run."""
        return 0.0 if self.is_waiting or self.state is State.STOPPING else self.generator.tilt

    @property
    def rate(self) -> float:
        """Angular rate about y towards the stance leg, in rad/s."""
        return self.generator.rate


Controller = PatternGenerator | Supervisor
"""What turns readings into targets, tick by tick."""
