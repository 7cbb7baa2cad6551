"""The sensor-driven central pattern generator: sensor readings in, joint targets out.

A reconstruction of the paper's Figure 3, which is not public. The robot rocks from foot to foot about the torso's
y axis, and the sensors, not a clock, decide when each phase of a step ends::

    STAND   for a second of readings                                                         -> SHIFT
    SHIFT   the swing leg pushes the robot over the stance leg                              -> LIFT
            until tilt > P2, rate > 0.01 P3 and the stance foot is loaded, or 0.5 (1 + P5) s
    LIFT    the swing leg retracts                                                           -> LAND
            until rate < -P1 (the robot rocks back), or 0.5 (1 + P4) s
    LAND    both legs straight                                                               -> SHIFT, legs swapped
            until the swing foot is loaded, or 0.5 (1 + P5) s

Tilt is the low-passed lateral acceleration and rate the low-passed angular rate about y, both positive towards the
stance leg and without their slow baselines. The hip law's abduction, which the torso does not feel, is added to both.
The time-outs are slow on purpose: with faster ones a learner uses them as an open-loop clock and ignores the sensors.
The code uses plain floats only, because it runs once per control tick, and on a robot.
"""

from __future__ import annotations

import contextlib
import copy
from collections.abc import Sequence
from dataclasses import astuple, dataclass
from enum import Enum

from sarah.control.baselines import Baselines
from sarah.control.constants import STANDARD_CONSTANTS, ControllerConstants
from sarah.control.hip_law import LOCKED_HIPS, NO_LIMITS, BalanceParameters, HipLaw
from sarah.errors import ConfigurationError, check_range, check_type, shortened
from sarah.number import is_finite, plain, to_floats
from sarah.robot.filters import LowPass, clipped, low_pass_gain, ramped
from sarah.robot.reading import ACTUATED_JOINTS, GRAVITY, SensorReading, Side, Targets

STAND_SECONDS = 1.0
"""Duration of standing before the robot begins to step, in s; it is the paper's."""
SHORTEST_PERIOD, LONGEST_PERIOD = 1e-4, 0.1
"""Ends of the range of control periods, in s. Beyond them, somebody has mistaken the unit."""
LONGEST_GAP = 1.0
"""Longest time between two ticks that counts, in s."""
LONGEST_BLOW = 0.03
"""Longest time that a single reading counts when a fall is recognised, in s: a blow at its limit is then no fall."""


class Phase(Enum):
    """Phase of the state machine."""

    STAND = "stand"
    SHIFT = "shift"
    LIFT = "lift"
    LAND = "land"


def _check_parameters(given: object, kind: type[SteppingParameters] | type[BalanceParameters]) -> None:
    if not isinstance(given, kind):
        raise ConfigurationError(f"parameters must be {kind.__name__}, not {given!r:.100}")
    if not all(map(is_finite, vars(given).values())):
        raise ConfigurationError(f"parameters must be finite numbers, not {given!r:.100}")


def _checked_limits(limits: Sequence[tuple[float, float]]) -> tuple[tuple[float, float], ...]:
    with contextlib.suppress(TypeError, ValueError):
        ranges = tuple((plain(low), plain(high)) for low, high in limits)
        if len(ranges) == len(ACTUATED_JOINTS) and all(low <= 0.0 <= high for low, high in ranges):
            return ranges
    raise ConfigurationError(f"limits must be {len(ACTUATED_JOINTS)} ranges around zero, not {shortened(limits)}")


@dataclass(frozen=True)
class SteppingParameters:
    """The five parameters of the First Training, each between 0 and 2.

    :param P1: rate of rocking back at which the swing foot is put down, in rad/s
    :param P2: tilt (lateral acceleration) over the stance leg at which the swing foot may leave, in m/s^2
    :param P3: a hundred times the rate towards the stance leg at which the swing foot may leave, in rad/s
    :param P4: longer time-out of LIFT, by the factor 1 + P4
    :param P5: longer time-outs of SHIFT and LAND, by the factor 1 + P5
    """

    P1: float
    P2: float
    P3: float
    P4: float
    P5: float

    def __post_init__(self) -> None:
        """Make floats of all of them."""
        to_floats(self, *self.__dataclass_fields__)


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
    """The controller of the robot. Call :meth:`tick` once per control period with a new reading, from standing on.

    It stands for its first second, in which it learns the baselines of its sensors, and then steps; a gap between two
    readings prolongs that second. A signal that is not finite keeps its last value. Once the robot has fallen, the
    targets stay where they are for good. A robot that has been set upright stands, and needs a new generator.

    :param parameters: values of P1 to P5
    :param balance: values of V1 to V4; zeros lock the hips, as in the First Training
    :param dt: control period, in s
    :param limits: lowest and highest position of the joints in the order of ``ACTUATED_JOINTS``, in rad and m, which no
        target leaves
    :param constants: time-outs, lengths, speeds and time constants of the controller
    :raises ConfigurationError: if a parameter is not finite or of another type, the period is not from 0.0001 to 0.1 s,
        or zero is not within a joint's limits
    """

    parameters: SteppingParameters
    """Values of P1 to P5."""
    hips: HipLaw
    """Hip law, with the values that V1 to V4 have at present."""
    stance: Side
    """Leg that carries the robot."""
    swing: Side
    """Other leg, which moves."""
    has_fallen: bool
    """Whether the torso has lain down: its vertical acceleration has been low for some tenths of a second."""

    def __init__(
        self,
        parameters: SteppingParameters,
        balance: BalanceParameters = LOCKED_HIPS,
        dt: float = 0.01,
        limits: Sequence[tuple[float, float]] = NO_LIMITS,
        constants: ControllerConstants = STANDARD_CONSTANTS,
    ) -> None:
        dt = float(check_range("dt", dt, SHORTEST_PERIOD, LONGEST_PERIOD, "s"))
        _check_parameters(parameters, SteppingParameters)
        _check_parameters(balance, BalanceParameters)
        limits = _checked_limits(limits)
        self.parameters = parameters
        check_type("constants", constants, ControllerConstants)
        self.constants = constants
        self.hips = HipLaw(balance, dt, constants, limits)
        self.phase = Phase.STAND
        self.stance, self.swing = Side.RIGHT, Side.LEFT
        self.has_fallen = False
        self._balance_goal = balance
        self._dt = dt
        self._limits = limits
        self._ticks_in_phase = 0
        self._rounded_off = 0.0
        self._swing_foot_was_off = False
        self._baselines = Baselines(dt, constants)
        self._stable_x = LowPass(constants.tilt_time_constant, dt)
        self._rate_y = LowPass(constants.rate_time_constant, dt)
        self._upright = GRAVITY
        self._lengths = {Side.LEFT: 0.0, Side.RIGHT: 0.0}
        self._limited_legs: set[int] = set()

    def __copy__(self) -> PatternGenerator:
        """Copy with filters of its own, as one that both had would feel the readings of both."""
        return copy.deepcopy(self)

    def set_parameters(
        self, parameters: SteppingParameters | None = None, balance: BalanceParameters | None = None
    ) -> None:
        """Take new parameters, at any time.

        P1 to P5 hold from the next tick on. While the robot steps, V1 to V4 move to their new values at the speed of
        ``balance_ramp``: a jump of V2 would feel like a push.

        :param parameters: values of P1 to P5; without them the present ones stay
        :param balance: values of V1 to V4; without them the present ones stay
        :raises ConfigurationError: if a value is not finite or of another type; all values stay as they were
        """
        stepping = self.parameters if parameters is None else parameters
        goal = self._balance_goal if balance is None else balance
        _check_parameters(stepping, SteppingParameters)
        _check_parameters(goal, BalanceParameters)
        self.parameters, self._balance_goal = stepping, goal
        if self.phase is Phase.STAND:
            self.hips.parameters = goal

    @property
    def stable_x(self) -> float:
        """Low-passed lateral acceleration without its baseline, in m/s^2 (the paper's stable_X)."""
        return self._stable_x.value

    @property
    def tilt(self) -> float:
        """Lateral acceleration towards the stance leg, in m/s^2; leaning over that leg is positive.

        Abduction keeps the torso upright while the legs lean, and counts as tilt too.
        """
        return self.stance.value * (self.constants.abduction_tilt * self.hips.sway - self._stable_x.value)

    @property
    def rate(self) -> float:
        """Angular rate about y towards the stance leg, in rad/s, with a share of the abduction's rate."""
        sway_rate = self.constants.abduction_rate_share * self.hips.abduction_rate
        return self.stance.value * (self._rate_y.value + sway_rate)

    def tick(self, reading: SensorReading, seconds: float | None = None) -> PhaseChange | None:
        """Advance by one control tick.

        :param reading: sensor reading of this tick; a signal that is not finite keeps its last value
        :param seconds: measured time since the last tick, in s; by default, and if it is negative or no number, a
            control period. It is rounded to whole periods, of which an early tick has none and does nothing; what was
            rounded off counts at the next tick
        :return: the phase change that this tick made, if it made one; :attr:`targets` follow the new phase
        """
        periods = self._periods(seconds)
        if periods == 0:
            return None
        self._sense(reading, periods)
        if self.has_fallen:
            return None
        self._ticks_in_phase += 1 if self.phase is Phase.STAND else periods
        if self.phase in (Phase.LIFT, Phase.LAND) and not self._is_loaded(self.swing):
            self._swing_foot_was_off = True
        change = self._phase_change()
        if change is not None:
            self._enter_next_phase()
        if self.phase is not Phase.STAND:
            self._ramp_balance(periods)
            self._ramp_legs(periods)
            self.hips.tick(periods)
        return change

    @property
    def targets(self) -> Targets:
        """Joint targets in the order of ``ACTUATED_JOINTS``, in rad and m."""
        abductions, flexion, lengths = self.hips.abductions, self.hips.flexion, self._lengths
        left, right = Side.LEFT, Side.RIGHT
        return (abductions[left], abductions[right], flexion[left], flexion[right], lengths[left], lengths[right])

    @property
    def limited_joints(self) -> tuple[str, ...]:
        """Names of the joints whose limits keep their targets from where the controller wants them."""
        return tuple(ACTUATED_JOINTS[joint] for joint in sorted(self.hips.limited | self._limited_legs))

    def _periods(self, seconds: float | None) -> int:
        """Control periods that this tick makes up for."""
        if seconds is None or not seconds >= 0.0:  # NaN is not either
            return 1
        self._rounded_off += min(seconds, LONGEST_GAP)
        periods = round(self._rounded_off / self._dt)
        self._rounded_off -= periods * self._dt
        return periods

    def _sense(self, reading: SensorReading, periods: int) -> None:
        is_standing = self.phase is Phase.STAND
        for period in range(periods):
            if period == 0 or not is_standing:  # a mean counts a reading once
                corrected = self._baselines.corrected(reading, is_standing)
            self._stable_x(corrected.acceleration[0])
            self._rate_y(corrected.angular_rate[1])
        self.hips.sense(corrected, periods)
        self._notice_a_fall(corrected.acceleration[2], periods)

    def _notice_a_fall(self, up: float, periods: int) -> None:
        """Low-pass the vertical acceleration, as far as a single reading is no fall."""
        constants = self.constants
        seconds = min(periods * self._dt, max(LONGEST_BLOW, self._dt))
        gain = low_pass_gain(constants.upright_time_constant, seconds)
        self._upright += gain * (clipped(up, constants.largest_blow) - self._upright)
        if self._upright < constants.least_upright:
            self.has_fallen = True

    def _phase_change(self) -> PhaseChange | None:
        elapsed = self._ticks_in_phase * self._dt
        if self.phase is Phase.STAND:
            return PhaseChange(Phase.STAND, by_sensors=False) if elapsed > STAND_SECONDS + self._dt / 2 else None
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
            return self.rate < -self.constants.landing_rate * parameters.P1
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
        return self.hips.loads[side] > self.constants.pad_threshold

    def _ramp_balance(self, periods: int) -> None:
        """Move V1 to V4 towards the values that were set last."""
        now, goal = self.hips.parameters, self._balance_goal
        if now is not goal:
            largest = self.constants.balance_ramp * self._dt * periods
            moved = BalanceParameters(
                *[ramped(*pair, largest) for pair in zip(astuple(now), astuple(goal), strict=True)]
            )
            self.hips.parameters = goal if moved == goal else moved

    def _ramp_legs(self, periods: int) -> None:
        """Move both leg length targets towards those of the phase; positive lengths retract."""
        constants = self.constants
        goals = {self.stance: 0.0, self.swing: 0.0}
        if self.phase is Phase.SHIFT:
            goals[self.swing] = -constants.shift_extension
        elif self.phase is Phase.LIFT:
            goals[self.swing] = constants.lift_retraction
        largest = constants.leg_speed * self._dt * periods
        self._limited_legs = set()
        for joint, side in enumerate(Side, start=4):
            low, high = self._limits[joint]
            goal = max(low, min(high, goals[side]))
            if goal != goals[side]:
                self._limited_legs.add(joint)
            self._lengths[side] = ramped(self._lengths[side], goal, largest)
