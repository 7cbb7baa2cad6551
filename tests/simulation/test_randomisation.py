"""What an episode's seed draws of the robot and the world."""

import dataclasses
import math

import pytest

from sarah.simulation.randomisation import NOMINAL, Randomisation, draw_conditions


def test_everything_the_seed_draws_is_within_its_range() -> None:
    ranges = Randomisation()
    for seed in range(200):
        drawn = draw_conditions(ranges, seed)
        assert 0.7 <= drawn.friction <= 1.0
        assert 40.0 <= drawn.actuator_bandwidth <= 50.0
        assert max(map(abs, drawn.mass_offset)) <= 0.010
        assert all(0.95 <= factor <= 1.05 for factor in drawn.mass_factors.values())
        assert len(set(drawn.mass_factors.values())) == len(drawn.mass_factors)


def test_changing_one_range_leaves_the_other_draws_alone() -> None:
    drawn = draw_conditions(Randomisation(), 5)
    other = draw_conditions(Randomisation(friction=(0.2, 0.3)), 5)
    assert 0.2 <= other.friction <= 0.3
    assert dataclasses.replace(other, friction=drawn.friction) == drawn


def test_errors_of_sensors_fill_their_ranges_to_both_sides() -> None:
    drawn = [draw_conditions(Randomisation(), seed).sensors for seed in range(400)]
    for errors, largest in (
        ([error for sensors in drawn for error in sensors.acceleration_bias], 0.1),
        ([error for sensors in drawn for error in sensors.angular_rate_bias], 0.02),
        ([gain - 1.0 for sensors in drawn for gain in sensors.pad_gains], 0.2),
    ):
        assert 0.95 * largest < max(errors) <= largest and -largest <= min(errors) < -0.95 * largest
    angles = [math.degrees(math.hypot(*sensors.imu_tilt)) for sensors in drawn]
    assert 1.9 < max(angles) <= 2.0 and sum(angles) / len(angles) == pytest.approx(1.0, abs=0.1)
    assert all(
        sum(x * a + y * b > 0 for x, y in (s.imu_tilt for s in drawn)) > 150
        for a, b in ((1, 0), (-1, 0), (0, 1), (0, -1))
    )


def test_randomisation_off_leaves_the_robot_as_designed() -> None:
    assert (
        draw_conditions(Randomisation(enabled=False), 1) == draw_conditions(Randomisation(enabled=False), 2) == NOMINAL
    )
