"""Uncertainty of a race's scores, which come from few seeds and noisy judging episodes.

Scores are arrays of shape (trainings, episodes): the score of each training's final recommendation in each judging
episode. A column is one episode, which all trainings meet, so a lucky episode lifts all scores and cancels in their
differences.
"""

from __future__ import annotations

import math
from typing import TypeVar

import numpy as np
from scipy.special import stdtrit  # scipy.stats has it too, and takes a second to import

Scores = TypeVar("Scores", float, np.ndarray)
CONFIDENCE = 0.95
BOOTSTRAP_DRAWS = 2000
FEWEST_DRAWN = 4
"""Number of judging episodes below which drawing them again says nothing of other ones."""


def standard_error(scores: np.ndarray) -> float:
    """Standard error of the mean score, over trainings and judging episodes together.

    A score is the sum of a mean, an effect of its training, an effect of its episode, and a rest, all of them random.
    With the mean squares of the two-way table, :math:`(M_t + M_e - M_r) / (n_t n_e)` is the variance of the mean
    without bias. A component that comes out negative counts as zero.

    :param scores: scores of shape (trainings, episodes)
    :return: the error; of one training over episodes only, of one episode over trainings only, and of a single score
        NaN, as nothing is known
    """
    trainings, episodes = scores.shape
    of_trainings, of_episodes = scores.mean(axis=1), scores.mean(axis=0)
    squares = []
    if trainings > 1:
        squares.append(episodes * of_trainings.var(ddof=1))
    if episodes > 1:
        squares.append(trainings * of_episodes.var(ddof=1))
    if not squares:
        return math.nan
    rest = scores - of_trainings[:, np.newaxis] - of_episodes + scores.mean()
    of_rest = (rest**2).sum() / ((trainings - 1) * (episodes - 1)) if len(squares) == 2 else 0.0
    return math.sqrt((of_rest + sum(max(square - of_rest, 0.0) for square in squares)) / scores.size)


def difference(scores: np.ndarray, others: np.ndarray) -> tuple[float, float, float]:
    """Mean difference between two algorithms, with its interval over seeds and judging episodes.

    Scores are paired: those of the same seed, in the same episode. What both algorithms share drops out.

    :param scores: scores of one algorithm, of shape (trainings, episodes)
    :param others: scores of the other, with the same seeds and episodes
    :return: the difference and both ends of Student's 95 % interval; NaN if there is only one training of each, which
        says nothing of other seeds
    """
    paired = scores - others
    trainings, episodes = paired.shape
    if trainings == 1:
        return float(paired.mean()), math.nan, math.nan
    freedom = (min(trainings, episodes) if episodes > 1 else trainings) - 1
    half = float(stdtrit(freedom, (1 + CONFIDENCE) / 2)) * standard_error(paired)
    return float(paired.mean()), float(paired.mean() - half), float(paired.mean() + half)


def best_known(scores: np.ndarray, count: int | None = None) -> float:
    """Score of the best training, as far as it is known.

    The highest of noisy means is too high, because luck helps to be the highest. So the episodes that choose the best
    training are not those that score it: for each half of the episodes, the training with the highest mean in all other
    episodes is scored by this half. The mean of both is the score. A single episode has to do both.

    :param scores: scores of shape (trainings, episodes)
    :param count: number of episodes that say how good it is, the first ones; all of them choose. By default all do both
    """
    episodes = scores.shape[1]
    return float(_best_known(scores, np.ones((1, episodes)), count or episodes)[0])


def _best_known(scores: np.ndarray, weights: np.ndarray, count: int) -> np.ndarray:
    """Score of the best training for several weights of the episodes, of shape (draws, episodes)."""
    found = []
    for half in _halves(scores.shape[1], count):
        others = half if half.all() else ~half
        chosen = (scores @ (weights * others).T).argmax(axis=0)
        judging = weights * half
        found.append((scores[chosen] * judging).sum(axis=1) / judging.sum(axis=1))
    return np.mean(found, axis=0)


def _halves(episodes: int, count: int) -> list[np.ndarray]:
    """Every second one of the first episodes, and those between, as masks; of a single episode there is one half."""
    numbers = np.arange(episodes)
    return [(numbers % 2 == half) & (numbers < count) for half in range(min(count, 2))]


def share_of(best: Scores, share: float) -> Scores:
    """Score that is a share of the best known one, also where that is below zero.

    :param best: best known score, or an array of such
    :param share: share, such as 0.95
    """
    return best - (1.0 - share) * abs(best)


def number_at(
    scores: np.ndarray, chosen: np.ndarray, share: float, best: float | np.ndarray | None = None
) -> tuple[int, int, int]:
    """Number of trainings whose mean score is at least a share of the best known one, with its 95 % interval.

    The interval knows the noise of the judge: it has the percentiles of a bootstrap over the judging episodes, drawn
    alike for all trainings, and within each of the halves that :func:`best_known` takes. It is widened to the number
    itself, which draws can miss. A half of a single episode cannot be drawn otherwise: then any number is possible.

    :param scores: scores of all trainings, of shape (trainings, episodes)
    :param chosen: mask of the trainings that are counted
    :param share: share of the best known score
    :param best: best known score, or scores of the best known in the same episodes, whose luck drops out; by default
        that of these scores, in every draw anew
    :return: the number and both ends of its interval
    """
    episodes = scores.shape[1]
    generator, weights = np.random.default_rng(0), np.zeros((1 + BOOTSTRAP_DRAWS, episodes))
    weights[0] = 1.0
    for half in _halves(episodes, episodes):
        size = int(half.sum())
        weights[1:, half] = generator.multinomial(size, np.full(size, 1.0 / size), BOOTSTRAP_DRAWS)
    means = scores[chosen] @ weights.T / episodes
    if best is None:
        bests = _best_known(scores, weights, episodes)
    else:
        bests = weights @ np.broadcast_to(best, episodes) / episodes
    found, *drawn = (means >= share_of(bests, share)).sum(axis=0).tolist()
    if episodes < FEWEST_DRAWN:
        return found, 0, int(chosen.sum())
    ends = ((1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2)
    low, high = np.quantile(drawn, ends, method="inverted_cdf").tolist()
    return found, min(low, found), max(high, found)
