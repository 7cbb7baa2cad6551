"""The learner that recognises its robot, on robots that are formulas."""

import pytest
from known_robots import LOGS, KnownRobot, top

from sarah.errors import ConfigurationError
from sarah.operation.settings import SHIPPED
from sarah.recognition.learning import learn
from sarah.recognition.recognition import Kind, Recognition
from sarah.training.recognise import operate_recognised

NEAREST = learn(LOGS)


@pytest.mark.parametrize("kind", ["nearest", "classes", "network", "model"])
def test_a_known_robot_gets_its_parameters_after_one_window(kind: Kind) -> None:
    robot = KnownRobot(1.0)
    operate_recognised(robot, SHIPPED, 0, learn(LOGS, kind))
    assert robot.seen[0].parameters == SHIPPED and robot.seen[1].parameters == top(1.0)
    assert robot.mean_reward(0.2) > 0.9


def test_nothing_is_pushed_where_the_shipped_ones_are_good() -> None:
    robot = KnownRobot(0.0)
    operate_recognised(robot, SHIPPED, 0, NEAREST)
    assert not {top(-1.0), top(1.0)} & {window.parameters for window in robot.seen}
    assert robot.mean_reward() > 0.92


@pytest.mark.parametrize("recognition", [NEAREST, Recognition()], ids=["of logs", "empty"])
def test_an_unknown_robot_learns_on_from_the_shipped_ones(recognition: Recognition) -> None:
    robot = KnownRobot(6.0)
    operate_recognised(robot, SHIPPED, 0, recognition)
    assert not {top(-1.0), top(1.0)} & {window.parameters for window in robot.seen}
    assert len({window.parameters for window in robot.seen}) > 3


def test_a_set_that_is_worth_less_than_believed_goes() -> None:
    robot = KnownRobot(1.0, best=0.3)
    operate_recognised(robot, SHIPPED, 0, NEAREST)
    assert robot.seen[1].parameters == top(1.0)
    assert sum(window.parameters == top(1.0) for window in robot.seen) <= 2


def test_a_robot_that_changes_is_recognised_anew() -> None:
    robot = KnownRobot(-1.0, 4.0, then=1.0, change=2.0)
    operate_recognised(robot, SHIPPED, 0, NEAREST)
    first = next(window for window in robot.seen if window.parameters == top(1.0))
    assert 120.0 <= first.begin <= 120.0 + 5 * 6.0
    assert robot.mean_reward(2.6) > 0.9


@pytest.mark.parametrize("fall", [None, 1.8])
def test_a_robot_that_the_shipped_ones_suited_is_recognised_after_one_window(fall: float | None) -> None:
    robot = KnownRobot(0.0, 4.0, then=1.0, change=2.5, fall=fall)
    operate_recognised(robot, SHIPPED, 0, NEAREST)
    after = [window.parameters for window in robot.seen if window.begin >= 150.0]
    assert top(1.0) in after[:3]


def test_a_robot_that_falls_in_its_first_window_is_felt_again() -> None:
    robot = KnownRobot(1.0, fall=0.0)
    operate_recognised(robot, SHIPPED, 0, NEAREST)
    assert [window.parameters for window in robot.seen[:3]] == [SHIPPED, SHIPPED, top(1.0)]


def test_another_robot_than_those_of_the_logs_is_refused() -> None:
    robot = KnownRobot(0.0)
    robot.config = type(robot.config)(measure_seconds=5.0)
    with pytest.raises(ConfigurationError, match=r"the robot has measure_seconds 5\.0, not 4\.0"):
        operate_recognised(robot, SHIPPED, 0, NEAREST)
    with pytest.raises(ConfigurationError, match="begins with the parameters that robots are recognised with"):
        operate_recognised(KnownRobot(0.0), top(1.0), 0, NEAREST)
