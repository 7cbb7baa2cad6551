"""A window of an operation: what it was worth, and what the robot felt."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sarah.operation.settings import Parameters
from sarah.robot.reading import GRAVITY
from sarah.robot.scale import Scale

FELT = (
    *(f"{signal}_{what}" for what in ("mean", "deviation") for signal in ("a_x", "a_y", "a_z", "w_x", "w_y", "w_z")),
    *(f"{phase}_seconds" for phase in ("shift", "lift", "land")),
    *(f"{joint}_lag" for joint in ("abduction", "flexion", "length")),
    "left_load",
    "right_load",
    "steps_per_second",
)
"""Names of what the robot felt in a window, in order: means and deviations of the six inertial signals, mean durations
of the phases, mean distances of the joints from their targets, mean loads of the feet, and steps per second."""
_INERTIAL = (*((GRAVITY, "m/s^2"),) * 3, *((1.0, "rad/s"),) * 3)
_LAGS = ((0.1, "rad"), (0.1, "rad"), (0.01, "m"))
FELT_SIZES = (*_INERTIAL, *_INERTIAL, *((0.5, "s"),) * 3, *_LAGS, *((150.0, "N"),) * 2, (3.0, "1/s"))
"""Value of each that makes it of order 1, and its unit. It goes with the robot's size."""
LARGEST = 5.0
"""Bound to which a scaled value is clipped."""


@dataclass(frozen=True)
class Window:
    """A window of an operation.

    :param index: number of the window, from 0
    :param begin: time of operation at which it began, in s
    :param seconds: time that it took, in s, with standing before it and setting upright after it
    :param changes: number of changes that had been made to robot and world
    :param parameters: P1 to P5 and V1 to V4
    :param score: equation 2 over its ceiling, by the torso's true motion since the measurement began; 1 is the best.
        ``None`` where nobody knows that motion, as of a real robot
    :param observed_reward: the same, as far as the robot's own sensors tell
    :param fell: whether the robot fell, which ended the window
    :param felt: what the robot felt, in the order of :data:`FELT`
    """

    index: int
    begin: float
    seconds: float
    changes: int
    parameters: Parameters
    score: float | None
    observed_reward: float
    fell: bool
    felt: tuple[float, ...]

    @property
    def worth(self) -> float:
        """Score; where nobody knows it, the observed reward."""
        return self.observed_reward if self.score is None else self.score

    @property
    def end(self) -> float:
        """Time of operation at which the next one begins, in s."""
        return round(self.begin + self.seconds, 9)

    def plain(self) -> dict[str, Any]:
        """Values by name, for JSON."""
        return dataclasses.asdict(self)

    @classmethod
    def of_plain(cls, plain: dict[str, Any]) -> Window:
        """Make a window of its values.

        :param plain: values by name, as JSON gives them
        :raises TypeError: if they are not those of a window
        """
        window = cls(**plain)
        return dataclasses.replace(window, parameters=tuple(window.parameters), felt=tuple(window.felt))


def observation_from(felt: Sequence[float], scale: Scale) -> np.ndarray:
    """Scale what a robot felt to an observation.

    :param felt: values in the order of :data:`FELT`, in SI units
    :param scale: size of the robot
    :return: float32 array of the same length, of order 1, clipped to [-5, 5]
    """
    scaled = np.array(felt) / scale.all_scaled(FELT_SIZES)
    return np.clip(np.where(np.isfinite(scaled), scaled, 0.0), -LARGEST, LARGEST).astype(np.float32)
