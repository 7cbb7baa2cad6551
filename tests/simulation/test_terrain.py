"""Slopes: what is drawn of them, and what they do to a robot in each engine; and how it stands on level ground."""

import math
from dataclasses import replace

import numpy as np
import pytest
from laboratory import BuildSimulation, Laboratory, advance

from sarah.robot.reading import GRAVITY
from sarah.scenery.ground import LEVEL
from sarah.simulation.physics import PHYSICS
from sarah.simulation.randomisation import Conditions, Randomisation, draw_conditions
from sarah.simulation.simulator import Simulator
from sarah.simulation.terrain import Terrain, draw_ground

SECOND = PHYSICS["standard"].control_rate


def slope(degrees: float, uphill: float) -> Terrain:
    return Terrain((degrees, degrees), (uphill, uphill))


@pytest.fixture
def build_on(build: BuildSimulation) -> BuildSimulation:
    """Function that builds a robot on a slope, and lets it stand there for some seconds."""

    def build_one(terrain: Terrain, seconds: float = 0.0) -> Simulator:
        simulation = build(Conditions(friction=0.9, ground=draw_ground(terrain, 0)))
        advance(simulation, round(seconds * SECOND))
        return simulation

    return build_one


def test_a_falling_robot_has_gravitys_pull_and_feels_nothing(lab: Laboratory, build_on: BuildSimulation) -> None:
    terrain = slope(10.0, 30.0)
    simulation = build_on(terrain)
    lab.place(simulation)
    advance(simulation, SECOND // 10)
    fallen = np.array(draw_ground(terrain, 0).gravity) * 0.1
    assert simulation.torso_state().velocity == pytest.approx(tuple(fallen), abs=1e-6)
    assert simulation.read().acceleration == pytest.approx((0.0, 0.0, 0.0), abs=1e-6)


def test_one_simulation_leaves_the_next_on_its_own_slope(build_on: BuildSimulation) -> None:
    before = build_on(Terrain(), seconds=0.2).read()
    build_on(slope(20.0, 0.0), seconds=0.2).close()
    assert build_on(Terrain(), seconds=0.2).read() == before


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
