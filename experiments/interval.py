"""Means of independent values and ratios of paired ones, with their intervals and errors."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from statistics import mean, stdev

import numpy as np
from scipy.stats import t as student

from experiments.record import Row
from sarah.reports.uncertainty import standard_error


def interval(values: Sequence[float]) -> tuple[float, float]:
    """Student's 95 % interval of a mean.

    :param values: independent values; of a single one nothing is known
    """
    if len(values) < 2:
        return -math.inf, math.inf
    half = float(student.ppf(0.975, len(values) - 1)) * stdev(values) / math.sqrt(len(values))
    return mean(values) - half, mean(values) + half


def with_interval(name: str, values: Sequence[float]) -> Row:
    """Columns of a mean and of the ends of its interval.

    :param name: name of the column
    :param values: independent values
    """
    low, high = interval(values)
    return {name: mean(values), f"{name}_low": low, f"{name}_high": high}


def with_error(name: str, values: np.ndarray) -> Row:
    """Columns of a mean and of its standard error.

    :param name: name of the column
    :param values: independent values; of a single one nothing is known
    """
    return {name: float(values.mean()), f"{name}_error": standard_error(values[np.newaxis])}


def ratio(name: str, values: np.ndarray, others: np.ndarray) -> Row:
    """Columns of the ratio of two means and of its standard error, which is small where values go with the others.

    :param name: name of the column
    :param values: values of the numerator
    :param others: values of the denominator, in the same episodes
    """
    found = float(values.mean() / others.mean())
    return {name: found, f"{name}_error": standard_error((values - found * others)[np.newaxis]) / float(others.mean())}


def crossed_bootstrap(
    statistic: Callable[[np.ndarray, np.ndarray], float], sets: int, episodes: int, draws: int = 2000
) -> tuple[float, float]:
    """95 % interval of a statistic of several sets that met the same episodes; both are resampled.

    :param statistic: function of the indices of the sets and of the episodes
    :param sets: number of sets
    :param episodes: number of episodes
    :param draws: number of times that sets and episodes are drawn, with replacement
    """
    generator = np.random.default_rng(0)
    found = [
        statistic(generator.integers(sets, size=sets), generator.integers(episodes, size=episodes))
        for _ in range(draws)
    ]
    low, high = np.quantile(found, (0.025, 0.975))
    return float(low), float(high)
