"""The smoothness of an episode's motion, and the load on the actuators.

A controller chatters if it shakes the robot at frequencies that no real actuator follows. Reward and survival do not
show that, but the torso's acceleration from 20 to 50 Hz does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sarah.episode.metric import metric
from sarah.episode.running_robot import Observer, RunningRobot
from sarah.robot.reading import ACTUATED_JOINTS, Vector

CHATTER_BAND = (20.0, 50.0)
"""Frequencies between which motion of the default robot counts as vibration, in Hz: above the gait's harmonics, and the
same at all control rates from 100 Hz on."""
HIGHEST_SLOWEST = 0.8
"""Highest share of the largest frequency that is recorded at which the band of a small robot begins."""
SEGMENT_SECONDS = 0.5
"""Length of the segments that spectra are averaged over, in s."""
IS_HIP = np.array([not name.endswith("leg_length") for name in ACTUATED_JOINTS])
"""Mask of the actuators that turn; the others are the prismatic legs."""


@dataclass(frozen=True)
class MotionMetrics:
    """How a robot's torso and actuators move."""

    vibration: float = metric(
        "vibration",
        "m²/s⁴",
        "mean square of the torso's acceleration from 20 to 50 Hz: chatter",
        "median",
        group="robot",
        shown=(1.0, 1, "m²/s⁴"),
    )
    actuator_power: float = metric(
        "actuator power", "W", "mean mechanical power of all six actuators", "mean", group="robot", shown=(1.0, 0, "W")
    )
    peak_hip_rate: float = metric("peak hip rate", "rad/s", "fastest hip motion", "max", shown=(1.0, 1, "rad/s"))
    peak_leg_speed: float = metric(
        "peak leg speed", "m/s", "fastest change of a leg's length", "max", shown=(1.0, 2, "m/s")
    )


class MotionRecord(Observer):
    """Record of one episode's torso acceleration and actuators.

    :param control_rate: control ticks per second
    :param time_scale: ratio of the robot's times to those of the default robot; a small one steps at higher frequencies
    """

    def __init__(self, control_rate: int, time_scale: float = 1.0) -> None:
        self._control_rate = control_rate
        slowest, quickest = CHATTER_BAND
        self._band = (min(slowest / time_scale, HIGHEST_SLOWEST * min(quickest, control_rate / 2)), quickest)
        self._accelerations: list[Vector] = []
        self._speeds: list[Sequence[float]] = []
        self._efforts: list[Sequence[float]] = []

    def sensed(self, robot: RunningRobot) -> None:
        """Record the torso's true specific force, and speeds and efforts of the actuators."""
        speeds, efforts = robot.simulation.actuator_motion()
        self._accelerations.append(robot.truth.acceleration)
        self._speeds.append(speeds)
        self._efforts.append(efforts)

    def metrics(self) -> MotionMetrics:
        """Metrics of the motion so far."""
        if not self._speeds:
            return MotionMetrics(0.0, 0.0, 0.0, 0.0)
        speeds, efforts = np.array(self._speeds), np.array(self._efforts)
        return MotionMetrics(
            vibration=power_within(np.array(self._accelerations), self._control_rate, self._band),
            actuator_power=float(np.abs(speeds * efforts).sum(axis=1).mean()),  # braking counts too
            peak_hip_rate=float(np.abs(speeds[:, IS_HIP]).max()),
            peak_leg_speed=float(np.abs(speeds[:, ~IS_HIP]).max()),
        )


def power_within(signals: np.ndarray, rate: int, band: tuple[float, float]) -> float:
    """Mean square of the components of signals within a band of frequencies, summed over the signals.

    It is estimated by Welch's method (1967): the mean over half-overlapping segments of half a second. So a short burst
    counts alike whenever it occurs.

    :param signals: samples of the signals, of shape (time, signals)
    :param rate: samples per second
    :param band: frequencies above which and up to which components count, in Hz
    :return: in the signals' unit squared; 0 for less than one segment
    """
    length = round(SEGMENT_SECONDS * rate)
    if len(signals) < length:
        return 0.0
    segments = np.lib.stride_tricks.sliding_window_view(signals, length, axis=0)[:: length // 2]
    window = np.hanning(length)  # keeps slow motion from leaking into high frequencies
    centred = segments - segments.mean(axis=-1, keepdims=True)
    spectra = 2.0 * np.abs(np.fft.rfft(centred * window, axis=-1)) ** 2 / (length * (window**2).sum())
    if length % 2 == 0:
        spectra[..., -1] /= 2.0  # half the sampling rate has no negative twin
    frequencies = np.fft.rfftfreq(length, 1.0 / rate)
    within = (frequencies > band[0]) & (frequencies <= band[1])
    return float(spectra[..., within].sum(axis=(1, 2)).mean())
