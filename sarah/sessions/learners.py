"""The learners of a session, by the name that the command takes."""

from __future__ import annotations

from collections.abc import Callable

from sarah.operation.settings import Parameters
from sarah.sessions.learner import Learner


def _none(first: Parameters, seed: int) -> Learner:
    from sarah.sessions.searches import Frozen

    return Frozen(first)


def _random(first: Parameters, seed: int) -> Learner:
    from sarah.sessions.searches import RandomSearch

    return RandomSearch(first, seed)


def _evolution(first: Parameters, seed: int) -> Learner:
    from sarah.sessions.searches import EvolutionStrategy

    return EvolutionStrategy(first, seed)


def _gaussian_process(first: Parameters, seed: int) -> Learner:
    from sarah.sessions.gaussian_process import LocalGaussianProcess

    return LocalGaussianProcess(first, seed)


def _naf(first: Parameters, seed: int) -> Learner:
    from sarah.sessions.agent import AgentLearner

    return AgentLearner(first, seed)


LEARNERS: dict[str, Callable[[Parameters, int], Learner]] = {
    "none": _none,
    "gp": _gaussian_process,
    "naf": _naf,
    "cma-es": _evolution,
    "random": _random,
}
"""Functions that make a learner, of the first parameters and a seed. A learner's packages are imported when it is made:
the others are not needed for it."""
