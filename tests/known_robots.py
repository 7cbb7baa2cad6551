"""Kinds of robots that are formulas: what they feel and which parameters suit them goes with one number."""

import dataclasses

import numpy as np
from operated import START, FormulaRobot

from sarah.operation.settings import BOX, SHIPPED, Parameters
from sarah.operation.window import FELT, Window
from sarah.recognition.logged import LoggedRobot, LoggedWindow
from sarah.recognition.recognition import Conditions
from sarah.robot.scale import Scale

DIRECTION = np.array([1, -1, 1, 1, -1, 1, -1, 1, -1])
"""Direction in which the best parameters lie for robots of a positive kind, seen from the shipped ones."""


def top(kind: float) -> Parameters:
    """Best parameters of a kind."""
    return BOX.at_shares(np.clip(START + 0.15 * kind * DIRECTION, 0.0, 1.0))


def reward(shares: np.ndarray, kind: float) -> float:
    """A hill whose top is nearly the best that there is."""
    return float(max(0.25, 0.95 - 2.0 * np.square(shares - BOX.shares(top(kind))).sum()))


def felt(kind: float, random: np.random.Generator) -> tuple[float, ...]:
    """What a robot of a kind feels, with noise."""
    return tuple(np.exp(0.5 * kind * np.linspace(-1.0, 1.0, len(FELT)) + 0.02 * random.standard_normal(len(FELT))))


def logged(kind: float, seed: int = 0, windows: int = 3) -> LoggedRobot:
    """Log of a robot: windows with the shipped parameters, and with the best ones of several kinds."""
    random = np.random.default_rng([seed, round(100 * (kind + 10))])
    sets = [SHIPPED] * windows + [top(one) for one in (-1.0, 0.0, 1.0)] * windows
    seen = [
        LoggedWindow(one, reward(np.array(BOX.shares(one)), kind) + 0.01 * random.standard_normal(), False, what)
        for one, what in ((one, felt(kind, random)) for one in sets)
    ]
    return LoggedRobot(f"kind {kind:g}, {seed}", f"kind {kind:g}", Conditions(), Scale(), tuple(seen))


LOGS = [logged(kind, seed) for kind in (-1.0, 0.0, 1.0) for seed in range(2)]


class KnownRobot(FormulaRobot):
    """A robot of a kind, which may become another one at a minute.

    :param kind: kind of the robot
    :param minutes: duration of the operation, in min
    :param then: kind that it is of later
    :param change: minute from which on it is
    :param best: reward of its best parameters, where they disappoint
    :param fall: minute at which it falls, whatever its parameters
    """

    def __init__(
        self,
        kind: float,
        minutes: float = 3.0,
        then: float | None = None,
        change: float = 0.0,
        best: float | None = None,
        fall: float | None = None,
    ) -> None:
        def worth(shares: np.ndarray, minute: float) -> float:
            if fall is not None and fall <= minute < fall + 0.1:
                return 0.0
            is_best = np.allclose(shares, BOX.shares(top(kind)))
            return best if best is not None and is_best else reward(shares, self.kind_at(minute))

        super().__init__(worth, minutes, noise=0.01)
        self.kind_at = lambda minute: kind if then is None or minute < change else then
        self._felt = np.random.default_rng(1)

    def run(self, parameters: Parameters) -> Window:
        begin = self.seconds
        window = super().run(parameters)
        if not window.fell:
            window = dataclasses.replace(window, felt=felt(self.kind_at(begin / 60.0), self._felt))
        self.seen[-1] = window
        return window
