"""Returns without the part that known disturbances explain."""

import math
from collections.abc import Callable

import numpy as np

from sarah.agents.gaussian_process import bounded, first_covariances

FEWEST_EPISODES = 20
"""Number of episodes below which nothing is corrected: so few explain too little."""
MOST_FITTED = 500
"""Newest episodes that the explanation is fitted to: the time that it takes grows with the third power of them."""
PENALTY = 30.0
"""Penalty of the ridge regression: as if so many further episodes had shown no effect."""
CHANCE = 0.1
"""Probability with which disturbances that explain nothing are taken for some that do, and corrected for."""
EPISODES_PER_FEATURE = 2
"""Fewest episodes for each feature of the regression: more features would explain anything."""
SMALLEST_DEVIATION = 1e-12
"""Standard deviation, as a share of the largest amount, below which a number counts as constant."""
Linear = Callable[[np.ndarray], np.ndarray]
"""A linear function of a column, or of several, with a row for each episode."""


def corrected(returns: np.ndarray, actions: np.ndarray, disturbances: np.ndarray) -> np.ndarray:
    """
    Returns less what a ridge regression on the disturbances, their squares and their products explains of them.

    It explains what a smooth function of the actions leaves of the returns, by what that leaves of the disturbances
    (Speckman 1988). Otherwise a disturbance that changes while the agent learns would explain what was learned. The
    function is the expectation of a :class:`~sarah.agents.gaussian_process.GaussianProcess` with the first length and
    noise.

    Nothing is explained unless one of the disturbances explains more than chance would in the best of so many. Then
    those are left out that explain no more by themselves than chance would: many that matter little would hide the few
    that matter. Of the others the most telling are taken, as many as there are episodes for. The mean stays. A return
    that is not finite stays as it is. Neither such an episode explains anything, nor one whose action is not finite.

    :param returns: Returns of the episodes, the newest last, of shape (n,)
    :param actions: Actions of the same episodes, scaled to [-1, 1], of shape (n, dim)
    :param disturbances: Disturbances of the same episodes, of shape (n, number of disturbances)
    :return: Corrected returns, of shape (n,); the given ones if there are fewer than
        :data:`FEWEST_EPISODES`, if nothing varies, or if no disturbance tells
    """
    from scipy.linalg import cho_solve, solve_triangular  # Here, because plain NAF needs no scipy

    known = np.flatnonzero(np.isfinite(returns) & np.isfinite(actions).all(axis=1))
    if len(known) < FEWEST_EPISODES or not disturbances.shape[1]:
        return returns
    fitted = known[-MOST_FITTED:]
    scale = np.abs(returns[fitted]).max()
    if np.ptp(returns[fitted]) <= SMALLEST_DEVIATION * scale:
        return returns
    targets = bounded(returns[fitted] / scale)
    factor = np.linalg.cholesky(first_covariances(actions[fitted]))
    independent = _without_mean(lambda rows: solve_triangular(factor, rows, lower=True), len(fitted))
    telling = _telling(disturbances[fitted], targets, independent)
    if not telling.size:
        return returns
    left = _without_mean(lambda rows: cho_solve((factor, True), rows), len(fitted))
    known_features, features = _features(disturbances[fitted][:, telling], disturbances[:, telling])
    known_features = left(known_features)
    penalty = PENALTY * (known_features**2).mean()  # An episode counts for less, the more its action explains
    products = known_features.T @ known_features + penalty * np.eye(features.shape[1])
    explained = features @ np.linalg.solve(products, known_features.T @ left(targets))
    explained -= explained[known].mean()  # not 0 where the fit leaves some out
    return returns - scale * explained


def _without_mean(function: Linear, episodes: int) -> Linear:
    """The function, and after it no part of what is the same in all episodes."""
    mean = function(np.ones(episodes))
    mean /= np.linalg.norm(mean)

    def without_mean(columns: np.ndarray) -> np.ndarray:
        columns = function(columns)
        return columns - np.tensordot(mean, mean @ columns, axes=0)

    return without_mean


def _telling(disturbances: np.ndarray, returns: np.ndarray, independent: Linear) -> np.ndarray:
    """
    Indices of the disturbances that explain more than chance would, by a parabola (F test with 2 degrees of freedom).

    There are none unless one of them explains more than chance would in the best of so many (Bonferroni). Of a
    disturbance with two values, which has no parabola, the test asks a little more than that.

    :param disturbances: Disturbances, one row an episode
    :param returns: Returns of the same episodes
    :param independent: What makes the episodes' rests independent of each other
    """
    kept, lines, _ = _standard(disturbances, disturbances)
    targets = independent(returns)
    explained = np.array([_explained(independent(np.column_stack([line, line**2])), targets) for line in lines.T])
    probabilities = (1 - np.minimum(explained, 1)) ** ((len(targets) - 3) / 2)
    if not probabilities.size or probabilities.min() >= CHANCE / probabilities.size:
        return kept[:0]
    first = np.argsort(probabilities, kind="stable")
    return kept[np.sort(first[probabilities[first] < CHANCE][: _most_disturbances(len(targets))])]


def _explained(columns: np.ndarray, targets: np.ndarray) -> float:
    """Share of the targets' square sum that columns explain."""
    directions, sizes, _ = np.linalg.svd(columns, full_matrices=False)
    directions = directions[:, sizes > SMALLEST_DEVIATION**0.5 * sizes[0]]
    return float(((directions.T @ targets) ** 2).sum() / (targets @ targets))


def _most_disturbances(episodes: int) -> int:
    """Largest number of disturbances whose values, squares and products of two so many episodes can explain."""
    return int((math.sqrt(9 + 8 * episodes / EPISODES_PER_FEATURE) - 3) / 2)


def _features(fitted: np.ndarray, every: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """
    Disturbances, and their products of two, each with mean 0 and standard deviation 1 in what is fitted.

    :param fitted: Disturbances of the episodes that are fitted, one row an episode
    :param every: Disturbances of all episodes
    :return: Features of the episodes that are fitted, and of all
    """
    _, *plain = _standard(fitted, every)
    first, second = np.triu_indices(plain[0].shape[1])
    _, *products = _standard(*(columns[:, first] * columns[:, second] for columns in plain))
    return np.hstack([plain[0], products[0]]), np.hstack([plain[1], products[1]])


def _standard(fitted: np.ndarray, every: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """
    Columns with mean 0 and standard deviation 1 in the rows that are fitted, and within the range that they have there:
    beyond it, squares and products would say anything.

    :param fitted: Rows that are fitted
    :param every: All rows
    :return: Indices of the columns that are not constant, those columns of the fitted rows, and those of all rows
    """
    # As shares of the largest amount: squares of large numbers would overflow
    largest = np.abs(fitted).max(axis=0)
    largest[largest == 0] = 1.0
    shares = fitted / largest
    means, deviations = shares.mean(axis=0), shares.std(axis=0)
    kept = np.flatnonzero(deviations > SMALLEST_DEVIATION)
    standard, of_every = ((rows[:, kept] / largest[kept] - means[kept]) / deviations[kept] for rows in (fitted, every))
    return kept, standard, of_every.clip(standard.min(axis=0), standard.max(axis=0))
