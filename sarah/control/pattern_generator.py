"""The sensor-driven central pattern generator: sensor readings in, joint targets out.

A reconstruction of the paper's Figure 3, which is not public. The robot rocks from foot to foot about the torso's
y axis, and the sensors, not a clock, decide when each phase of a step ends::

    STAND   for the first second                                                             -> SHIFT
    SHIFT   the swing leg pushes the robot over the stance leg                              -> LIFT
            until tilt > P2, rate > 0.2 P3 and the stance foot is loaded, or 0.5 (1 + P5) s
    LIFT    the swing leg retracts                                                           -> LAND
            until rate < -P1 (the robot rocks back), or 0.5 (1 + P4) s
    LAND    both legs straight                                                               -> SHIFT, legs swapped
            until the swing foot is loaded, or 0.5 (1 + P5) s

Tilt is the low-passed lateral acceleration and rate the low-passed angular rate about y, both positive towards the
stance leg and without their slow baselines. The hip law's abduction, which the torso does not feel, is added to both.
The time-outs are slow on
purpose: with faster ones a learner uses them as an open-loop clock and ignores the sensors (``make results NAME=clock``
compares 0.3 s and 0.5 s). The code uses plain floats only, because it runs once per control tick, and on a robot.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from sarah.control.baselines import Baselines
from sarah.control.constants import STANDARD_CONSTANTS, ControllerConstants
from sarah.control.hip_law import HipLaw
from sarah.robot.filters import LowPass, ramped
from sarah.robot.reading import SensorReading, Side

STAND_SECONDS = 1.0
"""Duration of standing before the robot begins to step, in s; it is the paper's."""


class Phase(Enum):
    """Phase of the state machine."""

    STAND = "stand"
    SHIFT = "shift"
    LIFT = "lift"
    LAND = "land"


@dataclass(frozen=True)
class SteppingParameters:
    """The five parameters of the First Training, each between 0 and 2.

    :param P1: rate of rocking back at which the swing foot is put down, in rad/s
    :param P2: tilt (lateral acceleration) over the stance leg at which the swing foot may leave, in m/s^2
    :param P3: five times the rate towards the stance leg at which it may leave, in rad/s
    :param P4: stretch of the time-out of LIFT
    :param P5: stretch of the time-outs of SHIFT and LAND
    """

    P1: float
    P2: float
    P3: float
    P4: float
    P5: float


@dataclass(frozen=True)
class PhaseChange:
    """The end of a phase.

    :param ended: phase that ended
    :param by_sensors: whether its sensor condition ended it, and not its time-out
    :param is_step: whether it completed a step, in which a swing foot that was off the floor has landed
    """

    ended: Phase
    by_sensors: bool
    is_step: bool = False


class PatternGenerator:
    """State machine that makes the steps. Call :meth:`tick` once per control tick with a new reading.

    :param parameters: values of P1 to P5
    :param pad_threshold: load above which a foot counts as loaded, in N
    :param dt: control period, in s
    :param hips: hip law; without one the hips are locked, as in the First Training
    :param constants: time-outs, lengths, speeds and time constants of the controller
    """

    stance: Side
    """Leg that carries the robot."""
    swing: Side
    """Other leg, which moves."""

    def __init__(
        self,
        parameters: SteppingParameters,
        pad_threshold: float = 30.0,
        dt: float = 0.01,
        hips: HipLaw | None = None,
        constants: ControllerConstants = STANDARD_CONSTANTS,
    ) -> None:
        self.parameters = parameters
        self.constants = constants
        self.hips = hips
        self.phase = Phase.STAND
        self.stance, self.swing = Side.RIGHT, Side.LEFT
        self._pad_threshold = pad_threshold
        self._dt = dt
        self._ticks_in_phase = 0
        self._swing_foot_was_off = False
        self._baselines = Baselines(dt, constants)
        self._stable_x = LowPass(constants.tilt_time_constant, dt)
        self._rate_y = LowPass(constants.rate_time_constant, dt)
        self._lengths = {Side.LEFT: 0.0, Side.RIGHT: 0.0}
        self._loads = {Side.LEFT: 0.0, Side.RIGHT: 0.0}

    @property
    def stable_x(self) -> float:
        """Low-passed lateral acceleration without its baseline, in m/s^2 (the paper's stable_X)."""
        return self._stable_x.value

    @property
    def tilt(self) -> float:
        """Lateral acceleration towards the stance leg, in m/s^2; leaning over that leg is positive.

        Abduction keeps the torso upright while the legs lean, and counts as tilt too.
        """
        sway = 0.0 if self.hips is None else self.hips.sway
        return self.stance.value * (self.constants.abduction_tilt * sway - self._stable_x.value)

    @property
    def rate(self) -> float:
        """Angular rate about y towards the stance leg, in rad/s, with a share of the abduction's rate."""
        abduction_rate = 0.0 if self.hips is None else self.hips.abduction_rate
        return self.stance.value * (self._rate_y.value + self.constants.abduction_rate_share * abduction_rate)

    def sense(self, reading: SensorReading) -> None:
        """Filter one reading without acting on it, as while standing.

        :param reading: sensor reading of this tick; one that is not finite is ignored
        """
        if not reading.is_finite:
            return
        reading = self._baselines.corrected(reading, self.phase is Phase.STAND)
        self._stable_x(reading.acceleration[0])
        self._rate_y(reading.angular_rate[1])
        left_fore, left_hind, right_fore, right_hind = reading.pressures
        self._loads[Side.LEFT] = left_fore + left_hind
        self._loads[Side.RIGHT] = right_fore + right_hind
        if self.hips is not None:
            self.hips.sense(reading)

    def tick(self, reading: SensorReading) -> PhaseChange | None:
        """Advance by one control tick.

        :param reading: sensor reading of this tick
        :return: the phase change that this tick made, if it made one; :attr:`targets` follow the new phase
        """
        self.sense(reading)
        self._ticks_in_phase += 1
        if self.phase in (Phase.LIFT, Phase.LAND) and not self._is_loaded(self.swing):
            self._swing_foot_was_off = True
        change = self._phase_change()
        if change is not None:
            self._enter_next_phase()
        self._ramp_legs()
        if self.hips is not None:
            self.hips.tick()
        return change

    @property
    def targets(self) -> tuple[float, float, float, float, float, float]:
        """Joint targets in the order of ``ACTUATED_JOINTS``, in rad and m."""
        left, right = self._lengths[Side.LEFT], self._lengths[Side.RIGHT]
        if self.hips is None:
            return (0.0, 0.0, 0.0, 0.0, left, right)
        abduction, flexion = self.hips.abduction, self.hips.flexion
        return (abduction, abduction, flexion[Side.LEFT], flexion[Side.RIGHT], left, right)

    def _phase_change(self) -> PhaseChange | None:
        elapsed = self._ticks_in_phase * self._dt
        if self.phase is Phase.STAND:
            return PhaseChange(Phase.STAND, by_sensors=False)
        if elapsed < self.constants.minimum_phase_seconds - self._dt / 2:
            return None
        by_sensors = self._condition_holds()
        if not by_sensors and elapsed < self.time_out(self.phase) - self._dt / 2:
            return None
        is_step = self.phase is Phase.LAND and by_sensors and self._swing_foot_was_off
        return PhaseChange(self.phase, by_sensors, is_step)

    def _condition_holds(self) -> bool:
        """Whether the sensors end the present phase."""
        parameters = self.parameters
        if self.phase is Phase.SHIFT:
            is_over_stance = self.tilt > parameters.P2 and self.rate > self.constants.rate_scale * parameters.P3
            return is_over_stance and self._is_loaded(self.stance)
        if self.phase is Phase.LIFT:
            return self.rate < -parameters.P1
        return self._is_loaded(self.swing)

    def time_out(self, phase: Phase) -> float:
        """Longest duration of a phase, in s.

        :param phase: SHIFT, LIFT or LAND
        """
        stretch = self.parameters.P4 if phase is Phase.LIFT else self.parameters.P5
        return self.constants.time_out_seconds * (1.0 + stretch)

    def _enter_next_phase(self) -> None:
        if self.phase is Phase.LAND:
            self.stance, self.swing = self.swing, self.stance
        self.phase = {Phase.SHIFT: Phase.LIFT, Phase.LIFT: Phase.LAND}.get(self.phase, Phase.SHIFT)
        self._ticks_in_phase = 0
        if self.phase is Phase.SHIFT:
            self._swing_foot_was_off = False

    def _is_loaded(self, side: Side) -> bool:
        return self._loads[side] > self._pad_threshold

    def _ramp_legs(self) -> None:
        """Move both leg length targets towards those of the phase; positive lengths retract."""
        constants = self.constants
        swing_length = 0.0
        if self.phase is Phase.SHIFT:
            swing_length = -constants.shift_extension
        elif self.phase is Phase.LIFT:
            swing_length = constants.lift_retraction
        largest = constants.leg_speed * self._dt
        lengths, swing, stance = self._lengths, self.swing, self.stance
        lengths[swing] = ramped(lengths[swing], swing_length, largest)
        lengths[stance] = ramped(lengths[stance], 0.0, largest)
