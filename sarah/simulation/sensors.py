"""Imperfect sensors: one reading per control tick, with the band limit, noise and delay of real sensors."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator

import numpy as np

from sarah.robot.filters import low_pass_gain
from sarah.robot.reading import SensorReading

TICKS_AT_ONCE = 256
"""Number of control ticks for which noise is drawn at once."""


class ImperfectSensors:
    """Model of real sensors: band limit and noise of the inertial measurement unit, noise of the pads, and delay.

    :param acceleration_noise: standard deviation of the accelerometer's white noise, in m/s^2
    :param angular_rate_noise: standard deviation of the gyroscope's white noise, in rad/s
    :param imu_bandwidth: bandwidth of the inertial measurement unit's first-order low-pass, in Hz; infinite for none
    :param pad_noise: standard deviation of each pressure pad's white noise, in N
    :param delay_ticks: delay of all signals, in control ticks
    :param seed: seed of the noise
    :param dt: control period, in s
    """

    def __init__(
        self,
        acceleration_noise: float,
        angular_rate_noise: float,
        imu_bandwidth: float,
        pad_noise: float,
        delay_ticks: int,
        seed: int,
        dt: float,
    ) -> None:
        deviations = [acceleration_noise] * 3 + [angular_rate_noise] * 3 + [pad_noise] * 4
        self._deviations = np.array(deviations)
        self._generator = np.random.default_rng(seed)
        self._noise: Iterator[list[float]] = iter(())
        self._pending: deque[SensorReading] = deque(maxlen=delay_ticks + 1)
        self._imu_gain = low_pass_gain(1.0 / (2.0 * math.pi * imu_bandwidth), dt) if imu_bandwidth < math.inf else 1.0
        self._imu = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

    def __call__(self, truth: SensorReading) -> SensorReading:
        """Take the true reading of this tick, and return the reading that the controller sees."""
        self._pending.append(self._band_limited(truth))
        (ax, ay, az), (wx, wy, wz), (a, b, c, d), joints = self._pending[0]
        nax, nay, naz, nwx, nwy, nwz, na, nb, nc, nd = self._next_noise()
        return SensorReading(
            (ax + nax, ay + nay, az + naz),
            (wx + nwx, wy + nwy, wz + nwz),
            (max(0.0, a + na), max(0.0, b + nb), max(0.0, c + nc), max(0.0, d + nd)),
            joints,
        )

    def _band_limited(self, truth: SensorReading) -> SensorReading:
        gain = self._imu_gain
        if gain == 1.0:
            return truth
        x, y, z, about_x, about_y, about_z = self._imu
        (ax, ay, az), (wx, wy, wz), pressures, joints = truth
        # The same filter as LowPass: six calls of it would cost a microsecond per tick.
        x += gain * (ax - x)
        y += gain * (ay - y)
        z += gain * (az - z)
        about_x += gain * (wx - about_x)
        about_y += gain * (wy - about_y)
        about_z += gain * (wz - about_z)
        self._imu = (x, y, z, about_x, about_y, about_z)
        return SensorReading((x, y, z), (about_x, about_y, about_z), pressures, joints)

    def _next_noise(self) -> list[float]:
        """Noise of the ten noisy signals in one tick. It is drawn for many ticks at once, which is faster."""
        noise = next(self._noise, None)
        if noise is None:
            drawn = self._generator.standard_normal((TICKS_AT_ONCE, len(self._deviations)))
            self._noise = iter((drawn * self._deviations).tolist())
            noise = next(self._noise)
        return noise
