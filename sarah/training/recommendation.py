"""The recommendation of a training: the parameters of which the highest merit is expected after all episodes.

An agent's own choice stops at the edge of a flat crest. The best single episode was lucky. And the reward does not show
a robot that steps to a clock or drags its feet, so an episode without a valid gait has less merit here than its score.
For all algorithms, therefore, parameters are judged by the merit that a Gaussian process expects, without the part that
known disturbances explain. Its maximum is looked for in the whole box of the parameters. The last episodes of a budget
try it: its gait must be valid, and its hips must not chatter.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from sarah.agents.corrections import corrected
from sarah.episode.evaluation import SMALLEST_CLEARANCE, SMALLEST_SENSOR_SHARE, Evaluation
from sarah.episode.result import EpisodeResult
from sarah.episode.tasks import Task

Parameters = tuple[float, ...]

LENGTH = 0.3
"""Length scale of the Gaussian process, as a share of each parameter's range."""
NOISE = 1.0
"""Variance of an episode's merit by chance, as a share of the variance between parameters."""
MOST_EPISODES = 500
"""Number of episodes that are judged by: the last ones. The time that a choice takes grows with its third power."""
LARGEST_MERIT = 1e100
"""Largest merit by amount: larger ones, of a reward of your own, would overflow."""
DISTINCT = 0.1
"""Smallest distance from parameters that failed when they were tried, as a share of each parameter's range."""
ANYWHERE = 256
"""Number of places in the box, drawn uniformly, at which the search for the maximum begins beside the episodes'."""
STEPS = (0.1, 0.05, 0.025, 0.0125)
"""Standard deviations of the draws around the best places so far, as shares of each range: one for each round."""
BEST_PLACES, DRAWS = 20, 15
"""Number of places that a round draws around, and of draws around each."""


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
    """Episodes so far, and the merit that a Gaussian process expects of any parameters.

    Its length scale is 0.3 of each range, as fits the landscapes of both tasks.

    :param task: task that owns the parameters
    """

    def __init__(self, task: Task) -> None:
        self._low = np.array([parameter.low for parameter in task.parameters])
        self._widths = np.array([parameter.width for parameter in task.parameters])
        self._places: list[np.ndarray] = []
        self._merits: list[float] = []
        self._disturbances: list[Sequence[float]] = []

    def __len__(self) -> int:
        """Number of episodes."""
        return len(self._merits)

    def append(self, parameters: Parameters, merit: float, disturbances: Sequence[float] | None = None) -> None:
        """Add an episode.

        :param parameters: parameters of the episode
        :param merit: merit of the episode; one that is no number is as bad as can be
        :param disturbances: disturbances of the episode, as many as those of all others
        """
        self._places.append(self._place_of(parameters))
        self._merits.append(min(LARGEST_MERIT, max(-LARGEST_MERIT, merit)))
        self._disturbances.append(() if disturbances is None else disturbances)

    def best(self, choice: Parameters, failed: Sequence[Parameters] = ()) -> Parameters:
        """Find the parameters of which the highest merit is expected.

        :param choice: parameters to begin the search at, beside those of the episodes
        :param failed: parameters that failed when they were tried, which are avoided
        :return: the best parameters; the choice if nothing is known
        """
        expected = self._expectation()
        avoided = [self._place_of(parameters) for parameters in failed]

        def value_of(places: np.ndarray) -> np.ndarray:
            values = expected(places)
            for place in avoided:
                values[((places - place) ** 2).sum(axis=1) < DISTINCT**2] = -np.inf
            return values

        best = _maximum(value_of, np.array([self._place_of(choice), *self._places[-MOST_EPISODES:]]))
        return tuple((self._low + best * self._widths).tolist())

    def best_of(self, candidates: Sequence[Parameters]) -> Parameters:
        """Choose those of some parameters of which the highest merit is expected.

        :param candidates: parameters to choose among, the first one among equals
        """
        expected = self._expectation()(np.array([self._place_of(candidate) for candidate in candidates]))
        return candidates[int(np.argmax(expected))]

    def _place_of(self, parameters: Parameters) -> np.ndarray:
        """Parameters as shares of their ranges."""
        place: np.ndarray = (np.array(parameters) - self._low) / self._widths
        return place

    def _expectation(self) -> Callable[[np.ndarray], np.ndarray]:
        """Merit that is expected of places, by the last episodes."""
        merits = corrected(np.array(self._merits), np.array(self._disturbances))
        return expectation(np.array(self._places[-MOST_EPISODES:]), merits[-MOST_EPISODES:])


def expectation(tried: np.ndarray, merits: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    """Mean of a Gaussian process (Rasmussen and Williams 2006, equation 2.25).

    Its prior mean is doubt: 0, or the lower quartile of merits that can be negative. So what nobody has tried is worth
    little.

    :param tried: parameters of the episodes as shares of their ranges, of shape (n, dimensions)
    :param merits: merits of the episodes, of shape (n,)
    :return: function that returns the expected merits, of shape (m,), of parameters of shape (m, dimensions)
    """
    if not len(merits):
        return lambda places: np.zeros(len(places))
    doubt = min(0.0, float(np.quantile(merits, 0.25)))
    covariances = _covariances(tried, tried) + NOISE * np.eye(len(tried))
    weights = np.linalg.solve(covariances, merits - doubt)

    def expected(places: np.ndarray) -> np.ndarray:
        merits: np.ndarray = doubt + _covariances(places, tried) @ weights
        return merits

    return expected


def _covariances(places: np.ndarray, others: np.ndarray) -> np.ndarray:
    # Distances by a matrix product: differences of all pairs would take several times as long.
    lengths, other_lengths = ((rows**2).sum(axis=1) for rows in (places, others))
    distances = lengths[:, None] + other_lengths - 2.0 * places @ others.T
    with np.errstate(under="ignore"):  # what is far away says nothing
        covariances: np.ndarray = np.exp(distances / (-2.0 * LENGTH**2))
    return covariances


def _maximum(value_of: Callable[[np.ndarray], np.ndarray], known: np.ndarray) -> np.ndarray:
    """Place in the box of the highest value: random draws, ever closer to the best places so far.

    :param value_of: function that returns the values of places, of shape (m,)
    :param known: places to begin at, of shape (n, dimensions); the first one among equals
    """
    generator = np.random.default_rng(0)  # the same draws each time, so that a choice depends on the episodes only
    places = np.vstack([known, generator.random((ANYWHERE, known.shape[1]))])
    values = value_of(places)
    for step in STEPS:
        best = np.argsort(-values, kind="stable")[:BEST_PLACES]
        draws = generator.normal(np.repeat(places[best], DRAWS, axis=0), step).clip(0.0, 1.0)
        places = np.vstack([places[best], draws])
        values = np.concatenate([values[best], value_of(draws)])
    place: np.ndarray = places[np.argmax(values)]
    return place


def is_valid(results: Sequence[EpisodeResult], baseline: Evaluation | None, must_step: bool = True) -> bool:
    """Whether parameters may be recommended: their gait is valid, and the hips do not chatter.

    :param results: results of their episodes, at least one
    :param baseline: evaluation that chatter is judged against; without one nothing chatters
    :param must_step: whether the task wants a gait; otherwise every gait is valid
    """
    evaluation = Evaluation(tuple(results))
    chatters = baseline is not None and evaluation.chatters(baseline)
    return (evaluation.is_gait or not must_step) and not chatters
