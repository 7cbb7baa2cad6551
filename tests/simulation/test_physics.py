"""Settings of the integration: what each engine takes of them. And what an episode's seed draws of the robot."""

import dataclasses
import math

import pytest

from sarah.robot.scale import Scale
from sarah.simulation.physics import PHYSICS, Physics, PyBulletPhysics, physics_for
from sarah.simulation.randomisation import NOMINAL, Randomisation, draw_conditions


@pytest.mark.parametrize("rate", [100, 250])
@pytest.mark.parametrize("name", PHYSICS)
def test_named_settings_go_to_mujoco_and_come_back(name: str, rate: int) -> None:
    named = PHYSICS[name].at_control_rate(rate)
    in_mujoco = physics_for("mujoco", named, Scale())
    assert in_mujoco == Physics(named.rate, named.solver_iterations, rate) and type(in_mujoco) is Physics
    assert physics_for("mujoco", in_mujoco, Scale()) is in_mujoco
    assert physics_for("pybullet", in_mujoco, Scale()) == named
    assert PHYSICS["standard"].added_plate_inertia > PHYSICS["reference"].added_plate_inertia == 0.0


def test_nameless_settings_get_the_standard_inertia_in_pybullet() -> None:
    taken = physics_for("pybullet", Physics(rate=400, solver_iterations=7, control_rate=200), Scale())
    assert taken == PyBulletPhysics(400, 7, 200, added_plate_inertia=PHYSICS["standard"].added_plate_inertia)
    own = PyBulletPhysics(400, 7, 200, added_plate_inertia=0.001)
    assert physics_for("pybullet", own, Scale()) is own
    assert physics_for("mujoco", own, Scale()) == Physics(400, 7, 200)


@pytest.mark.parametrize("rate", [50, 150, 1000])
def test_another_control_rate_keeps_at_least_the_rate(rate: int) -> None:
    for physics in PHYSICS.values():
        taken = physics.at_control_rate(rate)
        assert taken.control_rate == rate and taken.control_dt == 1.0 / rate
        assert physics.rate <= taken.rate < physics.rate + rate and taken.rate % rate == 0


def test_everything_the_seed_draws_is_within_its_range() -> None:
    for seed in range(200):
        drawn = draw_conditions(Randomisation(), seed)
        assert 0.7 <= drawn.friction <= 1.0 and 40.0 <= drawn.actuator_bandwidth <= 50.0
        assert max(map(abs, drawn.mass_offset)) <= 0.010
        assert all(0.95 <= factor <= 1.05 for factor in drawn.mass_factors.values())
        assert len(set(drawn.mass_factors.values())) == len(drawn.mass_factors)
    drawn, other = (draw_conditions(ranges, 5) for ranges in (Randomisation(), Randomisation(friction=(0.2, 0.3))))
    assert 0.2 <= other.friction <= 0.3 and dataclasses.replace(other, friction=drawn.friction) == drawn


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
    for side in zip(*(sensors.imu_tilt for sensors in drawn), strict=True):
        assert 150 < sum(tilt > 0 for tilt in side) < 250


def test_randomisation_off_leaves_the_robot_as_designed() -> None:
    assert [draw_conditions(Randomisation(enabled=False), seed) for seed in (1, 2)] == [NOMINAL, NOMINAL]
