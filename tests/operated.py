"""Robots in operation that cost little: short windows of a simulated one, and one that is a formula."""

import dataclasses
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from sarah.episode.from_mapping import from_mapping
from sarah.operation.robot_in_operation import RobotInOperation
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
    countdown = iter(range(windows - 1))
    return lambda: next(countdown, None) is None


class FormulaRobot(RobotInOperation):
    """A robot whose reward is a function of its parameters and of the time; below 0.2 it falls."""

    def __init__(
        self, reward: Callable[[np.ndarray, float], float], minutes: float = 10.0, noise: float = 0.02
    ) -> None:
        super().__init__(OperationConfig(minutes=minutes), seed=0)
        self.seen: list[Window] = []
        self._reward = reward
        self._noise = noise
        self._generator = np.random.default_rng(0)

    def run(self, parameters: Parameters) -> Window:
        reward = self._reward(np.array(BOX.shares(parameters)), self.seconds / 60.0)
        fell = reward < 0.2
        noisy = 0.05 if fell else reward + self._noise * self._generator.standard_normal()
        length = 26.0 if fell else 6.0
        felt = (0.0,) * len(FELT)
        window = Window(self.windows, self.seconds, length, 0, parameters, noisy, noisy, fell, felt)
        self.seen.append(window)
        self.windows += 1
        self.seconds = window.end
        return window

    @property
    def falls(self) -> int:
        return sum(window.fell for window in self.seen)

    def mean_reward(self, begin: float = 0.0, end: float = math.inf) -> float:
        """Mean reward without noise in a span of minutes."""
        found = [w.worth for w in self.seen if 60.0 * begin < w.end <= 60.0 * end]
        return sum(found) / len(found)


START = np.array(BOX.shares(SHIPPED))
"""Where learners begin, in shares of the ranges."""
