"""What a supervisor watches for: faults of sensors, servos and loop, and a robot that does not step or tilts.

Most watches compare what one signal says with what another one says, over some time.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from sarah.control.constants import ControllerConstants
from sarah.control.pattern_generator import Phase, PhaseChange
from sarah.control.slow_watches import SlowWatches, Warnings
from sarah.control.supervisor_settings import SupervisorSettings
from sarah.robot.filters import low_pass_gain
from sarah.robot.reading import LARGEST_SIGNAL, STANDING, SensorReading

INERTIAL = tuple(f"{signal} {axis}" for signal in ("acceleration", "angular rate") for axis in "xyz")
"""Names of the inertial signals, in their order."""
NEEDED = (0, 2, 4)
"""Indices of those without which the robot leaves its place, or cannot tell a fall."""

LARGEST_SHARE = 0.8
"""Share of ticks without a signal, over a second or so, from which it is as good as gone."""
NOTHING = SensorReading((math.nan,) * 3, (math.nan,) * 3, (math.nan,) * 4, (math.nan,) * 6)
"""Reading of which no signal has come."""


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
        self.signals = Signals(settings, self.warnings, dt)
        """Inertial signals that do not come, or that stay the same."""
        self._completed = STANDING
        self._steps = _Steps(settings.stepless_seconds)
        self._lateness, self._late_gain = 0.0, low_pass_gain(1.0, dt)
        self._slow = SlowWatches(settings, dt, constants, self.warnings)

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
            if lost > self._settings.lost_seconds:
                return f"late: a tick came after {seconds:.2f} s"
            if self._lateness > self._settings.largest_lateness:
                return f"late: ticks come {100.0 * self._lateness:.0f} % of a period late on average"
        wrong = self.signals.tick(reading, seconds)
        if phase is not Phase.STAND:
            wrong = wrong or self._steps.tick(seconds, change)
        return wrong or self._slow.tick(self._complete(heard), targets, phase)

    def _complete(self, heard: SensorReading) -> SensorReading:
        """A reading with the last value of each signal that is missing."""
        self._completed = heard.repaired(self._completed) if self.signals.are_suspicious else heard
        return self._completed

    def tick_standing(
        self, reading: SensorReading, heard: SensorReading, seconds: float, targets: Sequence[float]
    ) -> str:
        """Look at a tick of a robot that is to stand.

        :param reading: reading of this tick; what is missing is NaN
        :param heard: reading that the controller was given
        :param seconds: time since the last tick, in s
        :param targets: joint targets, in rad and m
        :return: what is wrong; empty if nothing is
        """
        wrong = self.signals.tick(reading, seconds)
        slow = self._slow.tick(self._complete(heard), targets, Phase.SHIFT)
        return wrong or slow  # whoever believes a stuck gyroscope sees a tilt

    def nothing_heard(self, unheard_seconds: float, seconds: float) -> str:
        """Look at a tick without a new reading.

        :param unheard_seconds: time without one, in s
        :param seconds: time since the last tick, in s
        :return: what is wrong; empty if nothing is
        """
        wrong = self.signals.tick(NOTHING, seconds)
        if unheard_seconds > self._settings.lost_seconds:
            return f"stale: no new reading for {unheard_seconds:.2f} s"
        return wrong

    @property
    def torso_tilt(self) -> float:
        """Tilt of the torso against standing, in rad, at the last look."""
        return self._slow.torso_tilt

    @property
    def lost_joints(self) -> set[int]:
        """Indices of the hip joints that do not follow their targets, as far as their sensors tell."""
        return self._slow.lost_joints

    def forgive(self) -> None:
        """Begin to wait for a step again, as after a change of parameters, unless there has been none since."""
        self._steps.forgive()


class Signals:
    """Inertial signals that do not come, or that stay the same.

    :param settings: from when on something is a fault
    :param warnings: warnings, to which signals are added that the robot can do without
    :param dt: control period, in s
    """

    def __init__(self, settings: SupervisorSettings, warnings: Warnings, dt: float) -> None:
        self._settings, self._warnings = settings, warnings
        self._before: tuple[float, ...] = (0.0,) * 6
        self._gone, self._same, self._shares = [0.0] * 6, [0.0] * 6, [0.0] * 6
        self._gain = low_pass_gain(settings.lean_seconds, dt)
        self.are_suspicious = False
        """Whether one of them has been missing, or the same, in the last seconds."""

    def tick(self, reading: SensorReading, seconds: float) -> str:
        """Look at one control tick.

        :param reading: reading of this tick; what is missing is NaN
        :param seconds: time since the last tick, in s
        :return: what is wrong; empty if nothing is
        """
        (ax, ay, az), (wx, wy, wz) = reading.acceleration, reading.angular_rate
        bx, by, bz, vx, vy, vz = self._before
        total = abs(ax) + abs(ay) + abs(az) + abs(wx) + abs(wy) + abs(wz)
        is_usual = (
            ax != bx and ay != by and az != bz and wx != vx and wy != vy and wz != vz
            and total < LARGEST_SIGNAL
        )  # fmt: skip
        if is_usual and not self.are_suspicious:
            self._before = ax, ay, az, wx, wy, wz
            return ""
        return self._closely((ax, ay, az, wx, wy, wz), seconds)

    def _closely(self, signals: tuple[float, ...], seconds: float) -> str:
        """Measure for how long, and how often, each signal has been gone or the same."""
        before, wrong = list(self._before), [0.0] * 6
        for index, value in enumerate(signals):
            is_there = abs(value) < LARGEST_SIGNAL
            self._gone[index] = 0.0 if is_there else self._gone[index] + seconds
            if is_there:
                self._same[index] = self._same[index] + seconds if value == before[index] else 0.0
                before[index] = value
            wrong[index] = max(self._gone[index], self._same[index])
            self._shares[index] += self._gain * ((wrong[index] > 0.0) - self._shares[index])
        self._before = tuple(before)
        self.are_suspicious = any(wrong) or max(self._shares) > 0.01
        is_whole = all(wrong)  # of a reading that is missing as a whole, its time counts
        for index, wrong_seconds in enumerate(wrong):
            is_long = wrong_seconds > self._settings.signal_seconds and not is_whole
            if is_long or self._shares[index] > LARGEST_SHARE:
                fault = self._fault(INERTIAL[index], index)
                if index in NEEDED:
                    return fault
                self._warnings.give(INERTIAL[index], fault)
        return ""

    def _fault(self, name: str, index: int) -> str:
        gone, same = self._gone[index], self._same[index]
        if self._shares[index] > LARGEST_SHARE:
            return f"stale: {name} comes in {100.0 * (1.0 - self._shares[index]):.0f} % of the ticks"
        return f"stale: no new {name} for {gone:.2f} s" if gone else f"frozen: {name} repeats for {same:.2f} s"


class _Steps:
    """A robot that does not step."""

    def __init__(self, stepless_seconds: float) -> None:
        self._waited = 0.0  # s since the last step, or since it began
        self._has_stepped = True
        self._stepless_seconds = stepless_seconds

    def tick(self, seconds: float, change: PhaseChange | None) -> str:
        """Whether a step is missing."""
        if change is not None and change.is_step:
            self._waited, self._has_stepped = 0.0, True
        else:
            self._waited += seconds
        return f"no step for {self._waited:.1f} s" if self._waited > self._stepless_seconds else ""

    def forgive(self) -> None:
        """Wait anew, once a step."""
        if self._has_stepped:
            self._waited, self._has_stepped = 0.0, False
