"""Searches without a model of the robot, the usual choices for a few numbers and costly tries.

All follow the protocol of :mod:`sarah.training.search`. They scale parameters to [-1, 1].
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from sarah.control.parameters import Box, Parameters
from sarah.runs.agent_settings import AgentSettings, EvolutionSettings
from sarah.training.search import Search, Start

LARGEST_MERIT = 1e100
"""Largest merit by amount that a sampler of Optuna is told: squares of larger ones would overflow."""


class RandomSearch:
    """Parameters drawn uniformly; it chooses the best ones.

    :param settings: Settings of the search, of which there are none
    :param box: ranges of the parameters
    :param seed: seed of the draws
    :param start: how to begin
    """

    def __init__(self, settings: AgentSettings, box: Box, seed: int, start: Start) -> None:
        self._box = box
        self._first = start.first
        self._generator = np.random.default_rng(seed)
        self._best = start.first or box.centre
        self._highest = -math.inf

    def ready(self) -> bool:
        """Always."""
        return True

    def ask(self, left: float = math.inf) -> Parameters:
        """Draw parameters."""
        first, self._first = self._first, None
        if first is not None:
            return first
        return self._box.unscaled(self._generator.uniform(-1.0, 1.0, len(self._box.parameters)))

    def tell(self, parameters: Parameters, merit: float, fell: bool = False) -> None:
        """Keep the parameters if they are the best so far."""
        if merit > self._highest:
            self._best, self._highest = parameters, merit

    def choice(self) -> Parameters:
        """The best of a single try."""
        return self._best


class EvolutionStrategy:
    """CMA-ES (Hansen and Ostermeier 2001) from the package ``cma``; it chooses its mean.

    A generation is asked for together, and the next one only when all of it has been told.

    :param settings: Settings of the strategy
    :param box: ranges of the parameters
    :param seed: seed of the draws
    :param start: how to begin; without first parameters it begins around the centre of the box
    """

    def __init__(self, settings: EvolutionSettings, box: Box, seed: int, start: Start) -> None:
        import cma

        # The package takes a seed of 0 for the time of day.
        options = {"bounds": [-1.0, 1.0], "popsize": settings.population, "seed": seed % 2**31 + 1, "verbose": -9}
        if len(box.parameters) == 1:
            options["maxstd"] = np.inf  # of a single deviation the package cannot bound any
        self._box = box
        self._first = start.first
        mean = np.array(box.scaled(start.first or box.centre))
        self._strategy = cma.CMAEvolutionStrategy(mean, settings.deviation, options)
        if start.first is not None:
            self._strategy.inject([mean], force=True)
        self._unasked: deque[np.ndarray] = deque()
        self._generation: list[np.ndarray] = []
        self._losses: list[float] = []

    def ready(self) -> bool:
        """Not while the last of a generation are being tried."""
        return bool(self._unasked) or len(self._losses) == len(self._generation)

    def ask(self, left: float = math.inf) -> Parameters:
        """The next of the generation, or the first of a new one."""
        if not self._unasked:
            self._generation, self._losses = self._strategy.ask(), []
            self._unasked.extend(self._generation)
        action = self._unasked.popleft()
        first, self._first = self._first, None
        return self._box.unscaled(action) if first is None else first  # the package moves it away from an end

    def tell(self, parameters: Parameters, merit: float, fell: bool = False) -> None:
        """Note a merit, and update the distribution once the generation is complete."""
        self._losses.append(-merit)
        if len(self._losses) == len(self._generation):
            self._strategy.tell(self._generation, self._losses)

    def choice(self) -> Parameters:
        """The mean of the distribution."""
        return self._box.unscaled(self._strategy.result.xfavorite)


class OptunaSearch:
    """One of Optuna's samplers; it chooses the best of a single try.

    The warm-up is drawn here: the samplers would draw it from the stream that they use again afterwards.

    :param sampler: name of the sampler's class, which chooses after the warm-up
    :param settings: Settings of the search, of which there are none
    :param box: ranges of the parameters
    :param seed: seed of the draws
    :param start: how to begin
    """

    def __init__(self, sampler: str, settings: AgentSettings, box: Box, seed: int, start: Start) -> None:
        import optuna

        from sarah.agents.even_warm_up import latin_hypercube

        # The tries in flight when the warm-up ends have no merit yet, and are not waited for.
        made = getattr(optuna.samplers, sampler)(seed=seed, n_startup_trials=start.warm_up - start.slots + 1)
        verbosity = optuna.logging.get_verbosity()
        optuna.logging.set_verbosity(optuna.logging.ERROR)
        try:
            self._study = optuna.create_study(direction="maximize", sampler=made)
        finally:
            optuna.logging.set_verbosity(verbosity)
        self._box = box
        self._ranges: dict[str, Any] = {
            name: optuna.distributions.FloatDistribution(-1.0, 1.0) for name in map(str, range(len(box.parameters)))
        }
        first = [] if start.first is None else [box.scaled(start.first)]
        generator = np.random.default_rng(seed)
        shape = (start.warm_up - len(first), len(box.parameters))
        drawn = generator.uniform(-1.0, 1.0, shape) if first else latin_hypercube(*shape, generator)
        for action in (*first, *drawn.tolist()):
            self._study.enqueue_trial(dict(zip(self._ranges, action, strict=True)))
        self._asked: deque[Any] = deque()

    def ready(self) -> bool:
        """Always: the samplers know of tries that are under way."""
        return True

    def ask(self, left: float = math.inf) -> Parameters:
        """Choose parameters."""
        trial = self._study.ask(self._ranges)
        self._asked.append(trial)
        return self._box.unscaled(trial.params[name] for name in self._ranges)

    def tell(self, parameters: Parameters, merit: float, fell: bool = False) -> None:
        """Tell the merit of the oldest try."""
        self._study.tell(self._asked.popleft(), min(LARGEST_MERIT, max(-LARGEST_MERIT, merit)))

    def choice(self) -> Parameters:
        """The best of a single try."""
        return self._box.unscaled(self._study.best_params[name] for name in self._ranges)


OPTIMISERS: dict[str, Callable[[Any, Box, int, Start], Search]] = {
    "cma-es": EvolutionStrategy,
    "gp": partial(OptunaSearch, "GPSampler"),
    "tpe": partial(OptunaSearch, "TPESampler"),
    "random": RandomSearch,
}
"""What makes the search of a training, by the algorithm's name: of its settings, the ranges of the parameters,
the seed of everything that it draws, and how it begins."""
