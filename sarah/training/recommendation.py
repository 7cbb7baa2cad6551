"""Which parameters a training recommends: those whose neighbourhood did best, and a few simulated again side by side.

An agent's own choice stops at the edge of a flat crest, the best single episode was lucky, and the reward does not see
a robot that steps to a clock or drags its feet: what falls short of a gait has less merit here than its score. So
parameters are judged by the episodes around them, whatever learns; and the last episodes of a budget compare the
best few, each on the same new seeds.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sarah.agents.buffers import neighbourhood_means
from sarah.episode.evaluation import SMALLEST_CLEARANCE, SMALLEST_SENSOR_SHARE
from sarah.episode.result import EpisodeResult
from sarah.episode.tasks import Task

Parameters = tuple[float, ...]

NEIGHBOURHOOD = 0.075
"""Distance over which one episode says something of another's parameters, as a share of each one's range."""
DISTINCT = 0.1
"""Smallest distance between candidates, as such a share."""


def merit(result: EpisodeResult) -> float:
    """What an episode says for its parameters: its score, less in proportion as the robot did not really step.

    :param result: what came of the episode
    """
    merit = result.score * min(1.0, result.sole_clearance / SMALLEST_CLEARANCE)
    for share in (result.shifts_by_sensors, result.lifts_by_sensors):
        merit *= min(1.0, share / SMALLEST_SENSOR_SHARE)
    return merit


def candidates(
    task: Task, choice: Parameters, tried: Sequence[tuple[Parameters, float]], count: int
) -> list[Parameters]:
    """What is worth simulating again.

    :param task: whose parameters they are
    :param choice: the algorithm's own
    :param tried: parameters and merit of every episode so far
    :param count: number of candidates
    :return: of the choice and the tried parameters those whose neighbourhoods did best, the best one first, not too
        close together
    """
    parameters = [choice, *(tried_parameters for tried_parameters, _ in tried)]
    places = np.array(parameters) / [parameter.width for parameter in task.parameters]
    merits = np.zeros(len(parameters))
    if tried:
        merits = neighbourhood_means(places, places[1:], np.array([merit for _, merit in tried]), NEIGHBOURHOOD)
    chosen: list[int] = []
    for index in np.argsort(-merits, kind="stable"):
        if len(chosen) == count:
            break
        if all(math.dist(places[index], places[other]) >= DISTINCT for other in chosen):
            chosen.append(index)
    return [parameters[index] for index in chosen]
