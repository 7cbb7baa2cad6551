"""The robot that goes on: windows, falls, changes and pushes; and the displacement that its legs tell."""

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any

import pytest
from laboratory import NEEDS_PYBULLET
from operated import quick

from sarah import BalanceConfig, Push, PushedConfig
from sarah.errors import ConfigurationError, DescriptionError
from sarah.operation.odometry import LegOdometry
from sarah.operation.robot_in_operation import RobotInOperation
from sarah.operation.settings import SHIPPED, Change, OperationConfig
from sarah.operation.window import FELT, Window
from sarah.operation.window_record import FeltRecord
from sarah.robot.description import describe_robot
from sarah.robot.reading import STANDING, SensorReading

STANDS = (0.0, 2.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0)
"""Parameters with which the robot hardly steps: it waits for a tilt that does not come."""
KICKED = {"push": {"newtons": 400.0, "duration": 0.3}}
SLOPE = {"terrain": {"slope_degrees": 5.0}}


def run_all(config: OperationConfig, seed: int = 0, parameters: tuple[float, ...] = SHIPPED) -> list[Window]:
    robot = RobotInOperation(config, seed)
    windows = []
    while not robot.is_over:
        windows.append(robot.run(parameters))
    robot.close()
    return windows


def load(window: Window) -> float:
    felt = dict(zip(FELT, window.felt, strict=True))
    return felt["left_load"] + felt["right_load"]


def test_windows_follow_without_gaps_and_come_again() -> None:
    windows = run_all(quick(minutes=0.15))
    assert windows == run_all(quick(minutes=0.15)) != run_all(quick(minutes=0.15), seed=1)
    assert [window.index for window in windows] == list(range(len(windows)))
    assert windows[0].begin == 0.0 and windows[0].seconds == 2.0  # of which it stands for one
    assert all(after.begin == before.end for before, after in pairwise(windows))
    assert windows[-2].end < 9.0 <= windows[-1].end


def test_a_robot_in_longer_operation_looks_to_the_next_end() -> None:
    """As it did before: whoever chooses parameters by the time that is left chooses the same ones again."""
    config = quick(minutes=0.2)
    robots = [RobotInOperation(settings, 0) for settings in (config, config.extended_to(0.3))]
    (window, *_) = windows = run_all(config)
    assert window.seconds == 2.0
    for window in windows:
        assert robots[0].windows_left == robots[1].windows_left
        for robot in robots:
            robot.skip(window)
    assert robots[0].is_over and robots[0].windows_left == 0.0
    assert not robots[1].is_over and robots[1].windows_left == 6.0


def test_only_what_comes_after_settling_is_measured() -> None:
    record = FeltRecord(describe_robot().standing_height, PushedConfig(), settle=2, measure=3)
    for a_x in (9.0, 9.0, 1.0, 2.0, 3.0):
        record.sensed(STANDING._replace(acceleration=(a_x, 0.0, 9.81)), (0.1,) * 6)
        record.judge()
    felt = dict(zip(FELT, record.felt(), strict=True))
    assert (felt["a_x_mean"], felt["length_lag"]) == (2.0, 0.1)


@NEEDS_PYBULLET
def test_a_window_that_steps_is_worth_more_than_one_that_stands() -> None:
    stepping, standing = (run_all(OperationConfig(minutes=0.2), parameters=chosen)[-1] for chosen in (SHIPPED, STANDS))
    for reward in ("score", "observed_reward"):
        assert getattr(stepping, reward) > 0.85 and getattr(standing, reward) < 0.1
    felt = dict(zip(FELT, stepping.felt, strict=True))
    assert felt["a_z_mean"] == pytest.approx(9.81, abs=0.4)
    assert felt["left_load"] + felt["right_load"] == pytest.approx(30.0 * 9.81, rel=0.25)
    assert 0.0 < felt["length_lag"] < 0.02 and 0.0 < felt["abduction_lag"] < 0.1
    assert felt["steps_per_second"] == pytest.approx(3.0, abs=0.6)
    assert felt["shift_seconds"] + felt["lift_seconds"] + felt["land_seconds"] == pytest.approx(1.0 / 3.0, abs=0.1)


def test_a_fall_costs_time_and_the_next_window_begins_standing() -> None:
    windows = run_all(quick(minutes=0.25, robot=KICKED, push_seconds=6.0))
    fallen = next(index for index, window in enumerate(windows) if window.fell)
    window, after, next_but_one = windows[fallen : fallen + 3]
    assert 2.0 < window.seconds < 2.0 + 1.0  # the fall's two, and what it ran before
    assert after.begin == window.end
    assert (after.seconds, next_but_one.seconds) == (2.0, 1.0)  # it stands for one, and runs for one


@NEEDS_PYBULLET
def test_after_a_fall_the_robot_is_the_same_with_other_noise() -> None:
    robot = RobotInOperation(quick(minutes=1.0, robot={**KICKED, "payload": 3.0}), 0)
    first = robot.run(SHIPPED)
    while not robot.run(SHIPPED).fell:
        pass
    again = robot.run(SHIPPED)
    robot.close()
    assert again.felt != first.felt
    assert load(first) == pytest.approx(load(again), rel=0.15)


def test_a_change_holds_from_the_next_window_and_standing() -> None:
    config = quick(minutes=0.2, changes=(Change(0.1, {"payload": 20.0}),))
    changed, unchanged = run_all(config), run_all(replace(config, changes=()))
    at = next(index for index, window in enumerate(changed) if window.changes)
    assert changed[:at] == unchanged[:at]
    assert changed[at].begin >= 6.0 and changed[at].seconds == pytest.approx(2.0, abs=0.5)
    assert load(changed[-1]) > 1.3 * load(unchanged[-1])


def test_pushes_come_at_their_interval() -> None:
    pushed, unpushed = (run_all(quick(minutes=0.2, robot={"push": {"newtons": force}})) for force in (60.0, 0.0))
    first = next(index for index, (one, other) in enumerate(zip(pushed, unpushed, strict=False)) if one != other)
    assert pushed[first].begin <= 4.0 < pushed[first].end
    assert OperationConfig().robot.push == Push(newtons=(0.0, 50.0))


def test_known_windows_are_skipped_and_change_nothing() -> None:
    config = quick(minutes=0.3, robot=KICKED, changes=(Change(0.15, SLOPE),))
    whole = run_all(config)
    assert any(window.fell for window in whole) and whole[-1].changes == 1
    for known in range(len(whole)):
        robot = RobotInOperation(config, 0)
        for window in whole[:known]:
            robot.skip(window)
        assert robot.run(SHIPPED) == whole[known]
        robot.close()


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        (dict(changes=(Change(3.0, {}), Change(1.0, {}))), "changes must be in the order of time"),
        (dict(changes=(Change(30.0, {}),)), "changes must be between 0 and 10 min"),
        (dict(changes=(Change(3.0, {"pay_load": 2.0}),)), "unknown key 'pay_load', did you mean 'payload'?"),
        (dict(changes=(Change(3.0, {"payload": -2.0}),)), "payload must be between 0 and 100 kg, not -2.0"),
        (dict(changes=(Change(3.0, {"time_limit": 5.0}),)), "time_limit has no effect in an operation"),
        (dict(changes=(Change(3.0, {"push": {"at_seconds": 2.0}}),)), "push.at_seconds has no effect in an operation"),
        (dict(robot=BalanceConfig()), "robot must be a PushedConfig, not a BalanceConfig"),
        (dict(changes=(Change(3.0, {"terrain": {"roughness": 0.01}}),)), "terrain.roughness must be 0"),
    ],
)
def test_impossible_operations_are_refused(settings: dict[str, Any], words: str) -> None:
    with pytest.raises(ConfigurationError, match=words.split("(")[0].replace("?", r"\?")):
        OperationConfig(**settings)


def test_a_change_of_one_dimension_leaves_the_others_and_fits() -> None:
    changes = (Change(0.05, {"dimensions": {"torso_width": 0.3}}), Change(0.06, {"dimensions": {"thigh_length": 0.34}}))
    config = quick(robot={"dimensions": {"hinge_height": 0.04}}, changes=changes)
    assert config.robot_after(2).dimensions == {"hinge_height": 0.04, "torso_width": 0.3, "thigh_length": 0.34}
    with pytest.raises(DescriptionError, match="foot plates reach the floor"):
        quick(changes=(Change(0.05, {"dimensions": {"hinge_height": 0.005}}),))  # which cannot be built


def test_parameters_out_of_their_box_are_refused() -> None:
    robot, rest = RobotInOperation(quick(), 0), SHIPPED[1:]
    for parameters in ((), SHIPPED[:5], (*SHIPPED[:8], 2.5), (math.nan, *rest), (True, *rest), "abcdefghi", None):
        with pytest.raises(ConfigurationError, match=r"parameter"):
            robot.run(parameters)  # type: ignore[arg-type]


@NEEDS_PYBULLET
def test_a_supervised_robot_that_stopped_steps_in_another_window() -> None:
    robot = RobotInOperation(quick(robot={"supervisor": {"enabled": True, "stepless_seconds": 0.8}}), 0)
    never, rate = (2.0,) * 5 + (0.0,) * 4, FELT.index("steps_per_second")
    found = [robot.run(parameters).felt[rate] for parameters in (never, never, SHIPPED, SHIPPED)]
    robot.close()
    assert found == [0.0, 0.0, 2.0, 3.0]


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
