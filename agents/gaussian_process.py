"""The rewards that a Gaussian process expects of actions after some episodes, and the action with the highest."""

import math
from collections.abc import Sequence

import numpy as np

LENGTHS = (0.6, 0.3)
"""Lengths to choose from, in actions scaled to [-1, 1]; the first is the prior's favourite.
With more than four numbers they grow with the distances in the box, as the root of the number."""
NOISES = (1.0, 0.3, 0.1, 0.03)
"""Variances of a reward by chance to choose from, as shares of the variance between actions; likewise."""
BELIEF = 1.0
"""Log-likelihood that a step away from the first length costs; a step away from the first noise costs half of it."""
FEWEST_TO_CHOOSE = 10
"""Number of episodes below which length and noise are the first ones: so few tell them badly."""
PRIOR_QUANTILE = 0.1
"""Quantile of the rewards that is expected where nothing is known."""
MOST_EPISODES = 500
"""Newest episodes that are known: the time that an expectation takes grows with the third power of their number."""
ANYWHERE = 128
"""Number of places in the box, drawn uniformly, at which the search for the best begins beside the known ones."""
STEPS = (0.2, 0.1, 0.05, 0.025)
"""Standard deviations of the draws around the best places so far, in scaled actions: one for each round."""
BEST_PLACES, DRAWS = 6, 10
"""Number of places that a round draws around, and of draws around each."""
SMALLEST_UNKNOWN = 1e-12
"""Smallest share of the variance that is unknown where the expectation is climbed: a slope divides by its root."""
OUTER_DECILES = (0.1, 0.9)
LARGEST_DISTANCE = 3.0
"""Largest distance of a return below the lowest decile, in distances between the outer deciles: lower ones count as
that."""


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


class GaussianProcess:
    """
    Rewards that are expected of actions: the mean of a Gaussian process (Rasmussen and Williams 2006, equation 2.25)

    Its kernel is a Gaussian of the distance between actions. Length and noise are the likeliest of a few, with a prior
    for long lengths and much noise. Where nothing is known it expects the lowest decile of the rewards, so untried
    actions are not attractive. Shift and scale of the rewards make no difference.

    :param actions: Actions of the episodes, scaled to [-1, 1], of shape (n, dim), the newest last
    :param rewards: Rewards of the episodes, finite, of shape (n,)
    :param kernel: Length and noise; by default the likeliest ones
    :param length_scales: Factor on the length along each dimension; by default 1
    """

    def __init__(
        self,
        actions: np.ndarray,
        rewards: np.ndarray,
        kernel: tuple[float, float] | None = None,
        length_scales: Sequence[float] | None = None,
    ) -> None:
        from scipy.linalg import cho_solve  # Here, because plain NAF needs no scipy

        self._known = np.asarray(actions[-MOST_EPISODES:], dtype=float)
        known = bounded(np.asarray(rewards[-MOST_EPISODES:], dtype=float))
        self._doubt = float(np.quantile(known, PRIOR_QUANTILE)) if len(known) else 0.0
        self._length_scales = np.ones(self._known.shape[1]) if length_scales is None else np.array(length_scales)
        self._scaled_known = self._known / self._length_scales
        distances = _squared_distances(self._scaled_known, self._scaled_known)
        lengths = _lengths(self._known.shape[1])
        self.kernel = _likeliest(distances, known - self._doubt, lengths) if kernel is None else kernel
        self._length, noise = self.kernel
        covariances = _covariances(distances, self._length) + noise * np.eye(len(known))
        self._factor = np.linalg.cholesky(covariances)
        self._weights = cho_solve((self._factor, True), known - self._doubt)
        self._variance = float((known - self._doubt) @ self._weights) / max(len(known), 1)

    def expected(self, actions: np.ndarray) -> np.ndarray:
        """
        Expected rewards.

        :param actions: Scaled actions, of shape (m, dim)
        :return: Expected rewards, of shape (m,)
        """
        covariances = self._covariances_with(actions)
        return self._doubt + covariances @ self._weights

    def upper_bounds(self, actions: np.ndarray, deviations: float) -> np.ndarray:
        """
        Expected rewards, and some standard deviations more: what actions may be worth (Srinivas et al. 2010).

        The variance between actions is that of the highest likelihood. Noise is left out.

        :param actions: Scaled actions, of shape (m, dim)
        :param deviations: Number of standard deviations
        :return: Bounds of shape (m,)
        """
        from scipy.linalg import solve_triangular

        covariances = self._covariances_with(actions)
        explained = solve_triangular(self._factor, covariances.T, lower=True) ** 2
        unknown = self._variance * np.maximum(1 - explained.sum(axis=0), 0)
        return self._doubt + covariances @ self._weights + deviations * np.sqrt(unknown)

    def best(self, candidates: np.ndarray | None = None, deviations: float = 0.0) -> np.ndarray:
        """
        Action of the highest expected reward in the box from -1 to 1.

        Random draws come ever closer to the best so far, and from there the expectation is climbed.

        :param candidates: Scaled actions to begin at beside the known ones; the first one among equals
        :param deviations: Number of standard deviations by which an action may be better than expected
        :return: A scaled action, of shape (dim,)
        """

        def value_of(places: np.ndarray) -> np.ndarray:
            return self.upper_bounds(places, deviations) if deviations else self.expected(places)

        generator = np.random.default_rng(0)  # The same draws each time, so that episodes alone decide
        places = self._known if candidates is None else np.vstack([candidates, self._known])
        places = np.vstack([places, generator.uniform(-1, 1, (ANYWHERE, places.shape[1]))])
        values = value_of(places)
        for step in STEPS:
            highest = np.argsort(-values, kind="stable")[:BEST_PLACES]
            draws = generator.normal(np.repeat(places[highest], DRAWS, axis=0), step).clip(-1, 1)
            places = np.vstack([places[highest], draws])
            values = np.concatenate([values[highest], value_of(draws)])
        return self._climbed(places[np.argmax(values)], deviations)

    def _climbed(self, action: np.ndarray, deviations: float) -> np.ndarray:
        """The top of the hill that an action is on, by its gradients (L-BFGS-B, Byrd et al. 1995)."""
        from scipy.linalg import cho_solve
        from scipy.optimize import minimize

        if not self._variance:
            return action
        known_weights = self._weights / math.sqrt(self._variance)

        def depth(place: np.ndarray) -> tuple[float, np.ndarray]:
            covariances = _covariances(_squared_distances(place[None], self._scaled_known), self._length)[0]
            value, weights = covariances @ known_weights, known_weights
            if deviations:
                explaining = cho_solve((self._factor, True), covariances)
                unknown = math.sqrt(max(1 - covariances @ explaining, SMALLEST_UNKNOWN))
                value += deviations * unknown
                weights = known_weights - deviations / unknown * explaining
            slope = (weights * covariances) @ (self._scaled_known - place) / self._length**2
            return -value, -slope

        bounds = [(-1 / scale, 1 / scale) for scale in self._length_scales]
        top = minimize(depth, action / self._length_scales, jac=True, bounds=bounds, method="L-BFGS-B").x
        return (top * self._length_scales).clip(-1, 1)

    def _covariances_with(self, actions: np.ndarray) -> np.ndarray:
        """Covariances of some actions with the known ones, of shape (m, n)."""
        return _covariances(_squared_distances(actions / self._length_scales, self._scaled_known), self._length)


def first_covariances(actions: np.ndarray) -> np.ndarray:
    """
    Covariances of the rewards of actions by the first length and noise, as multiples of the variance by chance.

    :param actions: Scaled actions, of shape (n, dim)
    :return: Covariances, of shape (n, n)
    """
    length, noise = _lengths(actions.shape[1])[0], NOISES[0]
    return np.eye(len(actions)) + _covariances(_squared_distances(actions, actions), length) / noise


def _lengths(dim: int) -> list[float]:
    """Lengths to choose from in a box of some dimensions."""
    growth = math.sqrt(max(dim, 4) / 4)
    return [growth * length for length in LENGTHS]


def _likeliest(distances: np.ndarray, rewards: np.ndarray, lengths: Sequence[float]) -> tuple[float, float]:
    """Length and noise of the highest likelihood and belief; the variance between actions follows from them."""
    count = len(rewards)
    if count < FEWEST_TO_CHOOSE or not rewards.any():
        return lengths[0], NOISES[0]
    found = []
    for step, length in enumerate(lengths):
        variances, vectors = np.linalg.eigh(_covariances(distances, length))
        parts = (vectors.T @ (rewards / np.abs(rewards).max())) ** 2
        for half_step, noise in enumerate(NOISES):
            spread = np.maximum(variances, 0) + noise
            likelihood = -(count * np.log((parts / spread).mean()) + np.log(spread).sum()) / 2
            found.append((likelihood - BELIEF * (step + half_step / 2), (length, noise)))
    return max(found)[1]


def _squared_distances(actions: np.ndarray, others: np.ndarray) -> np.ndarray:
    # By a matrix product: differences of all pairs would take several times as long
    actions, others = (np.asarray(rows, dtype=float) for rows in (actions, others))
    lengths, other_lengths = ((rows**2).sum(axis=1) for rows in (actions, others))
    distances: np.ndarray = lengths[:, None] + other_lengths - 2 * actions @ others.T
    return np.maximum(distances, 0)


@np.errstate(under="ignore")  # What is far away says nothing
def _covariances(squared_distances: np.ndarray, length: float) -> np.ndarray:
    return np.exp(squared_distances / (-2 * length**2))
