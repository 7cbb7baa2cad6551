"""How smooth an episode's motion is, and what it asks of the actuators.

Reward and survival cannot see a controller that chatters: one that shakes the robot at frequencies that no real
actuator follows. The torso's acceleration above 20 Hz does.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sarah.description import ACTUATED_JOINTS
from sarah.sensors import Vector

CHATTER_HZ = 20.0
"""Above the gait's own harmonics, below half the control rate."""
SHORTEST_SPECTRUM_SECONDS = 0.5
LEGS = tuple(name.endswith("leg_length") for name in ACTUATED_JOINTS)
"""Which actuators are prismatic."""


class MotionRecord:
    """Follows one episode's torso acceleration and actuators.

    :param control_rate: ticks per second
    """

    def __init__(self, control_rate: int) -> None:
        self._control_rate = control_rate
        self._accelerations: list[Vector] = []
        self._energy_rate = 0.0
        self._ticks = 0
        self.peak_hip_rate = 0.0
        self.peak_leg_speed = 0.0

    def tick(self, acceleration: Vector, speeds: Sequence[float], efforts: Sequence[float]) -> None:
        """Note one control tick.

        :param acceleration: the torso's true specific force, in m/s^2
        :param speeds: of the actuators in the order of ``ACTUATED_JOINTS``, in rad/s and m/s
        :param efforts: torques and forces of the same, in Nm and N
        """
        self._ticks += 1
        self._accelerations.append(acceleration)
        for is_leg, speed, effort in zip(LEGS, speeds, efforts, strict=True):
            self._energy_rate += abs(speed * effort)
            if is_leg:
                self.peak_leg_speed = max(self.peak_leg_speed, abs(speed))
            else:
                self.peak_hip_rate = max(self.peak_hip_rate, abs(speed))

    @property
    def actuator_power(self) -> float:
        """Mean over the ticks of the six actuators' mechanical power, braking counted like driving, in W."""
        return self._energy_rate / self._ticks if self._ticks else 0.0

    @property
    def vibration(self) -> float:
        """Mean square of the torso's acceleration above 20 Hz, all axes together, in m^2/s^4."""
        return power_above(np.array(self._accelerations), self._control_rate, CHATTER_HZ)


def power_above(signals: np.ndarray, rate: int, hertz: float) -> float:
    """Mean square of what signals hold above a frequency, summed over the signals.

    :param signals: of shape (time, signals)
    :param rate: samples per second
    :param hertz: the frequency
    :return: in the signals' unit squared; 0 for less than half a second
    """
    length = len(signals)
    if length < SHORTEST_SPECTRUM_SECONDS * rate:
        return 0.0
    window = np.hanning(length)  # so that slow motion does not leak into high frequencies
    spectrum = np.abs(np.fft.rfft((signals - signals.mean(axis=0)) * window[:, None], axis=0)) ** 2
    spectrum[1 : (length + 1) // 2] *= 2.0  # the negative frequencies
    above = np.fft.rfftfreq(length, 1.0 / rate) > hertz
    return float(spectrum[above].sum() / (length * (window**2).sum()))
