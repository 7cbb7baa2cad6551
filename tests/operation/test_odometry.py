"""The displacement that the legs tell."""

import math

import pytest

from sarah.operation.odometry import LegOdometry
from sarah.robot.reading import SensorReading

HEIGHT, DT = 0.9, 0.01
LEFT, RIGHT = (40.0, 40.0, 0.0, 0.0), (0.0, 0.0, 40.0, 40.0)


def reading(
    pads: tuple[float, float, float, float], joints: tuple[float, ...] = (0.0,) * 6, rate: tuple[float, ...] = (0, 0, 0)
) -> SensorReading:
    return SensorReading((0.0, 0.0, 9.81), rate, pads, joints)  # type: ignore[arg-type]


@pytest.fixture
def odometry() -> LegOdometry:
    return LegOdometry(HEIGHT, DT)


def test_standing_and_the_leg_in_the_air_move_nothing(odometry: LegOdometry) -> None:
    for _ in range(300):
        odometry.tick(reading(LEFT))
    assert (odometry.x, odometry.y) == (0.0, 0.0)
    odometry.tick(reading(LEFT, (0.0, 0.1, 0.0, 0.1, 0.0, 0.0)))
    assert (odometry.x, odometry.y) == (0.0, 0.0)


@pytest.mark.parametrize(("joint", "x", "y"), [(0, 1.0, 0.0), (2, 0.0, -1.0)])
def test_the_leg_that_carries_moves_the_torso_by_its_lean(
    joint: int, x: float, y: float, odometry: LegOdometry
) -> None:
    """Abduction turns the feet to the left, so the torso goes to the right; flexion turns them forward."""
    odometry.tick(reading(LEFT))
    odometry.tick(reading(LEFT, tuple(0.1 * (index == joint) for index in range(6))))
    moved = HEIGHT * math.sin(0.1)
    assert (odometry.x, odometry.y) == pytest.approx((x * moved, y * moved))


def test_steps_add_up(odometry: LegOdometry) -> None:
    steps = 6
    for step in range(steps):
        pads, is_left = (LEFT, True) if step % 2 else (RIGHT, False)
        for carrying in (0.1, 0.05, 0.0, -0.05, -0.1):
            left, right = (carrying, -carrying) if is_left else (-carrying, carrying)
            odometry.tick(reading(pads, (0.0, 0.0, left, right, 0.0, 0.0)))
    assert odometry.y == pytest.approx(steps * 2.0 * HEIGHT * math.sin(0.1))


def test_what_the_torso_moves_while_the_feet_change_counts(odometry: LegOdometry) -> None:
    odometry.tick(reading(LEFT, (0.0, 0.0, 0.1, 0.3, 0.0, 0.0)))
    odometry.tick(reading(RIGHT, (0.0, 0.0, 0.0, 0.2, 0.0, 0.0)))
    odometry.tick(reading(RIGHT, (0.0, 0.0, -0.1, 0.1, 0.0, 0.0)))
    assert odometry.y == pytest.approx(HEIGHT * (math.sin(0.1) + math.sin(0.2) - math.sin(0.1)))


def test_a_constant_error_of_the_gyroscope_is_forgotten(odometry: LegOdometry) -> None:
    for tick in range(6000):
        odometry.tick(reading(LEFT, rate=(0.05, 0.05, 0.0)))
        if tick == 4000:
            before = (odometry.x, odometry.y)
    assert math.dist((odometry.x, odometry.y), before) < 0.001
