"""What a supervisor watches for: faults of sensors, servos and loop, and a robot that does not step or tilts.

Most watches compare what one signal says with what another one says, over some time.
"""

from __future__ import annotations

from collections.abc import Sequence

from sarah.control.constants import ControllerConstants
from sarah.control.pattern_generator import Phase, PhaseChange
from sarah.control.slow_watches import SlowWatches, Warnings
from sarah.control.supervisor_settings import SupervisorSettings
from sarah.robot.filters import low_pass_gain
from sarah.robot.reading import LARGEST_SIGNAL, SensorReading

INERTIAL = tuple(f"{signal} {axis}" for signal in ("acceleration", "angular rate") for axis in "xyz")
"""Names of the inertial signals, in their order."""
NEEDED = (0, 2, 4)
"""Indices of those without which the robot leaves its place, or cannot tell a fall."""


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
        self.signals = Signals(settings, self.warnings)
        """Inertial signals that do not come, or that stay the same."""
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
        return (
            self.signals.tick(reading, seconds)
            or (self._steps.tick(seconds, change) if phase is not Phase.STAND else "")
            or self._slow.tick(heard, targets, phase)
        )

    @property
    def torso_tilt(self) -> float:
        """Tilt of the torso against standing, in rad, at the last look."""
        return self._slow.torso_tilt

    @property
    def lost_joints(self) -> set[int]:
        """Indices of the hip joints that do not follow their targets, as far as their sensors tell."""
        return self._slow.lost_joints

    def forgive(self) -> None:
        """Begin to wait for a step again, as after a change of parameters."""
        self._steps.waited = 0.0


class Signals:
    """Inertial signals that do not come, or that stay the same.

    :param settings: from when on something is a fault
    :param warnings: warnings, to which signals are added that the robot can do without
    """

    def __init__(self, settings: SupervisorSettings, warnings: Warnings) -> None:
        self._settings, self._warnings = settings, warnings
        self._before: tuple[float, ...] = (0.0,) * 6
        self._gone, self._same = [0.0] * 6, [0.0] * 6
        self._is_suspicious = False

    def tick(self, reading: SensorReading, seconds: float) -> str:
        """Look at one control tick.

        :param reading: reading of this tick; what is missing is NaN
        :param seconds: time since the last tick, in s
        :return: what is wrong; empty if nothing is
        """
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
