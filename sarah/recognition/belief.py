"""What is believed of the known sets on a robot that has been felt."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from sarah.control.parameters import Parameters
from sarah.operation.settings import BOX
from sarah.recognition.recognition import Recognition

SPREAD = 2.0
"""Standard deviation of the place of a robot from that of another one of its kind, in each coordinate: masses and
sensors' errors are drawn anew."""
NOISE = 0.07
"""Standard deviation of a window's reward, and of what robots of a kind differ by."""
LENGTH, DEVIATION = 0.3, 0.3
"""Length over which a robot's reward changes, as a share of each range, and its standard deviation between far
parameters."""
LEAST = -4.0
"""Least logarithm of the likelihood of a set's rewards: a robot is of no kind exactly."""
LEAST_DEVIATION = 0.02
"""Least standard deviation of a belief."""

Observed = Mapping[Parameters, Sequence[float]]
"""Rewards that were observed of sets."""


class Belief(NamedTuple):
    """What is believed of a set.

    :param parameters: P1 to P5 and V1 to V4
    :param reward: expected observed reward
    :param deviation: standard deviation of it
    """

    parameters: Parameters
    reward: float
    deviation: float


def place_of(recognition: Recognition, features: np.ndarray) -> np.ndarray:
    """Place of what was felt with the reference.

    :param recognition: what logs teach
    :param features: features of a window, or their means over some
    """
    whitening = np.array(recognition.whitening).reshape(-1, len(features))
    place: np.ndarray = whitening @ (features - np.array(recognition.centre))
    return place


def distances(recognition: Recognition, place: np.ndarray) -> np.ndarray:
    """Distance of a place from that of each known kind.

    :param recognition: what logs teach
    :param place: place of a robot
    """
    found: np.ndarray = np.linalg.norm(np.array(recognition.places) - place, axis=1)
    return found


def is_known(recognition: Recognition, place: np.ndarray) -> bool:
    """Whether a robot is near to a kind that is known.

    :param recognition: what logs teach
    :param place: place of the robot
    """
    return bool(recognition.kinds) and float(distances(recognition, place).min()) <= recognition.far


def shares_of(recognition: Recognition, place: np.ndarray, observed: Observed) -> np.ndarray:
    """Probability that a robot is of each of the known kinds.

    :param recognition: what logs teach
    :param place: place of the robot
    :param observed: rewards that were observed of sets
    """
    if recognition.kind == "best":
        logits = np.zeros(len(recognition.kinds))
    elif recognition.layers:
        logits = network(recognition, place)
    else:
        logits = -0.5 * np.square(distances(recognition, place) / SPREAD)
    for parameters, rewards, deviations in zip(
        recognition.sets, np.array(recognition.rewards), np.array(recognition.deviations), strict=True
    ):
        if parameters in observed:
            variance = deviations**2 + NOISE**2
            errors = np.square(np.mean(observed[parameters]) - rewards) / variance
            logits = logits + np.maximum(-0.5 * (errors + np.log(variance / NOISE**2)), LEAST)
    shares: np.ndarray = np.exp(logits - logits.max())
    return shares / shares.sum()


def network(recognition: Recognition, inputs: np.ndarray) -> np.ndarray:
    """Outputs of the network.

    :param recognition: what logs teach
    :param inputs: inputs of its first layer
    """
    for index, layer in enumerate(recognition.layers):
        inputs = np.tanh(inputs) if index else inputs
        inputs = np.array(layer.weights) @ inputs + np.array(layer.biases)
    return inputs


def believed(recognition: Recognition, place: np.ndarray, observed: Observed) -> list[Belief]:
    """What is believed of each known set.

    :param recognition: what logs teach
    :param place: place of the robot
    :param observed: rewards that were observed of sets
    """
    if recognition.kind == "model":
        return _modelled(recognition, place, observed)
    shares, rewards = shares_of(recognition, place, observed), np.array(recognition.rewards)
    means = rewards @ shares
    variances = (np.square(recognition.deviations) + np.square(rewards - means[:, None])) @ shares + LEAST_DEVIATION**2
    beliefs = []
    for parameters, mean, variance in zip(recognition.sets, means, variances, strict=True):
        seen = observed.get(parameters, ())
        weights = np.array([1.0 / variance, *[1.0 / NOISE**2] * len(seen)])
        reward = float(np.average([mean, *seen], weights=weights))
        beliefs.append(Belief(parameters, reward, float(1.0 / np.sqrt(weights.sum()))))
    return beliefs


def rows_of_kind(recognition: Recognition, place: np.ndarray, observed: Observed) -> list[tuple[Parameters, float]]:
    """Parameters and rewards of the best sets that robots of the most probable kind have tried.

    :param recognition: what logs teach
    :param place: place of the robot
    :param observed: rewards that were observed of sets
    """
    if recognition.kind == "best":  # all kinds are alike
        return []
    index = int(np.argmax(shares_of(recognition, place, observed)))
    return [(row[1:-1], row[-1]) for row in recognition.rows if row[0] == index]


def _modelled(recognition: Recognition, place: np.ndarray, observed: Observed) -> list[Belief]:
    """What a Gaussian process of places and parameters expects of each known set."""
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel

    def inputs(where: np.ndarray, parameters: Parameters) -> np.ndarray:
        return np.concatenate([where / recognition.far, np.array(BOX.shares(parameters)) / LENGTH])

    places = np.array(recognition.places)
    seen = [(inputs(places[int(row[0])], row[1:-1]), row[-1]) for row in recognition.rows]
    seen += [(inputs(place, parameters), reward) for parameters, its in observed.items() for reward in its]
    rewards = np.array([reward for _, reward in seen])
    kernel = ConstantKernel(DEVIATION**2) * Matern(1.0, nu=2.5) + WhiteKernel(NOISE**2)
    process = GaussianProcessRegressor(kernel, optimizer=None)
    process.fit(np.array([one for one, _ in seen]), rewards - rewards.mean())
    means, deviations = process.predict(np.array([inputs(place, one) for one in recognition.sets]), return_std=True)
    deviations = np.sqrt(np.maximum(deviations**2 - NOISE**2, LEAST_DEVIATION**2))
    found = zip(recognition.sets, means + rewards.mean(), deviations, strict=True)
    return [Belief(parameters, float(mean), float(deviation)) for parameters, mean, deviation in found]
