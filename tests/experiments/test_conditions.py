"""Sensors that are exactly as wrong as a situation says, in the direction that the seed draws."""

import math

import pytest

from experiments.robot.conditions import askew, biased
from sarah.simulation.randomisation import SensorConditions


def test_the_tilt_is_two_degrees_about_the_axis_that_was_drawn() -> None:
    drawn = SensorConditions(imu_tilt=(0.003, -0.004), pad_noise_density=0.4)
    two_degrees = math.pi / 90
    assert askew(drawn).imu_tilt == pytest.approx((0.6 * two_degrees, -0.8 * two_degrees))
    assert askew(drawn).pad_noise_density == 0.4


def test_the_gyroscope_is_off_with_the_signs_that_were_drawn() -> None:
    assert biased(SensorConditions(angular_rate_bias=(0.01, -0.02, -0.001))).angular_rate_bias == (0.05, -0.05, -0.05)
