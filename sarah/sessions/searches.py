"""Learners that search without a model: none at all, at random, and CMA-ES."""

from __future__ import annotations

import random

from sarah.operation.operation import Operation
from sarah.operation.settings import PARAMETERS, Parameters
from sarah.operation.shares import from_shares, to_shares


class Frozen:
    """Learns nothing: what the others are compared with.

    :param first: parameters all along
    """

    def __init__(self, first: Parameters) -> None:
        self._first = first

    def operate(self, robot: Operation) -> Parameters:
        """Keep the parameters."""
        while not robot.is_over:
            robot.run(self._first)
        return self._first


class RandomSearch:
    """Tries parameters from anywhere in their box, and leaves the robot with those of the best window.

    :param first: parameters of the first window
    :param seed: seed of the draws
    """

    def __init__(self, first: Parameters, seed: int) -> None:
        self._first = first
        self._generator = random.Random(f"random search {seed}")

    def operate(self, robot: Operation) -> Parameters:
        """Draw the parameters of each window."""
        best, highest, parameters = self._first, -1.0, self._first
        while not robot.is_over:
            window = robot.run(parameters)
            if window.observed_reward > highest:
                best, highest = parameters, window.observed_reward
            parameters = tuple(self._generator.uniform(parameter.low, parameter.high) for parameter in PARAMETERS)
        return best


class EvolutionStrategy:
    """CMA-ES (Hansen and Ostermeier 2001) around the first parameters, a window for each candidate.

    :param first: parameters to begin around
    :param seed: seed of the draws
    :param deviation: standard deviation of the first generation, as a share of each range
    """

    def __init__(self, first: Parameters, seed: int, deviation: float = 0.08) -> None:
        self._first = first
        self._seed = seed
        self._deviation = deviation

    def operate(self, robot: Operation) -> Parameters:
        """Run one generation after the other."""
        import cma

        options = {"bounds": [0.0, 1.0], "seed": self._seed + 1, "verbose": -9}
        strategy = cma.CMAEvolutionStrategy(to_shares(self._first), self._deviation, options)
        while True:
            tried = []
            for shares in strategy.ask():
                if robot.is_over:
                    return from_shares(strategy.result.xfavorite)
                tried.append((shares, -robot.run(from_shares(shares)).observed_reward))
            strategy.tell(*zip(*tried, strict=True))
