"""The slow baselines of the inertial signals, against means and low-passes by hand."""

import math

import pytest

from sarah.control.baselines import Baselines
from sarah.robot.reading import SensorReading

DT = 0.01


def reading(acceleration_x: float = 0.0, rate_x: float = 0.0, rate_y: float = 0.0) -> SensorReading:
    return SensorReading((acceleration_x, 0.3, 9.81), (rate_x, rate_y, 0.7), (75.0,) * 4, (0.1,) * 6)


def signals(reading: SensorReading) -> tuple[float, float, float]:
    return reading.acceleration[0], reading.angular_rate[0], reading.angular_rate[1]


def test_while_standing_baselines_are_the_means_so_far() -> None:
    baselines = Baselines(DT)
    corrected = [signals(baselines.corrected(reading(*values), True)) for values in ((1, 2, 3), (3, 1, 9), (2, 0, 0))]
    assert corrected[0] == (0.0, 0.0, 0.0)
    assert corrected[1] == pytest.approx((3 - 2, 1 - 1.5, 9 - 6))
    assert corrected[2] == pytest.approx((2 - 2, 0 - 1, 0 - 4))
    assert (baselines.acceleration_x, baselines.rate_x, baselines.rate_y) == pytest.approx((2, 1, 4))


@pytest.mark.parametrize("bad", [math.nan, -1e300])
def test_a_mean_is_that_of_the_finite_readings_of_its_signal(bad: float) -> None:
    """In between the value before stands in for one that is not, and in the beginning zero."""
    baselines = Baselines(DT)
    assert signals(baselines.corrected(reading(bad, bad, bad), True)) == (0.0, 0.0, 0.0)
    for measured in ((bad, 1.0, 2.0), (1.0, 5.0, bad), (bad, bad, 6.0), (5.0, 9.0, bad)):
        corrected = baselines.corrected(reading(*measured), True)
    assert (baselines.acceleration_x, baselines.rate_x, baselines.rate_y) == pytest.approx((3.0, 5.0, 4.0))
    assert signals(corrected) == pytest.approx((2.0, 4.0, 2.0))


def test_stepping_baselines_follow_within_eight_seconds() -> None:
    """Other signals pass unchanged, and those of a robot that goes on as it stood are zero."""
    baselines = Baselines(DT)
    for stands in (True, False):
        assert baselines.corrected(reading(5.0, 1.0, 1.0), stands) == reading()
    baselines = Baselines(DT)
    baselines.corrected(reading(), True)
    for _ in range(800):
        corrected = baselines.corrected(reading(1.0, 2.0, 3.0), False)
    assert signals(corrected) == pytest.approx((math.exp(-1.0), 2.0 * math.exp(-1.0), 3.0 * math.exp(-1.0)))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_outliers_count_as_the_largest_signals(sign: float) -> None:
    baselines = Baselines(DT)
    baselines.corrected(reading(), True)
    share = math.exp(-DT / 8.0)
    outlier = baselines.corrected(reading(sign * 1e5, sign * 1e5, sign * 1e5), False)
    assert signals(outlier) == pytest.approx((sign * 20 * share, sign * 10 * share, sign * 10 * share))
