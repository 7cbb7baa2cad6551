"""Rough ground: one surface for both engines, for spawning and for clearances; and friction of its own per foot."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from laboratory import BuildSimulation, Laboratory, advance, laboratory, need

from sarah import PHYSICS
from sarah.errors import ConfigurationError
from sarah.robot.description import describe_robot
from sarah.robot.reading import Side
from sarah.scenery.ground import LEVEL, Ground
from sarah.simulation.build import simulator_of
from sarah.simulation.randomisation import Conditions
from sarah.simulation.terrain import Terrain, draw_ground

ROUGH = Terrain(roughness=0.01)
RADIUS = describe_robot().contact_radius
HILL = Ground(heights=((0.0, 0.0, 0.0), (0.0, 0.01, 0.0), (0.0, 0.0, 0.0)), cell=0.1)

HEIGHTS = {
    **{(0.0, 0.0): 0.01, (0.05, 0.0): 0.005, (0.02, 0.03): 0.005, (-0.02, 0.02): 0.008, (-0.02, -0.02): 0.006},
    **{(-0.05, 0.05): 0.005, (-0.05, -0.05): 0.0},  # on the edge between two triangles, and where it passes the hill
    **{(0.1, 0.1): 0.0, (0.2, 0.0): 0.0},  # beyond
}


def test_heights_distances_and_highest_places_of_a_hill_by_hand() -> None:
    """Right of the hilltop the surface falls by 1 in 10."""
    for place, height in HEIGHTS.items():
        assert HILL.height(*place) == pytest.approx(height), place
    assert HILL.distance((0.05, 0.01, 0.105)) == pytest.approx((0.1 + 0.001) / math.sqrt(1.02), rel=1e-3)
    assert HILL.distance((0.05, 0.0, 0.004)) < 0.0
    assert LEVEL.distance((3.0, -2.0, 0.25)) == HILL.distance((3.0, -2.0, 0.25)) == 0.25 and LEVEL.reach == math.inf
    assert HILL.highest(-0.05, 0.03, -0.04, 0.06) == pytest.approx(0.01)  # a node within
    assert HILL.highest(0.02, 0.05, 0.02, 0.05) == pytest.approx(0.006)  # a corner
    assert HILL.highest(0.01, 0.04, -0.08, -0.05) == pytest.approx(0.005)  # where an edge crosses a line of the grid
    assert HILL.highest(-0.08, -0.02, 0.05, 0.07) == pytest.approx(0.005)  # and a diagonal


@settings(max_examples=30)
@given(
    edges=st.tuples(*[st.floats(-0.6, 0.6)] * 4),
    inside=st.lists(st.tuples(st.floats(0.0, 1.0), st.floats(0.0, 1.0)), min_size=20, max_size=20),
    cell=st.sampled_from([0.02, 0.033, 0.05, 0.1]),
    seed=st.integers(0, 9),
)
def test_nothing_in_a_rectangle_is_higher_than_its_highest_place(
    edges: tuple[float, ...], inside: list[tuple[float, float]], cell: float, seed: int
) -> None:
    ground = draw_ground(Terrain(roughness=(0.05, 0.05), cell=(cell, cell)), seed)
    (left, right), (back, front) = sorted(edges[:2]), sorted(edges[2:])
    highest = ground.highest(left, right, back, front)
    for share_x, share_y in inside:
        x, y = left + share_x * (right - left), back + share_y * (front - back)
        assert ground.height(x, y) <= highest + 1e-9
    assert highest <= np.max(ground.heights)


def test_plates_begin_above_high_bumps() -> None:
    robot, ground = describe_robot(), draw_ground(Terrain(roughness=(0.05, 0.05)), 0)
    lift = ground.lift(robot)
    for left, right, back, front, height in robot.undersides:
        places = [(x, y) for x in np.linspace(left, right, 60) for y in np.linspace(back, front, 60)]
        assert max(ground.height(x, y) for x, y in places) <= height + lift + 1e-9


def test_a_robot_too_wide_for_the_bumps_is_refused() -> None:
    wide = describe_robot({"hip_offset": 0.8})
    assert LEVEL.lift(wide) == 0.0
    with pytest.raises(ConfigurationError, match=r"bumps reach 0\.70 m from the start, and this robot's feet 0\.8"):
        draw_ground(ROUGH, 0).lift(wide)


@settings(max_examples=30)
@given(roughness=st.floats(1e-4, 0.05), cell=st.floats(0.02, 0.1), seed=st.integers(0, 2**32))
def test_bumps_stay_within_their_height_and_reach_far_enough(roughness: float, cell: float, seed: int) -> None:
    ground = draw_ground(Terrain(roughness=(roughness, roughness), cell=(cell, cell)), seed)
    heights = np.array(ground.heights)
    assert heights.shape[0] == heights.shape[1] and heights.shape[0] % 2 == 1
    assert 0.6 * roughness < np.abs(heights).max() <= roughness
    assert ground.cell == cell and 0.7 - cell / 2 <= ground.reach <= 0.7 + cell / 2


def test_a_seed_draws_the_same_bumps_at_any_height() -> None:
    sloping = Terrain(slope_degrees=(0.0, 9.0), friction_left=(0.2, 0.4))
    low, high = (draw_ground(replace(sloping, roughness=(height,) * 2), 7) for height in (0.01, 0.02))
    assert np.array(high.heights) == pytest.approx(2 * np.array(low.heights))
    assert replace(high, heights=low.heights) == low
    assert low.gravity == draw_ground(Terrain(slope_degrees=(0.0, 9.0)), 7).gravity
    one, other = (np.ravel(draw_ground(ROUGH, seed).heights) for seed in (1, 2))
    assert abs(np.corrcoef(one, other)[0, 1]) < 0.15


@pytest.mark.parametrize("cell", [0.02, 0.1])
def test_a_ball_lies_at_the_same_height_in_both_engines(cell: float) -> None:
    """Found by halving: within 10 um, and near where the robot would be put down."""
    for engine in ("pybullet", "mujoco"):
        need(engine)
    ground = draw_ground(Terrain(roughness=(0.015, 0.015), cell=(cell, cell)), 1)
    places = np.random.default_rng(0).uniform(-0.65, 0.65, (12, 2)).tolist()
    heights = {engine: [ball_height(engine, ground, x, y) for x, y in places] for engine in ("pybullet", "mujoco")}
    assert heights["mujoco"] == pytest.approx(heights["pybullet"], abs=1e-5)
    put_down = [ground.ball_height(x, y, RADIUS) for x, y in places]
    assert put_down == pytest.approx(heights["mujoco"], abs=2e-5 / cell)


def ball_height(engine: str, ground: Ground, x: float, y: float) -> float:
    """Height of a ball's centre at which it begins to touch the ground of an engine."""
    simulation: Any = simulator_of(engine)(describe_robot(), PHYSICS["standard"], Conditions(ground=ground))
    low, high = ground.height(x, y), 0.04
    while high - low > 5e-6:
        middle = (low + high) / 2
        low, high = (middle, high) if laboratory(engine).touches_ground(simulation, (x, y, middle)) else (low, middle)
    simulation.close()
    return high


@pytest.mark.parametrize("seed", range(2))
def test_soles_of_a_standing_robot_rest_on_the_bumps(build: BuildSimulation, seed: int) -> None:
    simulation = build(Conditions(ground=draw_ground(ROUGH, seed)))
    lowest = min(simulation.sole_height(side) for side in Side)
    assert -1e-4 < lowest < 0.001 and not any(simulation.read().pressures)
    simulation.advance()
    assert abs(simulation.torso_state().velocity[2]) < 0.15  # of a free fall, and not thrown up
    advance(simulation, 150)
    for side in Side:
        assert -0.001 < simulation.sole_height(side) < 0.0005
    assert simulation.torso_state().axis[2] > math.cos(math.radians(8.0))


def test_clearance_of_a_foot_is_that_over_its_own_ground(lab: Laboratory, build: BuildSimulation) -> None:
    step = tuple(0.02 if column < 35 else 0.0 for column in range(71))
    simulation = build(Conditions(ground=Ground(heights=(step,) * 71, cell=0.02)))
    lab.place(simulation, describe_robot().standing_height + 0.05)
    assert simulation.sole_height(Side.LEFT) == pytest.approx(0.03, abs=1e-6)
    assert simulation.sole_height(Side.RIGHT) == pytest.approx(0.05, abs=1e-6)


@pytest.mark.parametrize("slippery", list(Side))
def test_each_foot_has_the_friction_of_its_ground(lab: Laboratory, build: BuildSimulation, slippery: Side) -> None:
    terrain = Terrain(**{f"friction_{slippery}": (0.02, 0.02)})  # type: ignore[arg-type]
    simulation = build(Conditions(friction=0.9, ground=draw_ground(terrain, 0)))
    assert lab.friction_under(simulation, slippery) == {0.02}
    assert lab.friction_under(simulation, slippery.other) == {0.9}


@pytest.mark.parametrize(("uphill", "friction"), [(0.0, 0.0), (22.5, 0.05), (270.0, 0.15)])
def test_a_robot_on_ice_slides_alike_in_all_directions(build: BuildSimulation, uphill: float, friction: float) -> None:
    ice = (friction, friction)
    terrain = Terrain((12.0, 12.0), (uphill, uphill), friction_left=ice, friction_right=ice)
    simulation = build(Conditions(ground=draw_ground(terrain, 0)))
    advance(simulation, 80)
    angle = math.radians(12.0)
    expected = 0.5 * 9.81 * (math.sin(angle) - friction * math.cos(angle)) * 0.8**2
    x, y, _ = simulation.torso_state().position
    assert math.hypot(x, y) == pytest.approx(expected, rel=0.08)
    assert math.cos(math.atan2(y, x) - math.radians(uphill)) < -0.99  # downhill


def test_frictions_are_drawn_for_each_foot() -> None:
    terrain = Terrain(friction_left=(0.15, 0.3), friction_right=(1.0, 1.2))
    drawn = np.array([draw_ground(terrain, seed).frictions for seed in range(200)], dtype=float)
    assert drawn.min(axis=0) == pytest.approx((0.15, 1.0), abs=0.01)
    assert drawn.max(axis=0) == pytest.approx((0.3, 1.2), abs=0.01)
    assert abs(np.corrcoef(drawn.T)[0, 1]) < 0.2
    alone = draw_ground(Terrain(friction_left=(0.15, 0.3)), 3)
    assert alone.frictions == (drawn[3, 0], None)
    conditions = Conditions(friction=0.8, ground=alone)
    assert (conditions.friction_under(Side.LEFT), conditions.friction_under(Side.RIGHT)) == (drawn[3, 0], 0.8)


def test_impossible_ground_is_refused() -> None:
    for setting, message in (
        ({"roughness": (0.01, 0.005)}, r"terrain\.roughness .* in rising order"),
        ({"cell": 0.01}, "terrain.reach must be between 1 and 50 times terrain.cell, here 0.01 and 0.5 m, not 0.7"),
        ({"cell": 1.0}, "here 1 and 50 m, not 0.7"),
    ):
        with pytest.raises(ConfigurationError, match=message):
            Terrain(**setting)
