"""Step detection: steps per second, sole clearance, and the share of the phases that sensors end."""

from __future__ import annotations

from collections import Counter, deque
from dataclasses import dataclass
from statistics import median
from typing import Annotated

from sarah.control.pattern_generator import Phase, PhaseChange
from sarah.episode.metric import metric
from sarah.episode.robot_settings import RobotSettings
from sarah.episode.running_robot import Observer, RunningRobot
from sarah.robot.reading import Vector
from sarah.robot.scale import Sized

WINDOW_SECONDS = 2.0
"""Length of the window in which the default robot's steps are counted, in s."""
SHORTEST_WINDOW_SECONDS = 0.5
"""Shortest length of that window while the episode begins, in s."""
LEAST_CLEARANCE = 0.010
"""Sole clearance of the default robot below which a gait is a shuffle, in m."""


@dataclass(frozen=True)
class GaitSettings(RobotSettings):
    """Settings of what counts as a gait.

    :param least_clearance: sole clearance below which a gait is a shuffle, and not valid, in m
    """

    least_clearance: Annotated[float, Sized(0.0, 1.0, "m", usual=LEAST_CLEARANCE)] = None  # type: ignore[assignment]


@dataclass(frozen=True)
class GaitMetrics:
    """How a robot steps, and for how long."""

    steps_per_second: float = metric(
        "steps per second",
        "1/s",
        "mean number of completed steps per second while the pattern generator ran",
        *("median", "mean", "std"),
        group="episode",
        paper="3 to 5, a human's",
    )
    steps: int = metric("steps", "", "number of completed steps", shown=(1.0, 0, ""))
    duration: float = metric(
        "duration", "s", "simulated time, the first second of standing included", group="robot", shown=(1.0, 1, "s")
    )
    shifts_by_sensors: float = metric(
        "SHIFT by sensors", "", "share of SHIFT phases that sensors ended", "mean", group="robot", shown=(100.0, 1, "%")
    )
    lifts_by_sensors: float = metric(
        "LIFT by sensors", "", "share of LIFT phases that sensors ended", "mean", group="robot", shown=(100.0, 1, "%")
    )
    sole_clearance: float = metric(
        "sole clearance",
        "m",
        "median over the steps of the swing foot's largest height over the floor",
        "mean",
        group="robot",
        shown=(1000.0, 1, "mm"),
    )


class GaitRecord(Observer):
    """Record of one episode's gait. Ticks are control ticks since the pattern generator's start.

    :param control_rate: control ticks per second
    :param time_scale: ratio of the robot's times to those of the default robot
    """

    def __init__(self, control_rate: int, time_scale: float = 1.0) -> None:
        self.steps = self.ticks = 0
        self._control_rate = control_rate
        self._window = round(WINDOW_SECONDS * time_scale * control_rate)
        self._shortest_window = round(SHORTEST_WINDOW_SECONDS * time_scale * control_rate)
        self._recent: deque[int] = deque()
        self._swing_height = 0.0
        self._clearances: list[float] = []
        self._ends: Counter[Phase] = Counter()
        self._ends_by_sensors: Counter[Phase] = Counter()

    def sensed(self, robot: RunningRobot) -> None:
        """Record the height of the swing foot's lowest sole contact, while a foot swings."""
        generator = robot.generator
        if generator.phase in (Phase.LIFT, Phase.LAND):
            self._swing_height = max(self._swing_height, robot.simulation.sole_height(generator.swing))

    def decided(self, robot: RunningRobot, change: PhaseChange | None, force: Vector | None) -> None:
        """Record the end of a phase, and count the tick."""
        if change is not None:
            self.phase_change(self.ticks, change)
        self.ticks += 1

    def phase_change(self, tick: int, change: PhaseChange) -> None:
        """Record the end of a phase, and the step that it may complete.

        :param tick: control tick in which the phase ended, from 0
        :param change: phase change that the pattern generator reported
        """
        self._ends[change.ended] += 1
        self._ends_by_sensors[change.ended] += change.by_sensors
        if change.is_step:
            self.steps += 1
            self._recent.append(tick)
            self._clearances.append(self._swing_height)
        if change.ended is Phase.LAND:
            self._swing_height = 0.0

    def steps_per_second(self, ticks: int) -> float:
        """Steps per second in the last 2 s, the f of equation 2; at first, since the start, over at least 0.5 s.

        Both are times of the default robot.

        :param ticks: control ticks since the start, which must not decrease from call to call
        """
        while self._recent and self._recent[0] < ticks - self._window:
            self._recent.popleft()
        return len(self._recent) * self._control_rate / max(self._shortest_window, min(self._window, ticks))

    def metrics(self, before: float) -> GaitMetrics:
        """Metrics of the gait so far.

        :param before: time before the first tick that counts to the duration, in s
        """
        elapsed = self.ticks * (1.0 / self._control_rate)
        by_sensors = {phase: self._ends_by_sensors[phase] / max(1, self._ends[phase]) for phase in Phase}
        return GaitMetrics(
            steps_per_second=self.steps / elapsed if elapsed else 0.0,
            steps=self.steps,
            duration=round(before + elapsed, 9),
            shifts_by_sensors=by_sensors[Phase.SHIFT],
            lifts_by_sensors=by_sensors[Phase.LIFT],
            sole_clearance=median(self._clearances or [0.0]),
        )
