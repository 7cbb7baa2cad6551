"""Watches that look ten times a second: hip servos, tilt, and signals that contradict each other.

They look at the means of the ticks since the last look. Looking in every tick would cost more than the controller.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence

from sarah.control.constants import ControllerConstants
from sarah.control.pattern_generator import Phase
from sarah.control.supervisor_settings import SupervisorSettings
from sarah.robot.filters import clipped, low_pass_gain
from sarah.robot.reading import ACTUATED_JOINTS, GRAVITY, SensorReading

LOOKS = 10
"""Number of times at which these watches look in :attr:`SupervisorSettings.lean_seconds`."""

LARGEST_RATE = 0.3
"""Limit to which rates are clipped, as a share of the controller's: a single outlier is no fall."""


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


class SlowWatches:
    """What is looked at ten times a second.

    :param settings: from when on something is a fault
    :param dt: control period, in s
    :param constants: constants of the controller
    :param warnings: warnings, to which servos that do not follow are added
    """

    def __init__(
        self, settings: SupervisorSettings, dt: float, constants: ControllerConstants, warnings: Warnings
    ) -> None:
        self._ticks = max(1, round(settings.lean_seconds / (LOOKS * dt)))
        seconds = self._ticks * dt
        self._servos = _Servos(settings, seconds, warnings)
        self._torso = _Tilt(settings, seconds)
        self._rocking = _Rocking(settings, constants)
        self._readings: list[SensorReading] = []
        self._largest_acceleration = constants.largest_acceleration
        self._largest_rate = LARGEST_RATE * constants.largest_rate

    @property
    def torso_tilt(self) -> float:
        """Tilt of the torso against standing, in rad, at the last look."""
        return self._torso.tilt

    @property
    def lost_joints(self) -> set[int]:
        """Indices of the hip joints that do not follow their targets, as far as their sensors tell."""
        return self._servos.lost

    def tick(self, reading: SensorReading, targets: Sequence[float], phase: Phase) -> str:
        """Add a reading, and look if it is time.

        :param reading: reading of this tick, with the last value of each signal that is missing
        :param targets: joint targets, in rad and m
        :param phase: phase of the pattern generator
        :return: what is wrong; empty if nothing is
        """
        readings = self._readings
        readings.append(reading)
        if len(readings) < self._ticks:
            return ""
        self._readings = []
        number, largest_acceleration, largest_rate = len(readings), self._largest_acceleration, self._largest_rate
        acceleration_x = sum([clipped(one.acceleration[0], largest_acceleration) for one in readings]) / number
        acceleration_y = sum([clipped(one.acceleration[1], largest_acceleration) for one in readings]) / number
        rate_x = sum([clipped(one.angular_rate[0], largest_rate) for one in readings]) / number
        rates_y = [clipped(one.angular_rate[1], largest_rate) for one in readings]
        leans, rates = (acceleration_y / GRAVITY, -acceleration_x / GRAVITY), (rate_x, sum(rates_y) / number)
        self._servos.look(reading.joints, targets)
        is_standing = phase is Phase.STAND
        return self._torso.look(leans, rates, is_standing) or self._rocking.look(
            sum([rate * rate for rate in rates_y]) / number, reading.pressures, is_standing
        )


class _Servos:
    """Hip servos that do not follow."""

    def __init__(self, settings: SupervisorSettings, seconds: float, warnings: Warnings) -> None:
        self._warnings = warnings
        self._largest = settings.largest_servo_error
        self._gain = low_pass_gain(settings.servo_seconds, seconds)
        self._errors = [0.0] * 4
        self.lost: set[int] = set()

    def look(self, joints: Sequence[float], targets: Sequence[float]) -> None:
        """Find out which servo is far from its target."""
        for index, mean in enumerate(self._errors):
            error = joints[index] - targets[index]
            if math.isfinite(error):
                mean += self._gain * (error - mean)
                self._errors[index] = mean
            if abs(mean) > self._largest:
                joint = ACTUATED_JOINTS[index]
                self.lost.add(index)
                self._warnings.give(joint, f"servo: {joint} does not follow its target")
            elif abs(mean) < 0.5 * self._largest:
                self.lost.discard(index)


class _Tilt:
    """Tilt of the torso, and the rate about x against the lean that the accelerometer shows.

    Over a window, what the rate integrates to and by how much the lean changed are the same, after the same low-pass.
    """

    def __init__(self, settings: SupervisorSettings, seconds: float) -> None:
        self._settings, self._seconds = settings, seconds
        self._gain = low_pass_gain(settings.lean_seconds, seconds)
        self._baseline_gain = low_pass_gain(20.0 * settings.lean_seconds, seconds)  # a drift of the gyroscope's
        self._stood = 0
        self._leans, self._rates = [0.0, 0.0], [0.0, 0.0]  # baselines of standing
        self._turned_since_standing = [0.0, 0.0]  # about x and about y, in rad
        self._rate = self._lean = self._turned = 0.0
        self._differences: deque[float] = deque(maxlen=2 * LOOKS + 1)

    def look(self, leans: Sequence[float], rates: Sequence[float], is_standing: bool) -> str:
        """Whether the torso tilts, or one of both sensors is wrong: by leans and rates about x and y."""
        self._stood += is_standing
        for axis in (0, 1):
            gain = 1.0 / self._stood if is_standing else self._baseline_gain
            self._rates[axis] += gain * (rates[axis] - self._rates[axis])
            if is_standing:
                self._leans[axis] += gain * (leans[axis] - self._leans[axis])
            moved = self._turned_since_standing[axis] + (rates[axis] - self._rates[axis]) * self._seconds
            self._turned_since_standing[axis] = moved + self._gain * (leans[axis] - self._leans[axis] - moved)
        if is_standing and math.hypot(*self._leans) > self._settings.largest_tilt:
            return f"tilt: the torso stands at {math.degrees(math.hypot(*self._leans)):.0f} degrees"
        if self.tilt > self._settings.largest_tilt:
            return f"tilt: the torso tilts by {math.degrees(self.tilt):.0f} degrees"
        return self._contradiction(rates[0] - self._rates[0], leans[0] - self._leans[0])

    @property
    def tilt(self) -> float:
        """Tilt of the torso against standing, in rad."""
        return math.hypot(*self._turned_since_standing)

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
