"""What the robot senses: one reading per control tick, with the band limit, noise and delay of real sensors."""

from __future__ import annotations

import math
import random
from collections import deque
from typing import NamedTuple

from sarah.filters import LowPass

Vector = tuple[float, float, float]


class SensorReading(NamedTuple):
    """One control tick's 16 signals.

    :param acceleration: specific force in the torso's frame (x right, y forward, z up), in m/s^2; (0, 0, 9.81) at rest
    :param angular_rate: of the torso in its own frame, in rad/s
    :param pressures: load on the four ankle pads in N: left forefoot, left hindfoot, right forefoot, right hindfoot
        (the paper's LFP, LBP, RFP, RBP)
    :param joints: actuator positions in the order of :data:`sarah.description.ACTUATED_JOINTS`: left and right
        abduction and flexion in rad, left and right leg length in m, positive = retracted
    """

    acceleration: Vector
    angular_rate: Vector
    pressures: tuple[float, float, float, float]
    joints: tuple[float, float, float, float, float, float]


class ImperfectSensors:
    """What real sensors add: band limit and white noise of the inertial measurement unit, noise of the pads, delay.

    :param acceleration_noise: standard deviation in m/s^2
    :param angular_rate_noise: standard deviation in rad/s
    :param imu_bandwidth: of the inertial measurement unit's first-order low-pass, in Hz; infinite for none
    :param pad_noise: standard deviation in N, on each pad
    :param delay_ticks: control ticks by which every signal comes late
    :param seed: of the noise
    :param dt: control period in s
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
        self._acceleration_noise = acceleration_noise
        self._angular_rate_noise = angular_rate_noise
        self._pad_noise = pad_noise
        self._gauss = random.Random(seed).gauss
        self._pending: deque[SensorReading] = deque(maxlen=delay_ticks + 1)
        self._imu: list[LowPass] | None = None
        if math.isfinite(imu_bandwidth):
            self._imu = [LowPass(1.0 / (2.0 * math.pi * imu_bandwidth), dt) for _ in range(6)]

    def __call__(self, truth: SensorReading) -> SensorReading:
        """Take the true reading of this tick and return what the controller gets to see."""
        if self._imu is not None:
            ax, ay, az, wx, wy, wz = (
                limit(value) for limit, value in zip(self._imu, (*truth.acceleration, *truth.angular_rate), strict=True)
            )
            truth = truth._replace(acceleration=(ax, ay, az), angular_rate=(wx, wy, wz))
        self._pending.append(truth)
        late = self._pending[0]
        return late._replace(
            acceleration=self._noisy(late.acceleration, self._acceleration_noise),
            angular_rate=self._noisy(late.angular_rate, self._angular_rate_noise),
            pressures=self._noisy_pads(late.pressures),
        )

    def _noisy(self, vector: Vector, deviation: float) -> Vector:
        if deviation == 0.0:
            return vector
        x, y, z = vector
        gauss = self._gauss
        return (x + gauss(0.0, deviation), y + gauss(0.0, deviation), z + gauss(0.0, deviation))

    def _noisy_pads(self, pressures: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
        if self._pad_noise == 0.0:
            return pressures
        a, b, c, d = (max(0.0, pressure + self._gauss(0.0, self._pad_noise)) for pressure in pressures)
        return (a, b, c, d)
