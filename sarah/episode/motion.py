"""How smooth an episode's motion is, and what it asks of the actuators.

Reward and survival cannot see a controller that chatters: one that shakes the robot at frequencies that no real
actuator follows. The torso's acceleration above 20 Hz does.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from sarah.robot.description import ACTUATED_JOINTS
from sarah.robot.reading import Vector

CHATTER_HZ = 20.0
"""Above the gait's own harmonics, below half the control rate."""
SEGMENT_SECONDS = 0.5
"""Length of the segments that spectra are averaged over."""
IS_HIP = np.array([not name.endswith("leg_length") for name in ACTUATED_JOINTS])
"""Which actuators turn; the others are the prismatic legs."""


class MotionRecord:
    """Follows one episode's torso acceleration and actuators.

    :param control_rate: ticks per second
    """

    def __init__(self, control_rate: int) -> None:
        self._control_rate = control_rate
        self._accelerations: list[Vector] = []
        self._speeds: list[Sequence[float]] = []
        self._efforts: list[Sequence[float]] = []

    def tick(self, acceleration: Vector, speeds: Sequence[float], efforts: Sequence[float]) -> None:
        """Note one control tick.

        :param acceleration: the torso's true specific force, in m/s^2
        :param speeds: of the actuators in the order of ``ACTUATED_JOINTS``, in rad/s and m/s
        :param efforts: torques and forces of the same, in Nm and N
        """
        self._accelerations.append(acceleration)
        self._speeds.append(speeds)
        self._efforts.append(efforts)

    @property
    def actuator_power(self) -> float:
        """Mean over the ticks of the six actuators' mechanical power, braking counted like driving, in W."""
        if not self._speeds:
            return 0.0
        return float(np.abs(np.array(self._speeds) * np.array(self._efforts)).sum(axis=1).mean())

    @property
    def peak_hip_rate(self) -> float:
        """Fastest motion of a hip joint, in rad/s."""
        return self._peak_speed(IS_HIP)

    @property
    def peak_leg_speed(self) -> float:
        """Fastest change of a leg's length, in m/s."""
        return self._peak_speed(~IS_HIP)

    def _peak_speed(self, which: np.ndarray) -> float:
        return float(np.abs(np.array(self._speeds)[:, which]).max()) if self._speeds else 0.0

    @property
    def vibration(self) -> float:
        """Mean square of the torso's acceleration above 20 Hz, all axes together, in m^2/s^4; 0 at first."""
        return power_above(np.array(self._accelerations), self._control_rate, CHATTER_HZ)

    def metrics(self) -> dict[str, Any]:
        """The metrics of :class:`~sarah.episode.result.EpisodeResult` that follow from motion."""
        return {
            "vibration": self.vibration,
            "actuator_power": self.actuator_power,
            "peak_hip_rate": self.peak_hip_rate,
            "peak_leg_speed": self.peak_leg_speed,
        }


def power_above(signals: np.ndarray, rate: int, hertz: float) -> float:
    """Mean square of what signals hold above a frequency, summed over the signals.

    By Welch's method (1967): the mean over half-overlapping segments of half a second, so that a short burst counts
    alike whenever it comes.

    :param signals: of shape (time, signals)
    :param rate: samples per second
    :param hertz: the frequency
    :return: in the signals' unit squared; 0 for less than one segment
    """
    length = round(SEGMENT_SECONDS * rate)
    if len(signals) < length:
        return 0.0
    segments = np.lib.stride_tricks.sliding_window_view(signals, length, axis=0)[:: length // 2]
    window = np.hanning(length)  # so that slow motion does not leak into high frequencies
    centred = segments - segments.mean(axis=-1, keepdims=True)
    spectra = 2.0 * np.abs(np.fft.rfft(centred * window, axis=-1)) ** 2 / (length * (window**2).sum())
    if length % 2 == 0:
        spectra[..., -1] /= 2.0  # half the rate has no negative twin
    above = np.fft.rfftfreq(length, 1.0 / rate) > hertz
    return float(spectra[..., above].sum(axis=(1, 2)).mean())
