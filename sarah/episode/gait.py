"""Step detection: steps per second, sole clearance, and the share of the phases that sensors end."""

from __future__ import annotations

from collections import deque
from statistics import median
from typing import Any

from sarah.control.pattern_generator import Phase, PhaseChange

WINDOW_SECONDS = 2.0
"""Length of the window in which the default robot's steps are counted, in s."""
SHORTEST_WINDOW_SECONDS = 0.5
"""Shortest length of that window while the episode begins, in s."""


class GaitRecord:
    """Record of one episode's gait. Ticks are control ticks since the pattern generator's start.

    :param control_rate: control ticks per second
    :param time_scale: ratio of the robot's times to those of the default robot
    """

    def __init__(self, control_rate: int, time_scale: float = 1.0) -> None:
        self.steps = 0
        self._control_rate = control_rate
        self._window = round(WINDOW_SECONDS * time_scale * control_rate)
        self._shortest_window = round(SHORTEST_WINDOW_SECONDS * time_scale * control_rate)
        self._recent: deque[int] = deque()
        self._swing_height = 0.0
        self._clearances: list[float] = []
        self._ends = {Phase.SHIFT: 0, Phase.LIFT: 0, Phase.LAND: 0}
        self._ends_by_sensors = {Phase.SHIFT: 0, Phase.LIFT: 0, Phase.LAND: 0}

    def swing(self, sole_height: float) -> None:
        """Record the height of the swing foot's lowest sole contact, while a foot swings.

        :param sole_height: height over the floor, in m
        """
        self._swing_height = max(self._swing_height, sole_height)

    def phase_change(self, tick: int, change: PhaseChange) -> None:
        """Record the end of a phase, and the step that it may complete.

        :param tick: control tick in which the phase ended, from 0
        :param change: phase change that the pattern generator reported
        """
        if change.ended is Phase.STAND:
            return
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

        :param ticks: control ticks since the start, which must not decrease from call to call
        """
        while self._recent and self._recent[0] < ticks - self._window:
            self._recent.popleft()
        return len(self._recent) * self._control_rate / max(self._shortest_window, min(self._window, ticks))

    def by_sensors(self, phase: Phase) -> float:
        """Share of a phase's ends that its sensor condition caused, and not its time-out; 0 if it never ended.

        :param phase: SHIFT, LIFT or LAND
        """
        return self._ends_by_sensors[phase] / self._ends[phase] if self._ends[phase] else 0.0

    @property
    def sole_clearance(self) -> float:
        """Median over the steps of the largest height of the swing foot's lowest sole contact, in m."""
        return median(self._clearances) if self._clearances else 0.0

    def metrics(self) -> dict[str, Any]:
        """Metrics of :class:`~sarah.episode.result.EpisodeResult` that follow from the gait."""
        return {
            "steps": self.steps,
            "shifts_by_sensors": self.by_sensors(Phase.SHIFT),
            "lifts_by_sensors": self.by_sensors(Phase.LIFT),
            "sole_clearance": self.sole_clearance,
        }
