"""Servos and legs in each engine: which way, how fast and how hard they move."""

import math

import pytest
from laboratory import BuildSimulation, Laboratory

from sarah.robot.description import describe_robot
from sarah.robot.reading import ACTUATED_JOINTS, GRAVITY, Side
from sarah.simulation.build import simulator_of
from sarah.simulation.physics import PHYSICS, PyBulletPhysics
from sarah.simulation.randomisation import NOMINAL
from sarah.simulation.simulator import rotate_to_body

SECOND = PHYSICS["standard"].control_rate


def test_servos_follow_their_targets_at_their_bandwidth(lab: Laboratory, build: BuildSimulation) -> None:
    simulation = build()
    lab.place(simulation)
    simulation.set_targets((0.0, 0.0, 0.0, 0.0, 0.005, 0.0))
    for _ in range(2):
        simulation.advance()
    assert simulation.joint_positions(ACTUATED_JOINTS)[4] == pytest.approx(0.005 * (1 - math.exp(-1.0)), rel=0.05)
    for _ in range(SECOND // 2):
        simulation.advance()
    assert simulation.joint_positions(ACTUATED_JOINTS)[4] == pytest.approx(0.005, abs=1e-5)


def test_retracting_a_leg_lifts_its_sole(lab: Laboratory, build: BuildSimulation) -> None:
    simulation = build()
    assert [simulation.sole_height(side) for side in Side] == pytest.approx([0.0, 0.0], abs=1e-9)
    lab.place(simulation, height=simulation.robot.standing_height + 1.0)
    simulation.set_targets((0.0, 0.0, 0.0, 0.0, 0.05, 0.0))
    for _ in range(20):
        simulation.advance()
    assert simulation.sole_height(Side.LEFT) - simulation.sole_height(Side.RIGHT) == pytest.approx(0.05, abs=0.005)


@pytest.mark.parametrize(
    ("joints", "axis", "direction"),
    [(("left_hip_abduction", "right_hip_abduction"), 0, -1), (("left_hip_flexion",), 1, 1)],
)
def test_abduction_turns_feet_left_and_flexion_forward(
    lab: Laboratory, build: BuildSimulation, joints: tuple[str, ...], axis: int, direction: int
) -> None:
    simulation, moved = build(), []
    lab.place(simulation, 2.0)
    simulation.set_targets(tuple(0.2 if name in joints else 0.0 for name in ACTUATED_JOINTS))
    for ticks in (0, 30):
        for _ in range(ticks):
            simulation.advance()
        torso = simulation.torso_state()  # which turns too in the air
        offsets = [lab.link_position(simulation, f"{name.split('_')[0]}_shank") - torso.position for name in joints]
        moved.append([direction * rotate_to_body(torso.orientation, tuple(offset))[axis] for offset in offsets])
    assert all(now - then > 0.03 for then, now in zip(*moved, strict=True))


def test_standing_legs_push_with_the_weight_that_they_carry(build: BuildSimulation) -> None:
    """Each leg's actuator carries half of torso, hips and thighs, 20 kg."""
    simulation = build(physics=PyBulletPhysics(rate=1000, solver_iterations=50))
    for _ in range(3 * SECOND // 2):
        simulation.advance()
    speeds, efforts = simulation.actuator_motion()
    assert [-effort for effort in efforts[4:]] == pytest.approx([10.0 * GRAVITY] * 2, rel=0.05)
    assert max(map(abs, speeds)) < 0.01


@pytest.mark.parametrize("rate", [100, 1000])
def test_actuators_push_no_harder_than_they_can(lab: Laboratory, rate: int) -> None:
    weak = describe_robot({"leg_effort": 100.0})
    simulation = simulator_of(lab.engine)(weak, PyBulletPhysics(rate=rate, solver_iterations=50), NOMINAL)
    simulation.set_targets((0.0, 0.0, 0.0, 0.0, -0.05, -0.05))
    efforts = []
    for _ in range(SECOND // 5):
        simulation.advance()
        efforts.append(max(map(abs, simulation.actuator_motion()[1][4:])))
    simulation.close()
    assert max(efforts) == pytest.approx(100.0, rel=1e-3)
