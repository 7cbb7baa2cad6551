"""Imperfect sensors: one reading per control tick, with constant errors, band limit, noise and delay."""

from __future__ import annotations

import math
from collections import deque
from typing import Any

import numpy as np

from sarah.robot.filters import low_pass_gain
from sarah.robot.reading import SensorReading, Vector
from sarah.simulation.randomisation import SensorConditions

NOISES_AT_ONCE = 100
"""Number of ticks whose noise is drawn at once."""


class ImperfectSensors:
    """Model of real sensors. Signals are band-limited, delayed, get their constant errors, and then the noise.

    Before its first reading the robot has been at rest for long, so the band limit begins at that reading.

    :param conditions: errors of the sensors in this episode
    :param dt: control period, in s
    """

    def __init__(self, conditions: SensorConditions, dt: float) -> None:
        to_deviation = math.sqrt(0.5 / dt)  # a sample holds all frequencies up to half the control rate
        deviations = (
            [conditions.acceleration_noise_density * to_deviation] * 3
            + [conditions.angular_rate_noise_density * to_deviation] * 3
            + [conditions.pad_noise_density * to_deviation] * 4
        )
        self._deviations = np.array(deviations)
        self._generator = np.random.default_rng(conditions.seed)
        self._noise: list[list[float]] = []
        self._conditions = conditions
        self._rotation = _rotation(*conditions.imu_tilt)
        ticks = conditions.delay_seconds / dt
        whole = math.ceil(ticks - 1e-9)
        self._share_of_later = max(0.0, whole - ticks)
        self._pending: deque[SensorReading] = deque(maxlen=whole + 1)
        bandwidth = conditions.imu_bandwidth
        self._imu_gain = low_pass_gain(1.0 / (2.0 * math.pi * bandwidth), dt) if bandwidth < math.inf else 1.0
        self._imu: tuple[float, ...] | None = None

    def __call__(self, truth: SensorReading) -> SensorReading:
        """Take the true reading of this tick, and return the reading that the controller sees."""
        self._pending.append(self._band_limited(truth))
        (ax, ay, az), (wx, wy, wz), (a, b, c, d), joints = self._delayed()
        conditions = self._conditions
        if self._rotation is not None:
            ax, ay, az = _rotated(self._rotation, (ax, ay, az))
            wx, wy, wz = _rotated(self._rotation, (wx, wy, wz))
        (bax, bay, baz), (bwx, bwy, bwz) = conditions.acceleration_bias, conditions.angular_rate_bias
        ga, gb, gc, gd = conditions.pad_gains
        nax, nay, naz, nwx, nwy, nwz, na, nb, nc, nd = self._next_noise()
        return SensorReading(
            (ax + bax + nax, ay + bay + nay, az + baz + naz),
            (wx + bwx + nwx, wy + bwy + nwy, wz + bwz + nwz),
            (max(0.0, a * ga + na), max(0.0, b * gb + nb), max(0.0, c * gc + nc), max(0.0, d * gd + nd)),
            joints,
        )

    def _next_noise(self) -> list[float]:
        """Noise of the next ten signals; many at once take a fraction of the time, and are the same."""
        if not self._noise:
            drawn: list[list[float]] = (
                self._generator.standard_normal((NOISES_AT_ONCE, 10)) * self._deviations
            ).tolist()
            self._noise = drawn[::-1]
        return self._noise.pop()

    def _delayed(self) -> SensorReading:
        """Reading of the delay ago; between two ticks it lies on the line from one to the other."""
        share = self._share_of_later
        if share == 0.0 or len(self._pending) < 2:
            return self._pending[0]
        earlier, later = self._pending[0], self._pending[1]
        between: list[Any] = [
            tuple([now + share * (then - now) for now, then in zip(values, others, strict=True)])
            for values, others in zip(earlier, later, strict=True)
        ]
        return SensorReading(*between)

    def _band_limited(self, truth: SensorReading) -> SensorReading:
        gain = self._imu_gain
        if gain == 1.0:
            return truth
        signals = (*truth.acceleration, *truth.angular_rate)
        before = self._imu or signals
        self._imu = tuple([last + gain * (now - last) for last, now in zip(before, signals, strict=True)])
        x, y, z, about_x, about_y, about_z = self._imu
        return truth._replace(acceleration=(x, y, z), angular_rate=(about_x, about_y, about_z))


Rotation = tuple[Vector, Vector, Vector]


def _rotation(about_x: float, about_y: float) -> Rotation | None:
    """Matrix from the torso's frame into that of a sensor turned about a horizontal axis; ``None`` if it is not."""
    angle = math.hypot(about_x, about_y)
    if angle == 0.0:
        return None
    x, y, cosine, sine = about_x / angle, about_y / angle, math.cos(angle), math.sin(angle)
    rest = 1.0 - cosine
    return (
        (cosine + x * x * rest, x * y * rest, -y * sine),
        (x * y * rest, cosine + y * y * rest, x * sine),
        (y * sine, -x * sine, cosine),
    )


def _rotated(rotation: Rotation, vector: Vector) -> Vector:
    (a, b, c), (d, e, f), (g, h, i) = rotation
    x, y, z = vector
    return (a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z)
