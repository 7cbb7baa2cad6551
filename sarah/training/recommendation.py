"""Which parameters a training recommends: those whose neighbourhood did best, and a few simulated again side by side.

An agent's own choice stops at the edge of a flat crest, the best single episode was lucky, and the reward does not see
a robot that steps to a clock or drags its feet: what falls short of a gait has less merit here than its score. So
parameters are judged by the episodes around them, whatever learns; and the last simulations of a budget compare the
best few, each on the same new seeds.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from sarah.agents.buffers import neighbourhood_means
from sarah.episode.evaluation import SMALLEST_CLEARANCE, SMALLEST_EVENT_SHARE

Parameters = tuple[float, ...]

NEIGHBOURHOOD = 0.075
"""Distance over which one episode says something of another's parameters, as a share of their box's width."""
DISTINCT = 0.1
"""Smallest distance between candidates, as such a share."""


def merit(info: Mapping[str, Any]) -> float:
    """What an episode says for its parameters: its score, less in proportion as the robot did not really step.

    :param info: the fields of its result
    """
    shares = (info["event_driven_shift"], info["event_driven_lift"])
    merit = float(info["score"]) * min(1.0, info["sole_clearance"] / SMALLEST_CLEARANCE)
    for share in shares:
        merit *= min(1.0, share / SMALLEST_EVENT_SHARE)
    return merit


def candidates(
    choice: Parameters, tried: Sequence[tuple[Parameters, float]], count: int, width: float
) -> list[Parameters]:
    """What is worth simulating again.

    :param choice: the algorithm's own
    :param tried: parameters and merit of every episode so far
    :param count: how many candidates
    :param width: of the parameters' box
    :return: of the choice and the tried parameters those whose neighbourhoods did best, the best one first, not too
        close together
    """
    parameters = [choice, *(tried_parameters for tried_parameters, _ in tried)]
    chosen: list[Parameters] = []
    for index in np.argsort(-_neighbourhood_merits(parameters, tried, width), kind="stable"):
        if len(chosen) == count:
            break
        if all(math.dist(parameters[index], other) >= DISTINCT * width for other in chosen):
            chosen.append(parameters[index])
    return chosen


def _neighbourhood_merits(
    parameters: Sequence[Parameters], tried: Sequence[tuple[Parameters, float]], width: float
) -> np.ndarray:
    if not tried:
        return np.zeros(len(parameters))
    places, merits = zip(*tried, strict=True)
    return neighbourhood_means(np.array(parameters), np.array(places), np.array(merits), NEIGHBOURHOOD * width)
