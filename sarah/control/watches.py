"""What a supervisor watches for: faults of sensors, servos and loop, and a robot that does not step or tilts.

Most watches compare what one signal says with what another one says, over some time. What is not urgent is looked at
ten times a second, by the means of the ticks since: looking in every tick would cost more than the controller.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

from sarah.control.constants import ControllerConstants
from sarah.control.pattern_generator import Phase, PhaseChange
from sarah.ranges import Within, check_ranges
from sarah.robot.filters import low_pass_gain
from sarah.robot.reading import ACTUATED_JOINTS, GRAVITY, LARGEST_SIGNAL, SensorReading
from sarah.robot.scale import Sized

INERTIAL = tuple(f"{signal} {axis}" for signal in ("acceleration", "angular rate") for axis in "xyz")
"""Names of the inertial signals, in their order."""
NEEDED = (0, 2, 4)
"""Indices of those without which the robot leaves its place, or cannot tell a fall."""
LOOKS = 10
"""Number of times at which slow watches look in :attr:`SupervisorSettings.lean_seconds`."""


@dataclass(frozen=True)
class SupervisorSettings:
    """Settings of a supervisor: from when on something is a fault.

    :param enabled: whether a supervisor watches, and stops the robot when something fails
    :param stale_seconds: age from which a reading counts as missing, in s
    :param lost_seconds: time without any inertial signal, or with all of them the same, after which the robot stops, in
        s; the hip law bears half a second of either
    :param signal_seconds: time without one of them, or with one that stays the same, after which it stops, in s
    :param stepless_seconds: time without a step after which it stops, in s
    :param largest_tilt: tilt of the torso from which the robot counts as fallen, in rad
    :param largest_servo_error: mean distance of a hip joint from its target beyond which its servo does not follow, in
        rad
    :param servo_seconds: time constant of that mean, in s
    :param lean_seconds: time constant with which the torso's tilt follows the accelerometer, in s
    :param largest_contradiction: difference between the mean rate about x and that of the lean that the accelerometer
        shows, over twice that time, from which one of them is wrong, in rad/s
    :param least_rocking: rate about y, as a root mean square over that time, below which the gyroscope does not feel
        the rocking that the pads show, in rad/s
    :param largest_lateness: share of the last second that late ticks may lose
    """

    enabled: bool = False
    stale_seconds: Annotated[float, Sized(0.001, 10.0, "s")] = 0.08
    lost_seconds: Annotated[float, Sized(0.001, 10.0, "s")] = 0.55
    signal_seconds: Annotated[float, Sized(0.001, 10.0, "s")] = 0.1
    stepless_seconds: Annotated[float, Sized(0.1, 100.0, "s")] = 2.0
    largest_tilt: Annotated[float, Within(0.01, 1.5, "rad")] = 0.35
    largest_servo_error: Annotated[float, Within(0.001, 1.5, "rad")] = 0.15
    servo_seconds: Annotated[float, Sized(0.01, 10.0, "s")] = 0.3
    lean_seconds: Annotated[float, Sized(0.1, 100.0, "s")] = 1.0
    largest_contradiction: Annotated[float, Sized(0.001, 10.0, "rad/s")] = 0.065
    least_rocking: Annotated[float, Sized(0.0, 10.0, "rad/s")] = 0.04
    largest_lateness: Annotated[float, Within(0.0, 1.0)] = 0.4

    def __post_init__(self) -> None:
        """Refuse settings with which nothing can be watched."""
        check_ranges("supervisor.", self)


STANDARD_SUPERVISOR = SupervisorSettings(enabled=True)
"""Settings of a supervisor for the default robot."""


class Watches:
    """Everything that is watched while a robot steps. Call :meth:`tick` once per control tick.

    A signal or a servo without which the robot goes on stepping is a warning, and no fault.

    :param settings: from when on something is a fault
    :param dt: control period, in s
    :param constants: constants of the controller
    """

    def __init__(self, settings: SupervisorSettings, dt: float, constants: ControllerConstants) -> None:
        self._settings, self._dt = settings, dt
        self.warnings = Warnings()
        """What has gone wrong that does not stop the robot."""
        self._signals = _Signals(settings, self.warnings)
        self._steps = _Steps(settings.stepless_seconds)
        self._lateness, self._late_gain = 0.0, low_pass_gain(1.0, dt)
        self._slow = _SlowWatches(settings, dt, constants, self.warnings)

    def tick(
        self,
        reading: SensorReading,
        heard: SensorReading,
        seconds: float,
        targets: Sequence[float],
        phase: Phase,
        change: PhaseChange | None,
    ) -> str:
        """Look at one control tick.

        :param reading: reading of this tick; what is missing is NaN
        :param heard: reading that the controller was given
        :param seconds: time since the last tick, in s
        :param targets: joint targets, in rad and m
        :param phase: phase of the pattern generator
        :param change: end of a phase in this tick
        :return: what is wrong; empty if nothing is
        """
        lost = seconds - self._dt
        if lost > 0.5 * self._dt or self._lateness > 0.001:
            self._lateness += self._late_gain * (max(0.0, lost) / self._dt - self._lateness)
            if self._lateness > self._settings.largest_lateness or lost > self._settings.lost_seconds:
                return f"late: the last tick came after {1000 * seconds:.0f} ms instead of {1000 * self._dt:g}"
        return (
            self._signals.tick(reading, seconds)
            or (self._steps.tick(seconds, change) if phase is not Phase.STAND else "")
            or self._slow.tick(heard, targets, phase)
        )

    def forgive(self) -> None:
        """Begin to wait for a step again, as after a change of parameters."""
        self._steps.waited = 0.0


class Warnings:
    """Warnings, each of which is given once."""

    def __init__(self) -> None:
        self.new: list[str] = []
        """Warnings that nobody has taken yet."""
        self._given: set[str] = set()

    def give(self, about: str, text: str) -> None:
        """Give a warning, if there has been none about the same.

        :param about: what it is about
        :param text: the warning
        """
        if about not in self._given:
            self._given.add(about)
            self.new.append(text)

    def take(self) -> str:
        """All new warnings, which are new no longer."""
        text, self.new = "; ".join(self.new), []
        return text


class _Signals:
    """Inertial signals that do not come, or that stay the same."""

    def __init__(self, settings: SupervisorSettings, warnings: Warnings) -> None:
        self._settings, self._warnings = settings, warnings
        self._before: tuple[float, ...] = (0.0,) * 6
        self._gone, self._same = [0.0] * 6, [0.0] * 6
        self._is_suspicious = False

    def tick(self, reading: SensorReading, seconds: float) -> str:
        """What is wrong with the signals of a reading."""
        (ax, ay, az), (wx, wy, wz) = reading.acceleration, reading.angular_rate
        bx, by, bz, vx, vy, vz = self._before
        total = ax + ay + az + wx + wy + wz
        is_usual = (
            ax != bx and ay != by and az != bz and wx != vx and wy != vy and wz != vz
            and -LARGEST_SIGNAL < total < LARGEST_SIGNAL
        )  # fmt: skip
        if is_usual and not self._is_suspicious:
            self._before = ax, ay, az, wx, wy, wz
            return ""
        return self._closely((ax, ay, az, wx, wy, wz), seconds)

    def _closely(self, signals: tuple[float, ...], seconds: float) -> str:
        """Measure for how long each signal has been gone or the same."""
        before = list(self._before)
        for index, value in enumerate(signals):
            is_there = abs(value) < LARGEST_SIGNAL
            self._gone[index] = 0.0 if is_there else self._gone[index] + seconds
            if is_there:
                self._same[index] = self._same[index] + seconds if value == before[index] else 0.0
                before[index] = value
        self._before = tuple(before)
        wrong = [max(gone, same) for gone, same in zip(self._gone, self._same, strict=True)]
        self._is_suspicious = any(wrong)
        if all(wrong):
            return self._fault("inertial signal", 0) if min(wrong) > self._settings.lost_seconds else ""
        for index, wrong_seconds in enumerate(wrong):
            if wrong_seconds > self._settings.signal_seconds:
                if index in NEEDED:
                    return self._fault(INERTIAL[index], index)
                self._warnings.give(INERTIAL[index], self._fault(INERTIAL[index], index))
        return ""

    def _fault(self, name: str, index: int) -> str:
        gone, same = self._gone[index], self._same[index]
        return f"stale: no new {name} for {gone:.2f} s" if gone else f"frozen: {name} repeats for {same:.2f} s"


class _Steps:
    """A robot that does not step."""

    def __init__(self, stepless_seconds: float) -> None:
        self.waited = 0.0
        """Time since the last step, or since it began, in s."""
        self._stepless_seconds = stepless_seconds

    def tick(self, seconds: float, change: PhaseChange | None) -> str:
        """Whether a step is missing."""
        self.waited = 0.0 if change is not None and change.is_step else self.waited + seconds
        return f"no step for {self.waited:.1f} s" if self.waited > self._stepless_seconds else ""


class _SlowWatches:
    """What is looked at ten times a second."""

    def __init__(
        self, settings: SupervisorSettings, dt: float, constants: ControllerConstants, warnings: Warnings
    ) -> None:
        self._ticks = max(1, round(settings.lean_seconds / (LOOKS * dt)))
        seconds = self._ticks * dt
        self._servos = _Servos(settings, seconds, warnings)
        self._lean = _Lean(settings, seconds)
        self._rocking = _Rocking(settings, constants)
        self._readings: list[SensorReading] = []

    def tick(self, reading: SensorReading, targets: Sequence[float], phase: Phase) -> str:
        """Add a reading, and look if it is time."""
        readings = self._readings
        readings.append(reading)
        if len(readings) < self._ticks:
            return ""
        self._readings = []
        number = len(readings)
        acceleration = [sum(signal) / number for signal in zip(*[one.acceleration for one in readings], strict=True)]
        rate = [sum(signal) / number for signal in zip(*[one.angular_rate for one in readings], strict=True)]
        self._servos.look(reading.joints, targets)
        if not math.isfinite(sum(acceleration) + sum(rate)):  # what does not come is watched elsewhere
            return ""
        squared = sum([one.angular_rate[1] ** 2 for one in readings]) / number
        is_standing = phase is Phase.STAND
        return self._lean.look(acceleration, rate, is_standing) or self._rocking.look(
            squared, reading.pressures, is_standing
        )


class _Servos:
    """Hip servos that do not follow."""

    def __init__(self, settings: SupervisorSettings, seconds: float, warnings: Warnings) -> None:
        self._warnings = warnings
        self._largest = settings.largest_servo_error
        self._gain = low_pass_gain(settings.servo_seconds, seconds)
        self._errors = [0.0] * 4

    def look(self, joints: Sequence[float], targets: Sequence[float]) -> None:
        """Find out which servo is far from its target."""
        for index, mean in enumerate(self._errors):
            error = joints[index] - targets[index]
            if math.isfinite(error):
                mean += self._gain * (error - mean)
                self._errors[index] = mean
            if abs(mean) > self._largest:
                joint = ACTUATED_JOINTS[index]
                self._warnings.give(joint, f"servo: {joint} does not follow its target")


class _Lean:
    """Tilt of the torso, and the rate about x against the lean that the accelerometer shows.

    Over a window, what the rate integrates to and by how much the lean changed are the same, after the same low-pass.
    """

    def __init__(self, settings: SupervisorSettings, seconds: float) -> None:
        self._settings, self._seconds = settings, seconds
        self._gain = low_pass_gain(settings.lean_seconds, seconds)
        self._baseline_gain = low_pass_gain(20.0 * settings.lean_seconds, seconds)  # a drift of the gyroscope's
        self._stood = 0
        self._leans, self._rates = [0.0, 0.0], [0.0, 0.0]  # baselines of standing
        self._tilt = [0.0, 0.0]  # turned about x and about y since standing, in rad
        self._rate = self._lean = self._turned = 0.0
        self._differences: deque[float] = deque(maxlen=2 * LOOKS + 1)

    def look(self, acceleration: Sequence[float], rate: Sequence[float], is_standing: bool) -> str:
        """Whether the torso tilts, or one of both sensors is wrong."""
        leans = [acceleration[1] / GRAVITY, -acceleration[0] / GRAVITY]  # about x and y, as rates turn
        if is_standing:
            self._stood += 1
        for axis in (0, 1):
            self._rates[axis] += (1.0 / self._stood if is_standing else self._baseline_gain) * (
                rate[axis] - self._rates[axis]
            )
            if is_standing:
                self._leans[axis] += (leans[axis] - self._leans[axis]) / self._stood
            moved = self._tilt[axis] + (rate[axis] - self._rates[axis]) * self._seconds
            self._tilt[axis] = moved + self._gain * (leans[axis] - self._leans[axis] - moved)
        if (tilt := math.hypot(*self._tilt)) > self._settings.largest_tilt:
            return f"tilt: the torso tilts by {math.degrees(tilt):.0f} degrees"
        return self._contradiction(rate[0] - self._rates[0], leans[0] - self._leans[0])

    def _contradiction(self, rate: float, lean: float) -> str:
        self._rate += self._gain * (rate - self._rate)
        self._lean += self._gain * (lean - self._lean)
        self._turned += self._rate * self._seconds
        self._differences.append(self._turned - self._lean)
        window = self._differences
        difference = (window[-1] - window[0]) / (self._seconds * (len(window) - 1)) if len(window) > 1 else 0.0
        if len(window) == window.maxlen and abs(difference) > self._settings.largest_contradiction:
            return f"contradiction: angular rate x says {difference:+.2f} rad/s more than the acceleration"
        return ""


class _Rocking:
    """The rate about y against the rocking that the pads show."""

    def __init__(self, settings: SupervisorSettings, constants: ControllerConstants) -> None:
        self._least, self._threshold = settings.least_rocking, constants.pad_threshold
        self._squares: deque[float] = deque(maxlen=LOOKS)
        self._feet: deque[tuple[bool, bool]] = deque(maxlen=LOOKS)

    def look(self, squared: float, pressures: Sequence[float], is_standing: bool) -> str:
        """Whether the gyroscope feels nothing while the feet carry in turn."""
        left_fore, left_hind, right_fore, right_hind = pressures
        self._squares.append(squared)
        self._feet.append((left_fore + left_hind > self._threshold, right_fore + right_hind > self._threshold))
        if is_standing or len(self._feet) < LOOKS:
            return ""
        rocking = math.sqrt(sum(self._squares) / len(self._squares))
        if rocking < self._least and all(len(set(foot)) == 2 for foot in zip(*self._feet, strict=True)):
            return f"contradiction: angular rate y is {rocking:.2f} rad/s while the feet carry in turn"
        return ""
