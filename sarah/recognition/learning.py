"""Learning from logs: places of the kinds, sets that are worth knowing, and what each is worth on each kind."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from sarah.control.parameters import Parameters
from sarah.errors import ConfigurationError
from sarah.operation.settings import BOX, SHIPPED
from sarah.recognition.belief import DEVIATION, LENGTH, NOISE
from sarah.recognition.felt import FEATURES, features_of
from sarah.recognition.logged import LoggedRobot
from sarah.recognition.recognition import MOST, Kind, Layer, Matrix, Numbers, Recognition

REPEATED = 3
"""Number of windows from which on a set counts as repeated."""
SAME = 1e-4
"""Largest difference of parameters that count as the same: tables may be rounded."""
ROWS_AROUND_BEST, ROWS_AROUND_REFERENCE = 10, 4
"""Number of rows of each kind that are kept: those that are nearest to its best set, and to the reference. They show
where rewards fall."""
FAR = 1.5
"""Distance beyond which a robot is unknown, over the largest one from a kind to its nearest neighbour."""
MOST_WINDOWS = 1000
"""Number of windows of each kind that its process knows: the last ones. Its time goes with their third power."""
LEAST_DEVIATION, LEAST_VARIANCE = 1e-2, 1e-4
"""Least standard deviation within a kind that features are scaled by, and least variance of scaled ones in any
direction: a log may have no noise."""
MOST_NAMED = 4
"""Number of kinds that a message names."""
UNITS = 16
"""Number of units in the hidden layer of a network."""


def learn(robots: Sequence[LoggedRobot], kind: Kind = "nearest", reference: Parameters = SHIPPED) -> Recognition:
    """Learn from logs.

    :param robots: robots of the logs; kinds that were never seen with the reference are left out
    :param kind: way of learning
    :param reference: parameters with which robots are recognised
    :raises ConfigurationError: if there are fewer than two kinds, if each was seen only once, if all feel the same, or
        if there are too many robots
    """
    if len(robots) > MOST:
        raise ConfigurationError(f"the logs have {len(robots)} robots, and at most {MOST} can be learned from")
    by_kind: dict[str, list[LoggedRobot]] = {}
    for robot in robots:
        by_kind.setdefault(robot.kind, []).append(robot)
    felt = {name: [one for robot in its if len(one := felt_with(robot, reference))] for name, its in by_kind.items()}
    kinds = {name: its for name, its in by_kind.items() if felt[name]}
    if len(kinds) < 2 or sum(map(len, (one for name in kinds for one in felt[name]))) < len(kinds) + 2:
        seen = ", ".join(f"{sum(map(len, its))} of {name}" for name, its in list(felt.items())[:MOST_NAMED])
        raise ConfigurationError(
            "the logs must have two kinds of robots, with several windows of the shipped parameters each, "
            f"and have {seen}{', …' if len(felt) > MOST_NAMED else ''}"
        )
    means = np.array([np.mean([one.mean(axis=0) for one in felt[name]], axis=0) for name in kinds])
    labels = np.concatenate([[index] * len(one) for index, name in enumerate(kinds) for one in felt[name]])
    features = np.concatenate([one for name in kinds for one in felt[name]])
    centre = means.mean(axis=0)
    whitening = _whitening(features - means[labels])
    places = (means - centre) @ whitening.T
    between = np.linalg.norm(places[:, None] - places[None], axis=2) + np.diag(np.full(len(kinds), np.inf))
    if not (far := FAR * between.min(axis=1).max()):
        raise ConfigurationError("all kinds of robots in the logs feel the same: nothing tells them apart")
    sets = list(dict.fromkeys([reference, *_candidates(kind, kinds, places, reference)]))
    rewards, deviations = _worth(sets, kinds)
    return Recognition(
        kind=kind,
        conditions=robots[0].conditions,
        reference=reference,
        centre=_plain(centre),
        whitening=_plain(whitening),
        far=_rounded(far),
        kinds=tuple(kinds),
        places=_plain(places),
        sets=tuple(sets),
        rewards=_plain(rewards),
        deviations=_plain(deviations),
        layers=_LAYERS[kind]((features - centre) @ whitening.T, labels) if kind in _LAYERS else (),
        rows=_rows_of_model(kinds, sets) if kind == "model" else _rows(kinds, reference),
    )


def _candidates(
    kind: Kind, kinds: Mapping[str, Sequence[LoggedRobot]], places: np.ndarray, reference: Parameters
) -> list[Parameters]:
    """Sets that may be pushed."""
    if kind == "naf":
        from sarah.recognition.naf import chosen_sets  # slow to import because of torch

        every = [(index, robot) for index, robots in enumerate(kinds.values()) for robot in robots]
        windows = [(index, one.parameters, one.reward) for index, robot in every for one in robot.windows]
        return chosen_sets(places, windows)
    return [one for robots in kinds.values() for one in _best_sets(robots, reference)]


def rewards_of(robots: Sequence[LoggedRobot]) -> dict[Parameters, list[float]]:
    """Rewards of each set that robots have tried.

    :param robots: robots of the logs
    """
    rewards: dict[Parameters, list[float]] = {}
    for robot in robots:
        for window in robot.windows:
            rewards.setdefault(window.parameters, []).append(window.reward)
    return rewards


def best_set(robot: LoggedRobot, reference: Parameters = SHIPPED) -> Parameters:
    """The set of a robot whose repeated rewards, less a standard deviation, are highest; of all sets, if none but the
    reference is repeated.

    :param robot: robot of the logs
    :param reference: parameters with which robots are recognised
    """
    rewards = rewards_of([robot])
    least = REPEATED if _repeats(robot, reference) else 1
    among = [one for one, values in rewards.items() if len(values) >= least]
    return max(among, key=lambda one: float(np.mean(rewards[one]) - np.std(rewards[one])))


def _repeats(robot: LoggedRobot, reference: Parameters) -> bool:
    """Whether a robot has repeated a set other than the reference."""
    repeated = (one for one, values in rewards_of([robot]).items() if len(values) >= REPEATED)
    return not all(is_same(one, reference) for one in repeated)


def _best_sets(robots: Sequence[LoggedRobot], reference: Parameters) -> list[Parameters]:
    """Best sets of the robots of a kind: of those that have repeated any, if there are such robots."""
    sure = [robot for robot in robots if _repeats(robot, reference)]
    return [best_set(robot, reference) for robot in sure or robots]


def is_same(parameters: Parameters, others: Parameters) -> bool:
    """Whether two sets are the same but for rounding.

    :param parameters: P1 to P5 and V1 to V4
    :param others: those of the other set
    """
    return np.allclose(parameters, others, rtol=0.0, atol=SAME)


def best_of_all(recognition: Recognition) -> Parameters:
    """The set that is best on the mean of all kinds.

    :param recognition: what logs teach
    """
    return recognition.sets[int(np.argmax(np.mean(recognition.rewards, axis=1)))]


def felt_with(robot: LoggedRobot, reference: Parameters) -> np.ndarray:
    """Features of a robot's windows with the reference, a row each; of those with a fall only if there are no others.

    :param robot: robot of the logs
    :param reference: parameters
    """
    its = [window for window in robot.windows if is_same(window.parameters, reference)]
    its = [window for window in its if not window.fell] or its
    return np.array([features_of(window.felt, robot.scale) for window in its]).reshape(-1, len(FEATURES))


def _rows(kinds: Mapping[str, Sequence[LoggedRobot]], reference: Parameters) -> Matrix:
    """Rows of each kind around its best set and around the reference."""
    rows: list[Numbers] = []
    for index, robots in enumerate(kinds.values()):
        rewards = rewards_of(robots)
        tried = list(rewards)
        places = np.array([BOX.shares(one) for one in tried])
        best = max(_best_sets(robots, reference), key=lambda one: float(np.mean(rewards[one])))
        for centre, count in ((best, ROWS_AROUND_BEST), (reference, ROWS_AROUND_REFERENCE)):
            order = np.argsort(np.linalg.norm(places - BOX.shares(centre), axis=1), kind="stable")
            rows += [_row(index, tried[i], rewards[tried[i]]) for i in order[:count]]
    return tuple(dict.fromkeys(rows))


def _rows_of_model(kinds: Mapping[str, Sequence[LoggedRobot]], sets: Sequence[Parameters]) -> Matrix:
    """Rows of each kind with the known sets, and as many others as there is room for, spread evenly."""
    every = [
        (one in sets, _row(index, one, rewards))
        for index, robots in enumerate(kinds.values())
        for one, rewards in rewards_of(robots).items()
    ]
    known = [row for is_known, row in every if is_known][:MOST]
    others = [row for is_known, row in every if not is_known]
    room = min(MOST - len(known), len(others))
    return (*known, *(others[i * len(others) // room] for i in range(room)))


def _row(index: int, parameters: Parameters, rewards: Sequence[float]) -> Numbers:
    return (float(index), *_plain(np.array(parameters)), _rounded(float(np.mean(rewards))))


def _whitening(residuals: np.ndarray) -> np.ndarray:
    """Matrix that makes the variation within a kind the same in all directions, by a shrunk covariance."""
    from sklearn.covariance import LedoitWolf

    deviations = np.maximum(residuals.std(axis=0), LEAST_DEVIATION)
    covariance = LedoitWolf(assume_centered=True).fit(residuals / deviations).covariance_
    values, vectors = np.linalg.eigh(covariance)
    whitening: np.ndarray = (vectors / np.sqrt(np.maximum(values, LEAST_VARIANCE))).T / deviations
    return whitening


def _worth(sets: Sequence[Parameters], kinds: Mapping[str, Sequence[LoggedRobot]]) -> tuple[np.ndarray, np.ndarray]:
    """Expected reward of each set on each kind, and its standard deviation, by a Gaussian process of each kind."""
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel

    kernel = ConstantKernel(DEVIATION**2) * Matern(LENGTH, nu=2.5) + WhiteKernel(NOISE**2)
    places = np.array([BOX.shares(one) for one in sets])
    rewards, deviations = [], []
    for robots in kinds.values():
        windows = [window for robot in robots for window in robot.windows][-MOST_WINDOWS:]
        seen = np.array([window.reward for window in windows])
        process = GaussianProcessRegressor(kernel, optimizer=None)
        process.fit(np.array([BOX.shares(window.parameters) for window in windows]), seen - seen.mean())
        expected, deviation = process.predict(places, return_std=True)
        rewards.append(expected + seen.mean())
        deviations.append(np.sqrt(np.maximum(deviation**2 - NOISE**2, 0.0)))
    return np.array(rewards).T, np.array(deviations).T


def _linear(places: np.ndarray, labels: np.ndarray) -> tuple[Layer, ...]:
    """Linear discriminant with a shrunk covariance."""
    from sklearn.discriminant_analysis import LinearDiscriminantAnalysis

    found = LinearDiscriminantAnalysis(solver="lsqr", shrinkage="auto").fit(places, labels)
    weights, biases = found.coef_, found.intercept_
    if len(weights) == 1:  # of two kinds, it has the weights of the second one
        weights, biases = np.concatenate([-weights, weights]) / 2.0, np.concatenate([-biases, biases]) / 2.0
    return (Layer(_plain(weights), _plain(biases)),)


def _network(places: np.ndarray, labels: np.ndarray) -> tuple[Layer, ...]:
    """Network with one hidden layer."""
    from sklearn.neural_network import MLPClassifier

    size = max(float(np.abs(places).max()), 1.0)
    found = MLPClassifier((UNITS,), "tanh", solver="lbfgs", alpha=0.1, max_iter=5000, random_state=0)
    found.fit(places / size, labels)
    weights, biases = [found.coefs_[0].T / size, *(one.T for one in found.coefs_[1:])], list(found.intercepts_)
    if len(biases[-1]) == 1:  # of two kinds, it has one output
        weights[-1] = np.concatenate([-weights[-1], weights[-1]]) / 2.0
        biases[-1] = np.concatenate([-biases[-1], biases[-1]]) / 2.0
    return tuple(Layer(_plain(one), _plain(bias)) for one, bias in zip(weights, biases, strict=True))


_LAYERS: dict[str, Callable[[np.ndarray, np.ndarray], tuple[Layer, ...]]] = {"classes": _linear, "network": _network}


def _plain(values: np.ndarray) -> tuple[Any, ...]:
    """Nested tuples of numbers with four significant digits."""
    return tuple(_rounded(value) if np.ndim(value) == 0 else _plain(value) for value in values)


def _rounded(value: float) -> float:
    """A number with four significant digits."""
    return float(f"{value:.4g}")
