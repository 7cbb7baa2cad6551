"""Means of independent values with their intervals, and ratios of paired ones with their errors."""

from __future__ import annotations

import math
from collections.abc import Sequence
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


def ratio(name: str, values: np.ndarray, others: np.ndarray) -> Row:
    """Columns of the ratio of two means and of its standard error, which is small where values go with the others.

    :param name: name of the column
    :param values: values of the numerator, of shape (sets, episodes)
    :param others: values of the denominator in the same episodes
    """
    found = float(values.mean() / others.mean())
    return {name: found, f"{name}_error": standard_error(values - found * others) / float(others.mean())}
