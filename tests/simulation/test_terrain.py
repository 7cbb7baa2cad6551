"""Slopes, and how a robot stands on them and on level ground; settings of physics; what a seed draws of the robot."""

import math
from dataclasses import replace

import numpy as np
import pytest
from laboratory import BuildSimulation, Laboratory, advance

from sarah.robot.reading import GRAVITY
from sarah.robot.scale import Scale
from sarah.scenery.ground import LEVEL
from sarah.simulation.physics import PHYSICS, Physics, PyBulletPhysics, physics_for
from sarah.simulation.randomisation import NOMINAL, Conditions, Randomisation, draw_conditions
from sarah.simulation.simulator import Simulator
from sarah.simulation.terrain import Terrain, draw_ground

SECOND = PHYSICS["standard"].control_rate


def slope(degrees: float, uphill: float) -> Terrain:
    return Terrain((degrees, degrees), (uphill, uphill))


def on(terrain: Terrain) -> Conditions:
    return Conditions(friction=0.9, ground=draw_ground(terrain, 0))


@pytest.mark.parametrize(("uphill", "x", "y"), [(0.0, 1.0, 0.0), (90.0, 0.0, 1.0)])
def test_standing_robot_feels_gravity_as_if_it_leaned_downhill(
    build: BuildSimulation, uphill: float, x: float, y: float
) -> None:
    simulation, readings = build(on(slope(5.0, uphill))), []
    advance(simulation, SECOND)
    for _ in range(SECOND):
        simulation.advance()
        readings.append(simulation.read().acceleration)
    g_sin, g_cos = GRAVITY * math.sin(math.radians(5.0)), GRAVITY * math.cos(math.radians(5.0))
    assert np.mean(readings, axis=0) == pytest.approx((x * g_sin, y * g_sin, g_cos), abs=0.01)


def test_a_falling_robot_has_gravitys_pull_and_feels_nothing(lab: Laboratory, build: BuildSimulation) -> None:
    conditions = on(slope(10.0, 30.0))
    simulation = build(conditions)
    lab.place(simulation)
    advance(simulation, SECOND // 10)
    assert simulation.torso_state().velocity == pytest.approx(0.1 * np.array(conditions.ground.gravity), abs=1e-6)
    assert simulation.read().acceleration == pytest.approx((0.0, 0.0, 0.0), abs=1e-6)


def test_one_simulation_leaves_the_next_on_its_own_slope(build: BuildSimulation) -> None:
    readings = []
    for degrees in (0.0, 20.0, 0.0):
        simulation = build(on(slope(degrees, 0.0)))
        advance(simulation, SECOND // 5)
        readings.append(simulation.read())
        simulation.close()
    assert readings[0] == readings[2] != readings[1]


@pytest.mark.parametrize(("degrees", "uphill"), [(12.0, 0.0), (12.0, 90.0), (30.0, 215.0)])
def test_gravity_points_downhill(degrees: float, uphill: float) -> None:
    gravity = np.array(draw_ground(slope(degrees, uphill), 3).gravity)
    along = (math.cos(math.radians(uphill)), math.sin(math.radians(uphill)), 0.0)
    assert np.linalg.norm(gravity) == pytest.approx(GRAVITY)
    assert gravity @ along == pytest.approx(-GRAVITY * math.sin(math.radians(degrees)))
    assert gravity[2] == pytest.approx(-GRAVITY * math.cos(math.radians(degrees)))


def test_slopes_cover_their_ranges() -> None:
    terrain = Terrain(slope_degrees=(2.0, 10.0), direction_degrees=(0.0, 360.0))
    drawn = np.array([draw_ground(terrain, seed).gravity for seed in range(400)])
    degrees = np.degrees(np.arccos(-drawn[:, 2] / GRAVITY))
    assert 2.0 <= degrees.min() < 2.2 and 9.8 < degrees.max() <= 10.0
    assert len({(x > 0.0, y > 0.0) for x, y, _ in drawn}) == 4
    # A seed draws the same direction on any slope
    gentle, steep = (draw_ground(Terrain((degrees, degrees)), seed=5).gravity for degrees in (3.0, 9.0))
    assert gentle != draw_ground(Terrain((3.0, 3.0)), seed=6).gravity
    assert math.atan2(gentle[1], gentle[0]) == pytest.approx(math.atan2(steep[1], steep[0]))


def test_level_ground_is_exactly_level() -> None:
    flat = Terrain(), Terrain(direction_degrees=(200.0, 210.0)), Terrain(cell=(0.03, 0.03))
    assert all(draw_ground(terrain, seed) == LEVEL for terrain in flat for seed in range(2))


def test_a_standing_robot_keeps_its_place_and_loads_its_pads(build: BuildSimulation) -> None:
    """The pads carry most of the weight, but not all: sole friction holds the rest. Measured: 86 % of it together."""
    simulation, weight = build(), 30.0 * GRAVITY
    height, loads = simulation.torso_state().position[2], []
    for tick in range(10 * SECOND):
        simulation.advance()
        torso = simulation.torso_state()
        assert math.hypot(*torso.position[:2]) < 0.001 and abs(torso.position[2] - height) < 0.0005
        assert torso.axis[2] > math.cos(math.radians(0.1))
        if tick >= SECOND:
            loads.append(simulation.read().pressures)
    pads = np.array(loads)
    total = pads.sum(axis=1)
    assert (0.75 * weight < total).all() and (total < weight).all() and np.ptp(total) < 0.05 * weight
    assert abs(pads[:, :2].sum(axis=1).mean() - pads[:, 2:].sum(axis=1).mean()) < 0.03 * weight
    assert (pads > 0.15 * weight).all()


def drift(simulation: Simulator, seconds: int) -> float:
    """How far a robot drifts along the ground, after a second in which it settles, in m."""
    places = []
    for duration in (1, seconds):
        advance(simulation, duration * SECOND)
        places.append(simulation.torso_state().position[:2])
    return math.dist(*places)


def test_a_robot_of_other_masses_and_friction_does_not_creep(build: BuildSimulation) -> None:
    """Measured in PyBullet: up to 5 mm in 14 s on 8 degrees; MuJoCo 0.5 mm."""
    assert drift(build(draw_conditions(Randomisation(), 5)), 5) < 0.0003
    drawn = draw_conditions(Randomisation(), 2)
    for degrees in (45.0, 270.0):
        ground = draw_ground(Terrain((8.0, 8.0), (degrees, degrees)), 0)
        assert drift(build(replace(drawn, ground=ground)), 4) < 0.003


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
    assert 0.2 <= other.friction <= 0.3 and replace(other, friction=drawn.friction) == drawn


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
