"""Returns without the part that known disturbances explain."""

import numpy as np

FEWEST_EPISODES = 20
"""Number of episodes below which nothing is corrected: so few explain too little."""
MOST_FITTED = 2_000
"""Newest episodes that the explanation is fitted to: with more, a correction takes hardly longer."""
PENALTY = 100.0
"""Penalty of the ridge regression, as a number of episodes whose returns speak against every weight."""
SMALLEST_DEVIATION = 1e-9
"""Standard deviation, as a share of the largest amount, below which a number counts as constant."""


def corrected(returns: np.ndarray, disturbances: np.ndarray) -> np.ndarray:
    """
    Returns less what a ridge regression on the disturbances, their squares and their products explains of them.

    The mean stays. A return that is not finite stays as it is, and explains nothing.

    :param returns: Returns of the episodes, the newest last, of shape (n,)
    :param disturbances: Disturbances of the same episodes, of shape (n, number of disturbances)
    :return: Corrected returns, of shape (n,); the given ones if there are fewer than 20, or if nothing varies
    """
    known = np.flatnonzero(np.isfinite(returns))
    if len(known) < FEWEST_EPISODES:
        return returns
    fitted = known[-MOST_FITTED:]
    features = _Features(disturbances[fitted])
    scale = np.abs(returns[fitted]).max()
    if not features.number or np.ptp(returns[fitted]) == 0:
        return returns
    targets = returns[fitted] / scale
    targets -= targets.mean()
    known_features = features.of(disturbances[fitted])
    products = known_features.T @ known_features + PENALTY * np.eye(features.number)
    weights = np.linalg.solve(products, known_features.T @ targets)
    blocks = [disturbances[start : start + MOST_FITTED] for start in range(0, len(disturbances), MOST_FITTED)]
    explained = np.concatenate([features.of(block) @ weights for block in blocks])
    explained -= explained[known].mean()  # not 0 where the fit leaves some out
    without: np.ndarray = returns - scale * explained
    return without


class _Features:
    """
    Disturbances, and their products of two, each with mean 0 and standard deviation 1 in what is fitted.

    :param fitted: Disturbances of the episodes that are fitted, one row an episode
    """

    def __init__(self, fitted: np.ndarray) -> None:
        self._plain = _Standard(fitted)
        self._first, self._second = np.triu_indices(self._plain.number)
        self._products = _Standard(self._products_of(self._plain.of(fitted)))
        self.number = self._plain.number + self._products.number

    def of(self, disturbances: np.ndarray) -> np.ndarray:
        """
        Features of some episodes.

        :param disturbances: Disturbances, one row an episode
        """
        plain = self._plain.of(disturbances)
        return np.hstack([plain, self._products.of(self._products_of(plain))])

    def _products_of(self, plain: np.ndarray) -> np.ndarray:
        products: np.ndarray = plain[:, self._first] * plain[:, self._second]
        return products


class _Standard:
    """
    Columns with mean 0 and standard deviation 1; constant ones are left out.

    :param columns: Columns whose mean and deviation are taken
    """

    def __init__(self, columns: np.ndarray) -> None:
        # As shares of the largest amount: squares of large numbers would overflow
        largest = np.abs(columns).max(axis=0)
        largest[largest == 0] = 1.0
        shares = columns / largest
        deviations = shares.std(axis=0)
        self._kept = np.flatnonzero(deviations > SMALLEST_DEVIATION)
        self._largest, self._means = largest[self._kept], shares.mean(axis=0)[self._kept]
        self._deviations = deviations[self._kept]
        self.number = len(self._kept)

    def of(self, columns: np.ndarray) -> np.ndarray:
        """
        Those of other rows, with the same means and deviations.

        :param columns: As many columns as were given first
        """
        standard: np.ndarray = (columns[:, self._kept] / self._largest - self._means) / self._deviations
        return standard
