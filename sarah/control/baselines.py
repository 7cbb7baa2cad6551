"""Slow baselines of the inertial signals: what a slope, an askew sensor or a gyroscope's bias adds to them all along.

    corrected = signal - baseline

While the robot stands, a baseline is the mean of all finite readings so far; once it steps, it follows by a low-pass of
some seconds, which is slower than steps and falls. Without it, an inertial measurement unit mounted 4 degrees askew
reads 0.7 m/s^2 to the side. The hip law would hold that for a push, and the pattern generator would wait for a tilt
that never comes.
"""

from __future__ import annotations

from sarah.control.constants import STANDARD_CONSTANTS, ControllerConstants
from sarah.robot.filters import clipped, low_pass_gain
from sarah.robot.reading import LARGEST_SIGNAL, STANDING, SensorReading


class Baselines:
    """Baselines of the three inertial signals that the controller uses. Call :meth:`corrected` once per control tick.

    :param dt: control period, in s
    :param constants: time constant and limits of the controller
    :raises ConfigurationError: if the period is not finite and above zero
    """

    def __init__(self, dt: float, constants: ControllerConstants = STANDARD_CONSTANTS) -> None:
        self.acceleration_x = 0.0
        """Baseline of the lateral acceleration, in m/s^2."""
        self.rate_x = 0.0
        """Baseline of the angular rate about x, in rad/s."""
        self.rate_y = 0.0
        """Baseline of the angular rate about y, in rad/s."""
        self._constants = constants
        self._slow_gain = low_pass_gain(constants.baseline_time_constant, dt)
        self._standing_readings = [0, 0, 0]
        self._reading = STANDING

    def corrected(self, reading: SensorReading, is_standing: bool) -> SensorReading:
        """Follow one reading, and subtract the baselines from it.

        :param reading: sensor reading of this tick. A signal that is not finite keeps its last value, and enters no
            mean; outliers are clipped, before a baseline learns from them
        :param is_standing: whether the robot stands and does not yet step
        :return: the same reading, finite, with corrected lateral acceleration and rates about x and y
        """
        gain_x, gain_rate_x, gain_rate_y = self._gains_of_means(reading) if is_standing else [self._slow_gain] * 3
        reading = self._reading = reading.repaired(self._reading)
        constants = self._constants
        (acceleration_x, acceleration_y, acceleration_z), (rate_x, rate_y, rate_z), pressures, joints = reading
        acceleration_x = clipped(acceleration_x, constants.largest_acceleration)
        rate_x = clipped(rate_x, constants.largest_rate)
        rate_y = clipped(rate_y, constants.largest_rate)
        self.acceleration_x += gain_x * (acceleration_x - self.acceleration_x)
        self.rate_x += gain_rate_x * (rate_x - self.rate_x)
        self.rate_y += gain_rate_y * (rate_y - self.rate_y)
        return SensorReading(
            (acceleration_x - self.acceleration_x, acceleration_y, acceleration_z),
            (rate_x - self.rate_x, rate_y - self.rate_y, rate_z),
            pressures,
            joints,
        )

    def _gains_of_means(self, reading: SensorReading) -> list[float]:
        """Weights with which three signals enter the means of their finite readings so far."""
        signals = reading.acceleration[0], reading.angular_rate[0], reading.angular_rate[1]
        are_finite = [bool(abs(signal) < LARGEST_SIGNAL) for signal in signals]
        numbers = self._standing_readings = [
            number + is_finite for number, is_finite in zip(self._standing_readings, are_finite, strict=True)
        ]
        return [is_finite / max(1, number) for number, is_finite in zip(numbers, are_finite, strict=True)]
