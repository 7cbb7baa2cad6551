"""Few seeds compared: interquartile means and chances of improvement, with intervals (Agarwal et al. 2021)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike
from scipy.stats import trim_mean

DRAWS = 2_000
"""Number of times that a bootstrap draws the seeds again."""
ENDS = (2.5, 97.5)
"""Percentiles that are the ends of a 95 % interval."""


def interquartile_mean(values: ArrayLike) -> tuple[float, float, float]:
    """Mean without the lowest and the highest quarter, and the ends of its 95 % interval.

    :param values: a number of each seed
    """
    drawn = _drawn(values, np.random.default_rng(0))
    low, high = np.percentile(trim_mean(drawn, 0.25, axis=1), ENDS)
    return float(trim_mean(values, 0.25)), float(low), float(high)


def improvement(ones: Sequence[ArrayLike], others: Sequence[ArrayLike]) -> tuple[float, float, float]:
    """Probability that a seed of one algorithm is above a seed of another, and the ends of its 95 % interval.

    It is a mean over tasks, in which a tie counts half. The bootstrap is stratified: it draws the seeds of each task
    and algorithm anew.

    :param ones: numbers of the seeds, task by task
    :param others: numbers of the other algorithm's seeds on the same tasks
    """
    generator = np.random.default_rng(0)
    pairs = list(zip(ones, others, strict=True))
    shares = [_share_above(np.array([one]), np.array([other])) for one, other in pairs]
    drawn = [_share_above(_drawn(one, generator), _drawn(other, generator)) for one, other in pairs]
    low, high = np.percentile(np.mean(drawn, axis=0), ENDS)
    return float(np.mean(shares)), float(low), float(high)


def _drawn(values: ArrayLike, generator: np.random.Generator) -> np.ndarray:
    """As many values, drawn with replacement: one row a draw."""
    every = np.asarray(values, dtype=float)
    return generator.choice(every, (DRAWS, len(every)))


def _share_above(ones: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Share of the pairs in each row of which the first is above the second."""
    differences = ones[:, :, None] - others[:, None, :]
    return (0.5 * (1 + np.sign(differences))).mean(axis=(1, 2))
