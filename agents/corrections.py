"""Returns without the part that known disturbances explain."""

import numpy as np

FEWEST_EPISODES = 20
"""Number of episodes below which nothing is corrected: so few explain too little."""
MOST_FITTED = 2_000
"""Newest episodes that the explanation is fitted to: with more, a correction takes hardly longer."""
PENALTY = 30.0
"""Penalty of the ridge regression: as if so many further episodes had shown no effect."""
CHANCE = 0.1
"""Probability with which disturbances that explain nothing are taken for some that do, and corrected for."""
OUTER_DECILES = (0.1, 0.9)
LARGEST_DISTANCE = 3.0
"""Largest distance of a return below the lowest decile, in distances between the outer deciles: lower ones count as
that."""
SMALLEST_DEVIATION = 1e-12
"""Standard deviation, as a share of the largest amount, below which a number counts as constant."""


def bounded(returns: np.ndarray) -> np.ndarray:
    """
    Returns of which none is lower than most by far: a few disasters would outweigh all others (Huber 1964).

    :param returns: Returns of shape (n,)
    :return: The returns, at least the lowest decile less three times the distance between the outer deciles; the given
        ones if these are the same
    """
    if not len(returns):
        return returns
    low, high = np.quantile(returns, OUTER_DECILES)
    return np.maximum(returns, low - LARGEST_DISTANCE * (high - low)) if high > low else returns


def corrected(returns: np.ndarray, disturbances: np.ndarray) -> np.ndarray:
    """
    Returns less what a ridge regression on the disturbances, their squares and their products explains of them.

    A disturbance that explains no more by itself than chance would is left out: many that matter little would hide the
    few that matter. The mean stays. A return that is not finite stays as it is, and explains nothing.

    :param returns: Returns of the episodes, the newest last, of shape (n,)
    :param disturbances: Disturbances of the same episodes, of shape (n, number of disturbances)
    :return: Corrected returns, of shape (n,); the given ones if there are fewer than
        :data:`FEWEST_EPISODES`, if nothing varies, or if no disturbance tells
    """
    known = np.flatnonzero(np.isfinite(returns))
    if len(known) < FEWEST_EPISODES:
        return returns
    fitted = known[-MOST_FITTED:]
    scale = np.abs(returns[fitted]).max()
    if np.ptp(returns[fitted]) == 0:
        return returns
    targets = bounded(returns[fitted]) / scale
    targets -= targets.mean()
    disturbances = disturbances[:, _telling(disturbances[fitted], targets)]
    known_features, features = _features(disturbances[fitted], disturbances)
    if not features.shape[1]:
        return returns
    products = known_features.T @ known_features + PENALTY * np.eye(features.shape[1])
    explained = features @ np.linalg.solve(products, known_features.T @ targets)
    explained -= explained[known].mean()  # not 0 where the fit leaves some out
    return returns - scale * explained


def _telling(disturbances: np.ndarray, targets: np.ndarray) -> np.ndarray:
    """
    Indices of the disturbances that explain more than chance would, by a parabola (F test with 2 degrees of freedom).

    There are none unless one of them explains more than chance would in the best of so many (Bonferroni). Of a
    disturbance with two values, which has no parabola, the test asks a little more than that.

    :param disturbances: Disturbances, one row an episode
    :param targets: Returns with mean 0
    """
    kept, lines, _ = _standard(disturbances, disturbances)
    curves = lines**2 - 1
    curves -= lines * (lines * curves).mean(axis=0)  # What a line would explain as well
    curves /= np.sqrt((curves**2).mean(axis=0)) + SMALLEST_DEVIATION  # 0 if there are two values only
    explained = sum((parts.T @ targets) ** 2 for parts in (lines, curves)) / (len(targets) * (targets @ targets))
    probabilities = (1 - np.minimum(explained, 1)) ** ((len(targets) - 3) / 2)
    is_any = probabilities.size > 0 and probabilities.min() < CHANCE / probabilities.size
    return kept[probabilities < CHANCE] if is_any else kept[:0]


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
