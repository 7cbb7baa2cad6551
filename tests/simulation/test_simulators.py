"""Physics facts about the robot standing, falling, pushed, mirrored and moved by its actuators, in each engine."""

import math

import numpy as np
import pytest
from laboratory import NEEDS_PYBULLET, BuildSimulation, Laboratory, advance

from sarah.robot.description import ANKLE_JOINTS, GROUPS, PLATES, describe_robot
from sarah.robot.reading import ACTUATED_JOINTS, GRAVITY, Side
from sarah.simulation.build import simulator_of
from sarah.simulation.physics import PHYSICS, PyBulletPhysics
from sarah.simulation.pybullet_simulator import PyBulletSimulator
from sarah.simulation.pybullet_world import pybullet
from sarah.simulation.randomisation import LINKS, NOMINAL, Conditions
from sarah.simulation.simulator import Simulator, rotate_to_body

SECOND = PHYSICS["standard"].control_rate


def momentum(lab: Laboratory, simulation: Simulator) -> np.ndarray:
    return sum((lab.mass(simulation, link) * lab.link_velocity(simulation, link) for link in LINKS), np.zeros(3))


def test_engine_weighs_the_robot_as_it_is_described(lab: Laboratory, build: BuildSimulation) -> None:
    factors = {link: 1.0 + 0.01 * index for index, link in enumerate(LINKS)}
    nominal, changed = build(), build(Conditions(mass_factors=factors, friction=0.8))
    for simulation, factor in ((nominal, dict.fromkeys(LINKS, 1.0)), (changed, factors)):
        for links in GROUPS.values():
            assert sum(lab.mass(simulation, link) / factor[link] for link in links) == pytest.approx(10.0)
    assert all(lab.friction_under(changed, side) == {0.8} for side in Side)


@pytest.mark.parametrize(("axis", "heavier", "sign"), [(0, (2, 3), 1.0), (1, (0, 2), -1.0)])
def test_pads_carry_more_where_the_torsos_mass_is_offset_to(
    build: BuildSimulation, axis: int, heavier: tuple[int, int], sign: float
) -> None:
    """20 mm of 8 kg are a moment of 1.57 Nm, which the pads carry alone along the feet, 0.28 m apart.

    To the side, the feet are 0.26 m apart; but each foot is wide enough to carry some itself.
    """
    shifts = []
    for metres in (0.0, sign * 0.02):
        simulation, loads = build(Conditions(mass_offset=(metres * (axis == 0), metres * (axis == 1), 0.0))), []
        for tick in range(3 * SECOND):
            simulation.advance()
            if tick >= SECOND:
                loads.append(simulation.read().pressures)
        pads = np.array(loads).mean(axis=0)
        shifts.append(2.0 * pads[list(heavier)].sum() - pads.sum())
        assert simulation.torso_state().position == pytest.approx((0.0, 0.0, 0.84), abs=0.005)
    shift, moment = sign * (shifts[1] - shifts[0]), 2 * 8.0 * 0.02 * GRAVITY
    assert 1.0 < shift < moment / 0.26 if axis == 0 else shift == pytest.approx(moment / 0.28, rel=0.1)


def test_state_is_that_of_the_torsos_frame_wherever_its_mass_is(lab: Laboratory, build: BuildSimulation) -> None:
    offset = (0.02, -0.03, 0.01)
    for conditions in (NOMINAL, Conditions(mass_offset=offset)):
        simulation = build(conditions, PyBulletPhysics(rate=2000))
        lab.place(simulation, roll=0.3, pitch=-0.2)
        torso = simulation.torso_state()
        hip = rotate_to_body(torso.orientation, tuple(lab.link_position(simulation, "left_hip") - torso.position))
        assert hip == pytest.approx((-0.13, 0.0, -0.17), abs=1e-6)
        lab.turn(simulation, (1.0, 2.0, 2.0))
        simulation.advance()
        before = simulation.torso_state()
        simulation.advance()
        after = simulation.torso_state()
        moved, speeds = np.subtract(after.position, before.position), np.add(before.velocity, after.velocity)
        assert moved * SECOND == pytest.approx(speeds / 2.0, abs=0.004)


def test_pads_stop_the_plates(lab: Laboratory, build: BuildSimulation) -> None:
    def largest_ankle_angle(simulation: Simulator) -> float:
        largest = 0.0
        for _ in range(SECOND):
            simulation.advance()
            largest = max(largest, *simulation.joint_positions(ANKLE_JOINTS))
        return largest

    without_pads = build()
    lab.remove_pads(without_pads)
    assert largest_ankle_angle(build()) < 0.02
    assert largest_ankle_angle(without_pads) > 0.1


def test_ankles_are_damped_alike(lab: Laboratory, build: BuildSimulation) -> None:
    """In the air a plate that turns at 1 rad/s comes to rest within 5.0 (PyBullet) or 5.1 mrad (MuJoCo)."""
    simulation = build(physics=PyBulletPhysics(rate=2000, added_plate_inertia=0.0))
    lab.place(simulation)
    lab.move_joint(simulation, "left_hindfoot", -0.09, 1.0)
    advance(simulation, 10)
    assert simulation.joint_positions(("left_hindfoot",))[0] == pytest.approx(-0.085, abs=0.0005)


def test_mirrored_push_gives_mirrored_motion(build: BuildSimulation) -> None:
    """The solver treats the contacts in turn: measured within 7 % of the motion, with steps as fine as here."""
    physics = PyBulletPhysics(rate=2000, solver_iterations=200)
    right, left = build(physics=physics), build(physics=physics)
    deviation, largest = 0.0, 0.0
    for tick in range(SECOND // 3):
        if tick < 10:
            right.push((200.0, 0.0, 0.0))
            left.push((-200.0, 0.0, 0.0))
        right.advance()
        left.advance()
        (x_right, *others_right), (x_left, *others_left) = (s.torso_state().position for s in (right, left))
        largest = max(largest, x_right)
        deviation = max(deviation, abs(x_right + x_left), *np.abs(np.subtract(others_right, others_left)))
    assert largest > 0.003
    assert deviation < 0.1 * largest


def test_inertial_sensors_read_in_the_torsos_frame(lab: Laboratory, build: BuildSimulation) -> None:
    """At rest, turned by a positive angle about y (to the right) or about x (backward)."""
    simulation, angle = build(), 0.1
    g_sin, g_cos = GRAVITY * math.sin(angle), GRAVITY * math.cos(angle)
    lab.place(simulation, roll=angle)
    assert simulation.read().acceleration == pytest.approx((-g_sin, 0.0, g_cos), abs=1e-6)
    lab.place(simulation, pitch=angle)
    assert simulation.read().acceleration == pytest.approx((0.0, g_sin, g_cos), abs=1e-6)
    lab.place(simulation, roll=math.pi / 2)
    lab.turn(simulation, (0.7, 0.4, -0.2))
    # Turned by 90 degrees about y, the torso's x axis points down and its z axis to the right.
    assert simulation.read().angular_rate == pytest.approx((0.2, 0.4, 0.7), abs=1e-9)


@pytest.mark.parametrize(("physics", "force"), [("standard", (0.0, -50.0, 0.0)), ("reference", (30.0, 40.0, 10.0))])
def test_push_delivers_force_times_duration(
    lab: Laboratory, build: BuildSimulation, physics: str, force: tuple[float, float, float]
) -> None:
    simulation = build(physics=PHYSICS[physics])
    lab.place(simulation)
    ticks = 15
    before = momentum(lab, simulation)
    for _ in range(ticks):
        simulation.push(force)
        simulation.advance()
    duration = ticks / SECOND
    gained = momentum(lab, simulation) - before + np.array((0.0, 0.0, 30.0 * GRAVITY * duration))
    impulse = np.array(force) * duration
    size = np.linalg.norm(impulse)
    assert gained @ impulse / size == pytest.approx(size, rel=0.002)
    assert np.linalg.norm(gained - impulse) < 2.4 / PHYSICS[physics].rate * size
    after_push = momentum(lab, simulation)[:2]
    simulation.advance()  # a push lasts one tick
    assert momentum(lab, simulation)[:2] == pytest.approx(after_push, rel=1e-4, abs=1e-3)


@NEEDS_PYBULLET
def test_plates_have_added_inertia_while_they_press_on_pads() -> None:
    """About the hinge only, and on the masses of this episode; whatever the targets of the legs are."""
    conditions, carried = Conditions(mass_factors=dict.fromkeys(LINKS, 1.05)), set()
    plain, simulation = (
        PyBulletSimulator(describe_robot(), PyBulletPhysics(added_plate_inertia=added), conditions)
        for added in (0.0, 0.005)
    )

    def inertias(simulation: PyBulletSimulator) -> np.ndarray:
        links = [simulation.links[f"{side}_{plate}"] for side in Side for plate in PLATES]
        return np.array([pybullet.getDynamicsInfo(simulation.body, link, simulation.client)[2] for link in links])

    for tick in range(3 * SECOND // 2):
        simulation.set_targets((0.0, 0.0, 0.0, 0.0, 0.03 if tick > SECOND else 0.0, 0.0))
        simulation.advance()
        presses = np.array(simulation.read().pressures) > 0.0
        carried.add(tuple(presses))
        assert inertias(simulation) == pytest.approx(inertias(plain) + np.outer(presses, (0.005, 0.0, 0.0)))
    assert (True,) * 4 in carried and any(not left_fore for left_fore, *_ in carried)
    plain.close()
    simulation.close()


def test_servos_follow_their_targets_at_their_bandwidth(lab: Laboratory, build: BuildSimulation) -> None:
    simulation = build()
    lab.place(simulation)
    simulation.set_targets((0.0, 0.0, 0.0, 0.0, 0.005, 0.0))
    advance(simulation, 2)
    assert simulation.joint_positions(ACTUATED_JOINTS)[4] == pytest.approx(0.005 * (1 - math.exp(-1.0)), rel=0.05)
    advance(simulation, SECOND // 2)
    assert simulation.joint_positions(ACTUATED_JOINTS)[4] == pytest.approx(0.005, abs=1e-5)


def test_retracting_a_leg_lifts_its_sole(lab: Laboratory, build: BuildSimulation) -> None:
    simulation = build()
    assert [simulation.sole_height(side) for side in Side] == pytest.approx([0.0, 0.0], abs=1e-9)
    lab.place(simulation, height=describe_robot().standing_height + 1.0)
    simulation.set_targets((0.0, 0.0, 0.0, 0.0, 0.05, 0.0))
    advance(simulation, 20)
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
        advance(simulation, ticks)
        torso = simulation.torso_state()  # which turns too in the air
        offsets = [lab.link_position(simulation, f"{name.split('_')[0]}_shank") - torso.position for name in joints]
        moved.append([direction * rotate_to_body(torso.orientation, tuple(offset))[axis] for offset in offsets])
    assert all(now - then > 0.03 for then, now in zip(*moved, strict=True))


def test_standing_legs_push_with_the_weight_that_they_carry(build: BuildSimulation) -> None:
    """Each leg's actuator carries half of torso, hips and thighs, 20 kg."""
    simulation = build(physics=PyBulletPhysics(rate=1000, solver_iterations=50))
    advance(simulation, 3 * SECOND // 2)
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
