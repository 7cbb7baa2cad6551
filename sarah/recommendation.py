"""Which parameters a training recommends: a few candidates, simulated again side by side.

An agent's own choice stops at the edge of a flat crest, and the best single episode was lucky. So the last simulations
of the budget compare the agent's choice with what did well around it in the episodes so far, each candidate on the
same new seeds.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

Parameters = tuple[float, ...]

SIMULATIONS_PER_CANDIDATE = 5
BUDGET_PER_CANDIDATE = 50
"""Simulations of the whole training for each candidate: a tenth of them goes into the comparison."""
NEIGHBOURHOOD = 0.15
"""Distance over which one episode says something of another's parameters."""
DISTINCT = 0.2
"""Smallest distance between candidates."""
DOUBT = 0.25
"""Episodes of score zero that every neighbourhood is thought to hold, so that single lucky ones do not win."""


def candidate_count(simulations: int) -> int:
    """How many candidates a budget affords; with one, there is nothing to compare.

    :param simulations: of the whole training
    """
    return max(1, simulations // BUDGET_PER_CANDIDATE)


def candidates(choice: Parameters, tried: Sequence[tuple[Parameters, float]], count: int) -> list[Parameters]:
    """What is worth simulating again.

    :param choice: the agent's own, always the first candidate
    :param tried: parameters and score of every episode so far
    :param count: how many candidates
    :return: the agent's choice, then the tried parameters whose neighbourhoods scored best, not too close together
    """
    chosen = [choice]
    by_merit = sorted(tried, key=lambda episode: _neighbourhood_score(episode[0], tried), reverse=True)
    for parameters, _ in by_merit:
        if len(chosen) == count:
            break
        if all(math.dist(parameters, other) >= DISTINCT for other in chosen):
            chosen.append(parameters)
    return chosen


def _neighbourhood_score(parameters: Parameters, tried: Sequence[tuple[Parameters, float]]) -> float:
    weights = [math.exp(-(math.dist(parameters, other) ** 2) / (2 * NEIGHBOURHOOD**2)) for other, _ in tried]
    total = sum(weight * score for weight, (_, score) in zip(weights, tried, strict=True))
    return total / (sum(weights) + DOUBT)
