"""What of a window tells which robot it is of."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sarah.operation.window import FELT, FELT_SIZES
from sarah.robot.reading import GRAVITY
from sarah.robot.scale import MASS, Scale

LOADS = ("left_load", "right_load")
TELLING = tuple(name for name in FELT if not name.endswith("_mean") and name not in LOADS)
"""Names of what tells, beside the sum of the loads over the weight: deviations, durations of phases, lags, and steps
per second. Means of inertial signals and differences of left and right are the draw of the sensors' errors."""
FEATURES = (*TELLING, "load_over_weight")
"""Names of the features, in order."""
LOWEST, HIGHEST = 1e-3, 1e3
"""Ends to which values of order 1 are clipped before their logarithm is taken."""
_TELLING = [FELT.index(name) for name in TELLING]
_LOADS = [FELT.index(name) for name in LOADS]


def features_of(felt: Sequence[float], scale: Scale) -> np.ndarray:
    """Features of a window: logarithms, because what varies from window to window goes with the value.

    :param felt: what the robot felt, in the order of :data:`~sarah.operation.window.FELT`, in SI units
    :param scale: size of the robot without a payload, whose weight the loads are compared with
    :return: float64 array in the order of :data:`FEATURES`
    """
    values = np.array(felt, dtype=float)
    sizes = np.array(scale.all_scaled(FELT_SIZES))
    load = values[_LOADS].sum() / (MASS * scale.mass * GRAVITY)
    features: np.ndarray = np.log(np.clip(np.append((values / sizes)[_TELLING], load), LOWEST, HIGHEST))
    return features
