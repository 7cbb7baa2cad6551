"""The recommendation of a training: the best of a few candidates, which are simulated again side by side.

An agent's own choice stops at the edge of a flat crest. The best single episode was lucky. And the reward does not show
a robot that steps to a clock or drags its feet, so an episode without a valid gait has less merit here than its score.
For all algorithms, therefore, parameters are judged by the merit of the episodes around them. The last episodes of a
budget compare the best candidates, all on the same new seeds.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import mean

import numpy as np

from sarah.agents.buffers import neighbourhood_means
from sarah.episode.evaluation import SMALLEST_CLEARANCE, SMALLEST_SENSOR_SHARE, Evaluation
from sarah.episode.result import EpisodeResult
from sarah.episode.tasks import Task

Parameters = tuple[float, ...]

NEIGHBOURHOOD = 0.075
"""Distance up to which an episode counts for other parameters than its own, as a share of each parameter's range."""
DISTINCT = 0.1
"""Smallest distance between candidates, as a share of each parameter's range."""


def merit(result: EpisodeResult) -> float:
    """Merit of an episode: its score, reduced in proportion to what its gait lacks to be valid.

    :param result: result of the episode
    """
    merit = result.score * min(1.0, result.sole_clearance / SMALLEST_CLEARANCE)
    for share in (result.shifts_by_sensors, result.lifts_by_sensors):
        merit *= min(1.0, share / SMALLEST_SENSOR_SHARE)
    return merit


def candidates(
    task: Task, choice: Parameters, tried: Sequence[tuple[Parameters, float]], count: int
) -> list[Parameters]:
    """Choose the candidates: parameters whose neighbourhoods have the highest merit, not too close together.

    :param task: task that owns the parameters
    :param choice: parameters that the algorithm itself would choose
    :param tried: parameters and merit of every episode so far
    :param count: number of candidates
    :return: candidates among the algorithm's choice and the tried parameters, the best one first
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


def rank(results: Sequence[EpisodeResult], baseline: Evaluation | None) -> tuple[bool, float]:
    """Rank a candidate: valid gaits that do not chatter rank first, and among equals the best mean merit.

    :param results: results of the candidate's episodes
    :param baseline: evaluation that chatter is judged against; without one nothing chatters
    :return: what is larger for the better candidate
    """
    if not results:
        return (False, 0.0)
    evaluation = Evaluation(tuple(results))
    chatters = baseline is not None and evaluation.chatters(baseline)
    return (evaluation.is_gait and not chatters, mean(merit(result) for result in results))
