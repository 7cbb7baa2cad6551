"""Robots in operation that cost little: short windows of a simulated one, and one that is a formula."""

import dataclasses
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from sarah.episode.from_mapping import from_mapping
from sarah.operation.settings import BOX, SHIPPED, OperationConfig, Parameters
from sarah.operation.window import FELT, Window


def quick(minutes: float = 0.1, robot: dict[str, Any] | None = None, **settings: Any) -> OperationConfig:
    """Settings with windows of a second and coarse physics, in which nobody rests after a fall."""
    config = OperationConfig(settle_seconds=0.5, measure_seconds=0.5, fall_seconds=2.0, push_seconds=4.0)
    pushed = from_mapping(config.robot, {"physics": {"rate": 200, "solver_iterations": 5}, **(robot or {})})
    return dataclasses.replace(config, robot=pushed, minutes=minutes, **settings)


KEPT = ("windows.csv", "parameters.json", "session.yaml", "journal.jsonl")
"""Files of a session that are the same to the byte, however often it was interrupted."""


def interrupted_after(windows: int) -> Callable[[], bool]:
    """A function that asks to stop after some windows."""
    countdown = iter(range(windows - 1))
    return lambda: next(countdown, None) is None


class FormulaRobot:
    """A robot whose reward is a function of its parameters and of the time; below 0.2 it falls."""

    def __init__(
        self, reward: Callable[[np.ndarray, float], float], minutes: float = 10.0, noise: float = 0.02
    ) -> None:
        self.config = OperationConfig(minutes=minutes)
        self.windows: list[Window] = []
        self._reward = reward
        self._noise = noise
        self._generator = np.random.default_rng(0)
        self._seconds = 0.0

    @property
    def is_over(self) -> bool:
        return self._seconds >= 60.0 * self.config.minutes

    @property
    def windows_left(self) -> float:
        return max(0.0, 60.0 * self.config.minutes - self._seconds) / 6.0

    def run(self, parameters: Parameters) -> Window:
        reward = self._reward(np.array(BOX.shares(parameters)), self._seconds / 60.0)
        fell = reward < 0.2
        noisy = 0.05 if fell else reward + self._noise * self._generator.standard_normal()
        seconds = 26.0 if fell else 6.0
        window = Window(
            len(self.windows), self._seconds, seconds, 0, parameters, noisy, noisy, fell, (0.0,) * len(FELT)
        )
        self.windows.append(window)
        self._seconds = window.end
        return window

    def close(self) -> None:
        """Nothing to give back."""

    @property
    def falls(self) -> int:
        """Number of falls."""
        return sum(window.fell for window in self.windows)

    def mean_reward(self, begin: float = 0.0, end: float = math.inf) -> float:
        """Mean reward without noise in a span of minutes."""
        found = [w.score for w in self.windows if 60.0 * begin < w.end <= 60.0 * end]
        return sum(found) / len(found)


START = np.array(BOX.shares(SHIPPED))
"""Where learners begin, in shares of the ranges."""
