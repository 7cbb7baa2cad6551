"""Parameters as shares of their ranges, in which all of them are alike."""

from __future__ import annotations

import numpy as np

from sarah.operation.settings import PARAMETERS, Parameters

LOWS = np.array([parameter.low for parameter in PARAMETERS])
WIDTHS = np.array([parameter.width for parameter in PARAMETERS])


def to_shares(parameters: Parameters) -> np.ndarray:
    """Parameters as shares of their ranges.

    :param parameters: P1 to P5 and V1 to V4
    """
    shares: np.ndarray = (np.array(parameters) - LOWS) / WIDTHS
    return shares


def from_shares(shares: np.ndarray) -> Parameters:
    """Parameters of shares of their ranges, to six decimals; what lies outside comes to the nearer end.

    :param shares: one number for each parameter
    """
    return tuple(round(float(value), 6) for value in LOWS + WIDTHS * np.clip(shares, 0.0, 1.0))
