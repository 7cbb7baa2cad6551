"""What is said of a session whose robot was recognised."""

from known_robots import LOGS, KnownRobot, top

from sarah.operation.settings import SHIPPED
from sarah.operation.window import Window
from sarah.recognition.learning import learn
from sarah.recognition.summary import known_set_run, likeness
from sarah.robot.scale import Scale

NEAREST = learn(LOGS)
OTHERS = (*SHIPPED[:-1], SHIPPED[-1] / 2.0)


def windows(kind: float, *sets: tuple[float, ...], fall: float | None = None) -> list[Window]:
    """Windows of a robot of a kind."""
    robot = KnownRobot(kind, fall=fall)
    return [robot.run(parameters) for parameters in sets]


def test_it_says_what_the_robot_was_like_at_first() -> None:
    assert likeness(NEAREST, windows(1.0, SHIPPED), Scale()) == 'most like "kind 1", and then "kind 0"'
    assert likeness(NEAREST, windows(6.0, SHIPPED), Scale()) == "unlike all 3 known kinds"
    fell = windows(-1.0, SHIPPED, SHIPPED, fall=0.0)
    assert fell[0].fell and likeness(NEAREST, fell, Scale()).startswith('most like "kind -1"')


def test_it_says_when_a_known_set_ran_and_whether_it_stayed() -> None:
    its = windows(1.0, SHIPPED, top(1.0), OTHERS)
    assert known_set_run(NEAREST, its, top(1.0)) == "first in window 1, and the robot is left with it"
    assert known_set_run(NEAREST, its, top(-1.0)) == "first in window 1, and the robot is left with another known one"
    assert known_set_run(NEAREST, its, OTHERS) == "first in window 1, and the robot is left with others"
    assert known_set_run(NEAREST, its[:1], SHIPPED).startswith("none ran")
