"""Black-box optimisers, which many would take for a few numbers and costly episodes, behind the same command.

They see no observation: they are asked for an action, a task's parameters scaled to [-1, 1], and told its return,
without what known disturbances explain of it.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from sarah.runs.agent_settings import WARM_UP, AgentSettings, EvolutionSettings

LARGEST_RETURN = 1e100
"""Largest return by amount that a sampler of Optuna is told: squares of larger ones would overflow."""


class Optimiser(Protocol):
    """An optimiser that is asked and told, in the same order, with several episodes in between."""

    def ready(self) -> bool:
        """Whether it can be asked before it is told more."""

    def ask(self) -> np.ndarray:
        """The next action to try."""

    def tell(self, action: np.ndarray, episode_return: float) -> None:
        """Report the return of the oldest action that it was asked for.

        :param action: the action that was asked for
        :param episode_return: corrected return of its episode
        """

    def choice(self) -> np.ndarray:
        """The action that it would recommend now."""


@dataclass(frozen=True)
class Start:
    """How an optimiser begins, which is as NAF does.

    :param at_centre: whether the first action is the centre of the box
    :param warm_up: number of actions before the ones that a model chooses, of optimisers that have a model
    :param slots: number of episodes in flight
    """

    at_centre: bool = False
    warm_up: int = WARM_UP
    slots: int = 1


class RandomSearch:
    """Actions drawn uniformly; it recommends the best one.

    :param dimensions: number of an action's elements
    :param seed: seed of the draws
    :param at_centre: whether the first action is the centre of the box instead
    """

    def __init__(self, dimensions: int, seed: int, at_centre: bool = False) -> None:
        self._at_centre = at_centre
        self._generator = np.random.default_rng(seed)
        self._best = np.zeros(dimensions)
        self._best_return = -np.inf

    def ready(self) -> bool:
        """Always."""
        return True

    def ask(self) -> np.ndarray:
        """Draw an action."""
        if self._at_centre:
            self._at_centre = False
            return np.zeros(self._best.shape)
        return self._generator.uniform(-1.0, 1.0, self._best.shape)

    def tell(self, action: np.ndarray, episode_return: float) -> None:
        """Keep the action if it is the best so far."""
        if episode_return > self._best_return:
            self._best, self._best_return = action, episode_return

    def choice(self) -> np.ndarray:
        """The best single episode's."""
        return self._best


class EvolutionStrategy:
    """CMA-ES (Hansen and Ostermeier 2001) from the package ``cma``; it recommends its mean.

    A generation is asked for together, and the next one only when all of it has been told.

    :param settings: Settings of the strategy
    :param dimensions: number of an action's elements
    :param seed: seed of the draws
    :param at_centre: whether the first action is the first generation's mean, the centre of the box
    """

    def __init__(self, settings: EvolutionSettings, dimensions: int, seed: int, at_centre: bool = False) -> None:
        import cma

        # The package takes a seed of 0 for the time of day.
        options = {"bounds": [-1.0, 1.0], "popsize": settings.population, "seed": seed % 2**31 + 1, "verbose": -9}
        if dimensions == 1:
            options["maxstd"] = np.inf  # of a single deviation the package cannot bound any
        self._strategy = cma.CMAEvolutionStrategy(np.zeros(dimensions), settings.deviation, options)
        if at_centre:
            self._strategy.inject([np.zeros(dimensions)], force=True)
        self._unasked: deque[np.ndarray] = deque()
        self._told: list[tuple[np.ndarray, float]] = []
        self._generation: list[np.ndarray] = []

    def ready(self) -> bool:
        """Not while the last of a generation are being tried."""
        return bool(self._unasked) or len(self._told) == len(self._generation)

    def ask(self) -> np.ndarray:
        """The next of the generation, or the first of a new one."""
        if not self._unasked:
            self._generation, self._told = self._strategy.ask(), []
            self._unasked.extend(self._generation)
        return self._unasked.popleft()

    def tell(self, action: np.ndarray, episode_return: float) -> None:
        """Note a return, and update the distribution once the generation is complete."""
        self._told.append((action, -episode_return))
        if len(self._told) == len(self._generation):
            self._strategy.tell(*zip(*self._told, strict=True))

    def choice(self) -> np.ndarray:
        """The mean of the distribution."""
        return np.asarray(self._strategy.result.xfavorite)


class OptunaSearch:
    """One of Optuna's samplers; it recommends the best single episode.

    The warm-up's actions are drawn here: the samplers would draw them from the stream that they use again afterwards.

    :param dimensions: number of an action's elements
    :param sampler: sampler that chooses the actions after the warm-up
    :param warm_up: actions of the warm-up
    """

    def __init__(self, dimensions: int, sampler: Any, warm_up: np.ndarray) -> None:
        import optuna

        verbosity = optuna.logging.get_verbosity()
        optuna.logging.set_verbosity(optuna.logging.ERROR)
        try:
            self._study = optuna.create_study(direction="maximize", sampler=sampler)
        finally:
            optuna.logging.set_verbosity(verbosity)
        self._box: dict[str, Any] = {
            str(index): optuna.distributions.FloatDistribution(-1.0, 1.0) for index in range(dimensions)
        }
        for action in warm_up:
            self._study.enqueue_trial(dict(zip(self._box, map(float, action), strict=True)))
        self._asked: deque[Any] = deque()

    def ready(self) -> bool:
        """Always: the samplers know of episodes that are under way."""
        return True

    def ask(self) -> np.ndarray:
        """Choose the action of an episode."""
        trial = self._study.ask(self._box)
        self._asked.append(trial)
        return np.array([trial.params[name] for name in self._box])

    def tell(self, action: np.ndarray, episode_return: float) -> None:
        """Tell the oldest episode's return."""
        bounded = min(LARGEST_RETURN, max(-LARGEST_RETURN, episode_return))
        self._study.tell(self._asked.popleft(), bounded)

    def choice(self) -> np.ndarray:
        """The best single episode's."""
        return np.array([self._study.best_params[name] for name in self._box])


def _random_search(settings: AgentSettings, dimensions: int, seed: int, start: Start) -> Optimiser:
    return RandomSearch(dimensions, seed, start.at_centre)


def _evolution_strategy(settings: EvolutionSettings, dimensions: int, seed: int, start: Start) -> Optimiser:
    return EvolutionStrategy(settings, dimensions, seed, start.at_centre)


def _gaussian_process(settings: AgentSettings, dimensions: int, seed: int, start: Start) -> Optimiser:
    from optuna.samplers import GPSampler

    return _optuna_search(GPSampler, dimensions, seed, start)


def _parzen_estimator(settings: AgentSettings, dimensions: int, seed: int, start: Start) -> Optimiser:
    from optuna.samplers import TPESampler

    return _optuna_search(TPESampler, dimensions, seed, start)


def _optuna_search(sampler_type: Any, dimensions: int, seed: int, start: Start) -> Optimiser:
    # The actions that are in flight when the warm-up ends have no return yet, and are not waited for.
    known = start.warm_up - start.slots + 1
    first = RandomSearch(dimensions, seed, start.at_centre)
    sampler = sampler_type(seed=seed, n_startup_trials=known)
    return OptunaSearch(dimensions, sampler, np.array([first.ask() for _ in range(start.warm_up)]))


OPTIMISERS: dict[str, Callable[[Any, int, int, Start], Optimiser]] = {
    "cma-es": _evolution_strategy,
    "gp": _gaussian_process,
    "tpe": _parzen_estimator,
    "random": _random_search,
}
"""Functions that make an optimiser, by the algorithm's name: of its settings, the number of an action's elements, the
seed of everything that it draws, and how it begins."""
