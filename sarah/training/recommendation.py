"""The recommendation of a training: the parameters with the highest expected merit, by its newest 500 episodes.

An agent's own choice tends to stop at the edge of a plateau, and the best single episode is often luck. And the reward
does not show a robot that steps to a clock or drags its feet, so an episode without a valid gait has less merit here
than its score. For all algorithms, therefore, parameters are judged by the merit that a Gaussian process expects,
without the part that known disturbances explain. Its maximum is looked for in the whole box of the parameters. The last
episodes of a budget try it, and then the best of what was simulated elsewhere: where the process errs, one of the two
is good. Their gait must be valid, and their hips must not chatter.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sarah.agents.corrections import corrected
from sarah.agents.gaussian_process import GaussianProcess
from sarah.control.parameters import Parameters
from sarah.episode.evaluation import SMALLEST_SENSOR_SHARE
from sarah.episode.gait import LEAST_CLEARANCE
from sarah.episode.result import EpisodeResult
from sarah.episode.task_answers import check_as_many
from sarah.episode.tasks import Task

DISTINCT = 0.2
"""Distance within which parameters count as those of an earlier trial, scaled to [-1, 1]."""
LARGEST_MERIT = 1e100
"""Largest merit by amount: larger ones, of a reward of your own, would overflow."""


def merit(result: EpisodeResult, must_step: bool = True, least_clearance: float = LEAST_CLEARANCE) -> float:
    """Merit of an episode: its score, reduced in proportion to what its gait lacks to be valid.

    :param result: result of the episode
    :param must_step: whether the task wants a gait; otherwise the merit is the score
    :param least_clearance: sole clearance of a valid gait, in m
    """
    merit = result.score
    if not must_step:
        return merit
    for share in (
        result.sole_clearance / least_clearance if least_clearance else 1.0,
        result.shifts_by_sensors / SMALLEST_SENSOR_SHARE,
        result.lifts_by_sensors / SMALLEST_SENSOR_SHARE,
    ):
        share = min(1.0, share)
        merit *= share if merit > 0.0 else 2.0 - share  # a reward of your own can be negative
    return merit


class Tried:
    """Episodes so far, and the merit that a Gaussian process expects of any parameters.

    :param task: task that owns the parameters
    """

    def __init__(self, task: Task) -> None:
        self._task = task
        self._box = task.box
        self._places: list[Parameters] = []
        self._merits: list[float] = []
        self._disturbances: list[Sequence[float]] = []
        self._parameters: list[Parameters] = []

    def __len__(self) -> int:
        """Number of episodes."""
        return len(self._merits)

    def append(self, parameters: Parameters, merit: float, disturbances: Sequence[float] | None = None) -> None:
        """Add an episode.

        :param parameters: parameters of the episode
        :param merit: merit of the episode; one that is no number is as bad as can be
        :param disturbances: disturbances of the episode, as many as those of all others
        :raises TaskError: if they are more or fewer
        """
        numbers = () if disturbances is None else disturbances
        check_as_many(self._task, numbers, self._disturbances)
        self._parameters.append(parameters)
        self._places.append(self._box.scaled(parameters))
        self._merits.append(min(LARGEST_MERIT, max(-LARGEST_MERIT, merit)))
        self._disturbances.append(numbers)

    def best(self, choice: Parameters) -> Parameters:
        """Find the parameters of which the highest merit is expected.

        :param choice: parameters to begin the search at, beside those of the episodes
        :return: the best parameters; the choice if nothing is known
        """
        return self._box.unscaled(self._expectation().best(np.array([self._box.scaled(choice)])))

    def best_simulated(self, trials: Sequence[Parameters]) -> Parameters:
        """Find the parameters of which the highest merit is expected among those of the episodes.

        :param trials: parameters of earlier trials, whose surroundings are avoided: a trial of the same parameters
            would repeat the same episodes
        """
        expected = self._expectation().expected(np.array(self._places))
        for parameters in trials:
            distances = np.linalg.norm(np.array(self._places) - self._box.scaled(parameters), axis=1)
            expected[distances < DISTINCT] = -np.inf
        return self._parameters[int(np.argmax(expected))]

    def best_of(self, candidates: Sequence[Parameters]) -> Parameters:
        """Choose those of some parameters of which the highest merit is expected.

        :param candidates: parameters to choose among, the first one among equals
        """
        expected = self._expectation().expected(np.array([self._box.scaled(candidate) for candidate in candidates]))
        return candidates[int(np.argmax(expected))]

    def _expectation(self) -> GaussianProcess:
        places = np.array(self._places).reshape(len(self), len(self._box.parameters))
        merits = corrected(np.array(self._merits), places, np.array(self._disturbances))
        return GaussianProcess(places, merits, length_scales=self._box.length_scales)
