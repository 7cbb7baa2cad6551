"""Steps per second, from the moments at which steps were completed."""

from __future__ import annotations

from collections import deque

WINDOW_SECONDS = 2.0
SHORTEST_WINDOW_SECONDS = 0.5
OSCILLATION_DEADLINE = 5.0
"""Simulation time by which the robot must have stepped, in s: the paper's third stop criterion."""
OSCILLATION_STEPS = 2
"""Steps that count as an oscillation: one with each leg."""


class GaitCounter:
    """Counts steps since the pattern generator started.

    Steps per second are the steps of the last 2 s; at the start, those of the time that has passed, which counts
    as at least 0.5 s.
    """

    def __init__(self) -> None:
        self.steps = 0
        self._recent: deque[float] = deque()

    def step(self, time: float) -> None:
        """Count a step.

        :param time: since the pattern generator's start, in s
        """
        self.steps += 1
        self._recent.append(time)

    def steps_per_second(self, time: float) -> float:
        """The f of equation 2.

        :param time: since the pattern generator's start, in s; must not run backwards
        """
        while self._recent and self._recent[0] <= time - WINDOW_SECONDS:
            self._recent.popleft()
        return len(self._recent) / max(SHORTEST_WINDOW_SECONDS, min(WINDOW_SECONDS, time))
