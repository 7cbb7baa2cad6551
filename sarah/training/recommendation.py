"""The recommendation of a training: the best of a few candidates, which are simulated again side by side.

An agent's own choice stops at the edge of a flat crest. The best single episode was lucky. And the reward does not show
a robot that steps to a clock or drags its feet, so an episode without a valid gait has less merit here than its score.
For all algorithms, therefore, parameters are judged by the merit that a Gaussian process expects after all episodes.
The last episodes of a budget compare the best candidates, all on the same new seeds; the first of them stays unless
another is clearly better.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from statistics import mean, stdev

import numpy as np

from sarah.episode.evaluation import SMALLEST_CLEARANCE, SMALLEST_SENSOR_SHARE, Evaluation
from sarah.episode.result import EpisodeResult
from sarah.episode.tasks import Task

Parameters = tuple[float, ...]

LENGTH = 0.2
"""Length scale of the Gaussian process, as a share of each parameter's range."""
NOISE = 1.0
"""Variance of an episode's merit by chance, as a share of the variance between parameters."""
MOST_EPISODES = 500
"""Number of episodes that are judged by: the last ones. The time that a choice takes grows with its third power."""
LARGEST_MERIT = 1e100
"""Largest merit by amount: larger ones, of a reward of your own, would overflow."""
CLEARLY = 2.0
"""Number of standard errors by which a candidate must be better than the first to take its place."""
DISTINCT = 0.1
"""Smallest distance between candidates, as a share of each parameter's range."""


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
    """Episodes so far, and the merit that a Gaussian process expects of their parameters.

    Its length scale is a fifth of each range, as fits the landscapes of both tasks.

    :param task: task that owns the parameters
    :param episodes: parameters and merit of each episode
    """

    def __init__(self, task: Task, episodes: Iterable[tuple[Parameters, float]] = ()) -> None:
        self.parameters: list[Parameters] = []
        """Parameters of every episode."""
        self._merits: list[float] = []
        self._widths = np.array([parameter.width for parameter in task.parameters])
        for episode in episodes:
            self.append(episode)

    def __len__(self) -> int:
        """Number of episodes."""
        return len(self.parameters)

    def append(self, episode: tuple[Parameters, float]) -> None:
        """Add an episode.

        :param episode: its parameters and its merit; one that is no number is as bad as can be
        """
        parameters, merit = episode
        self.parameters.append(parameters)
        self._merits.append(min(LARGEST_MERIT, max(-LARGEST_MERIT, merit)))

    def best(self, choice: Parameters, count: int) -> list[Parameters]:
        """Choose the parameters of which the highest merit is expected, not too close together.

        :param choice: parameters to choose among, beside those of the episodes
        :param count: largest number to choose
        :return: the best first; among equals the choice, then the oldest
        """
        candidates = [choice, *self.parameters[-MOST_EPISODES:]]
        places = np.array(candidates) / self._widths
        expected = expected_merits(places[1:], np.array(self._merits[-MOST_EPISODES:]), places)
        chosen: list[Parameters] = []
        while len(chosen) < count and expected.max() > -np.inf:
            index = int(np.argmax(expected))
            chosen.append(candidates[index])
            expected[_squared_distances(places, places[index : index + 1])[:, 0] < DISTINCT**2] = -np.inf
        return chosen


def expected_merits(tried: np.ndarray, merits: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Mean of a Gaussian process (Rasmussen and Williams 2006, equation 2.25).

    Its prior mean is doubt: 0, or the lower quartile of merits that can be negative. So what nobody has tried is worth
    little.

    :param tried: parameters of the episodes as shares of their ranges, of shape (n, dimensions)
    :param merits: merits of the episodes, of shape (n,)
    :param places: parameters to judge, as shares of their ranges, of shape (m, dimensions)
    :return: expected merits, of shape (m,)
    """
    if not len(merits):
        return np.zeros(len(places))
    doubt = min(0.0, float(np.quantile(merits, 0.25)))
    covariances = _covariances(tried, tried) + NOISE * np.eye(len(tried))
    expected: np.ndarray = doubt + _covariances(places, tried) @ np.linalg.solve(covariances, merits - doubt)
    return expected


def _covariances(places: np.ndarray, others: np.ndarray) -> np.ndarray:
    with np.errstate(under="ignore"):  # what is far away says nothing
        covariances: np.ndarray = np.exp(_squared_distances(places, others) / (-2.0 * LENGTH**2))
    return covariances


def _squared_distances(places: np.ndarray, others: np.ndarray) -> np.ndarray:
    # By a matrix product: differences of all pairs would take several times as long.
    lengths, other_lengths = ((rows**2).sum(axis=1) for rows in (places, others))
    distances: np.ndarray = lengths[:, None] + other_lengths - 2.0 * places @ others.T
    return distances


def best_compared(
    results: Mapping[Parameters, Sequence[EpisodeResult]], baseline: Evaluation | None, must_step: bool = True
) -> Parameters:
    """Choose a candidate after the comparison: the first, unless another one is clearly better.

    The first is the best after all episodes, which are more than the comparison has: a larger mean alone would be luck
    where episodes differ much. So another candidate must be better by two standard errors of the difference on the same
    seeds. A valid gait that does not chatter comes before any other.

    :param results: results of each candidate's episodes, on the same seeds in turn; the first choice comes first
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
