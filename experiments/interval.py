"""Means of independent values, with their intervals."""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import mean, stdev

from scipy.stats import t as student

from experiments.record import Row


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
