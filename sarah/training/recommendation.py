"""The recommendation of a training: the best of a few candidates, which are simulated again side by side.

An agent's own choice stops at the edge of a flat crest. The best single episode was lucky. And the reward does not show
a robot that steps to a clock or drags its feet, so an episode without a valid gait has less merit here than its score.
For all algorithms, therefore, parameters are judged by the merit of the episodes around them. The last episodes of a
budget compare the best candidates, all on the same new seeds; the first of them stays unless another is clearly better.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from statistics import mean, stdev

import numpy as np

from sarah.agents.buffers import DOUBT
from sarah.episode.evaluation import SMALLEST_CLEARANCE, SMALLEST_SENSOR_SHARE, Evaluation
from sarah.episode.result import EpisodeResult
from sarah.episode.tasks import Task

Parameters = tuple[float, ...]

NEIGHBOURHOOD = 0.1
"""Distance up to which an episode counts for other parameters than its own, as a share of each parameter's range."""
CLEARLY = 2.0
"""Number of standard errors by which a candidate must be better than the first to take its place."""
DISTINCT = 0.1
"""Smallest distance between candidates, as a share of each parameter's range."""
SMALLEST_ROOM = 64
"""Number of rows for episodes at first. It doubles whenever they are full."""


def merit(result: EpisodeResult, must_step: bool = True) -> float:
    """Merit of an episode: its score, reduced in proportion to what its gait lacks to be valid.

    :param result: result of the episode
    :param must_step: whether the task wants a gait; otherwise the merit is the score
    """
    merit = result.score
    if not must_step:
        return merit
    for share in (
        result.sole_clearance / SMALLEST_CLEARANCE,
        result.shifts_by_sensors / SMALLEST_SENSOR_SHARE,
        result.lifts_by_sensors / SMALLEST_SENSOR_SHARE,
    ):
        share = min(1.0, share)
        merit *= share if merit > 0.0 else 2.0 - share  # a reward of your own can be negative
    return merit


class Tried:
    """Episodes so far, and the mean merit around each: kept up to date, so that a new one costs linear time.

    :param task: task that owns the parameters
    :param episodes: parameters and merit of each episode
    """

    def __init__(self, task: Task, episodes: Iterable[tuple[Parameters, float]] = ()) -> None:
        self.parameters: list[Parameters] = []
        """Parameters of every episode."""
        self._widths = np.array([parameter.width for parameter in task.parameters])
        # Of the choice, then of every episode, with room for more: the place, the merit, and of the episodes around it
        # the sums of their weights and of their weighted merits.
        self._places = np.zeros((SMALLEST_ROOM, len(self._widths)))
        self._merits, self._weights, self._weighted_merits = np.zeros((3, SMALLEST_ROOM))
        for episode in episodes:
            self.append(episode)

    def __len__(self) -> int:
        """Number of episodes."""
        return len(self.parameters)

    def append(self, episode: tuple[Parameters, float]) -> None:
        """Add an episode.

        :param episode: its parameters and its merit
        """
        parameters, merit = episode
        self.parameters.append(parameters)
        new = len(self)
        if new == len(self._merits):
            self._double_room()
        self._merits[new] = merit
        weights = self._put(new, parameters)
        self._weights[1:new] += weights[:-1]
        self._weighted_merits[1:new] += merit * weights[:-1]

    def best(self, choice: Parameters, count: int) -> list[Parameters]:
        """Choose the parameters whose neighbourhoods have the highest merit, not too close together.

        :param choice: parameters to choose among, beside those of the episodes
        :param count: largest number to choose
        :return: the best first; among equals the choice, then the oldest
        """
        self._put(0, choice)
        rows = slice(0, len(self) + 1)
        places = self._places[rows]
        # Doubt draws towards 0, or towards the worst of a reward that can be negative.
        worst = min(0.0, float(self._merits[1 : len(self) + 1].min(initial=0.0)))
        weights = self._weights[rows]
        means = (self._weighted_merits[rows] - worst * weights) / (weights + DOUBT)
        chosen: list[Parameters] = []
        while True:
            index = int(np.argmax(means))
            chosen.append(self.parameters[index - 1] if index else choice)
            if len(chosen) == count:
                return chosen
            means[squared_lengths(places - places[index]) < DISTINCT**2] = -np.inf
            if means.max() == -np.inf:
                return chosen

    def _put(self, row: int, parameters: Parameters) -> np.ndarray:
        """Put parameters into a row, with the sums of the episodes around them, whose weights are returned."""
        self._places[row] = np.array(parameters) / self._widths
        episodes = slice(1, len(self) + 1)
        weights: np.ndarray = np.exp(
            squared_lengths(self._places[episodes] - self._places[row]) / (-2 * NEIGHBOURHOOD**2)
        )
        self._weights[row] = weights.sum()
        self._weighted_merits[row] = weights @ self._merits[episodes]
        return weights

    def _double_room(self) -> None:
        self._places = np.vstack((self._places, np.zeros_like(self._places)))
        self._merits, self._weights, self._weighted_merits = (
            np.append(values, np.zeros_like(values)) for values in (self._merits, self._weights, self._weighted_merits)
        )


def squared_lengths(differences: np.ndarray) -> np.ndarray:
    """Squared length of each row.

    :param differences: array of shape (n, dimensions)
    """
    lengths: np.ndarray = np.einsum("ij,ij->i", differences, differences)
    return lengths


def best_compared(
    results: Mapping[Parameters, Sequence[EpisodeResult]], baseline: Evaluation | None, must_step: bool = True
) -> Parameters:
    """Choose a candidate after the comparison: the first, unless another one is better for certain.

    The first had the best neighbourhood, which often is more episodes than the comparison has: a larger mean alone
    would be luck where episodes differ much. So another candidate must be better by two standard errors of the
    difference on the same seeds. A valid gait that does not chatter comes before one that is not.

    :param results: results of each candidate's episodes, on the same seeds in turn; the best neighbourhood's come first
    :param baseline: evaluation that chatter is judged against; without one nothing chatters
    :param must_step: whether the task wants a gait; otherwise every gait is valid
    """
    merits = {candidate: [merit(result, must_step) for result in found] for candidate, found in results.items()}
    valid = [candidate for candidate, found in results.items() if _is_valid(found, baseline, must_step)]
    first, *others = valid or results
    better = [candidate for candidate in others if _is_clearly_larger(merits[candidate], merits[first])]
    return max(better, key=lambda candidate: mean(merits[candidate]), default=first)


def _is_valid(results: Sequence[EpisodeResult], baseline: Evaluation | None, must_step: bool) -> bool:
    if not results:
        return False
    evaluation = Evaluation(tuple(results))
    chatters = baseline is not None and evaluation.chatters(baseline)
    return (evaluation.is_gait or not must_step) and not chatters


def _is_clearly_larger(merits: Sequence[float], others: Sequence[float]) -> bool:
    """Whether merits are larger than others on the same seeds, by the mean of at least two differences."""
    differences = [merit - other for merit, other in zip(merits, others, strict=False)]
    return len(differences) > 1 and mean(differences) > CLEARLY * stdev(differences) / math.sqrt(len(differences))
