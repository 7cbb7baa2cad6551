"""The learners of a session, and the one that recognises its robot, on robots that are formulas."""

import dataclasses
import math
from collections.abc import Callable

import numpy as np
import pytest
from known_robots import LOGS, KnownRobot, felt, logged, top
from operated import START, FormulaRobot

from sarah.errors import ConfigurationError
from sarah.operation.settings import BOX, SHIPPED, Parameters
from sarah.operation.window import Window
from sarah.recognition.learning import learn
from sarah.recognition.recognition import Kind, Recognition
from sarah.training.careful import CarefulSearch
from sarah.training.recognise import operate_recognised
from sarah.training.session_learners import LEARNERS

TOP = START + 0.15 * np.array([1, -1, 1, 1, -1, 1, -1, 1, -1])

Reward = Callable[[np.ndarray, float], float]


def hill(shares: np.ndarray, minute: float = 0.0) -> float:
    """A hill whose top is a third away, where the robot begins at 0.66."""
    return float(0.9 - 1.2 * np.square(shares - TOP).sum())


def cliff(shares: np.ndarray, minute: float = 0.0) -> float:
    """The robot begins at the top, and falls where the first parameter is a tenth higher."""
    return 0.0 if shares[0] > START[0] + 0.1 else float(0.9 - np.square(shares - START).sum())


def operated(learner: str, reward: Reward, seed: int = 0, minutes: float = 10.0) -> FormulaRobot:
    robot = FormulaRobot(reward, minutes)
    left = LEARNERS[learner](robot, SHIPPED, seed)
    assert BOX.checked(left) == left
    assert robot.is_over
    return robot


ENOUGH = hill(START) + 0.6 * (0.9 - hill(START))


@pytest.mark.parametrize("seed", range(2))
def test_the_careful_learner_climbs_and_does_not_fall(seed: int) -> None:
    robot = operated("careful", hill, seed)
    assert robot.falls == 0 and robot.mean_reward(8.0) > ENOUGH


def test_it_loses_little_on_a_top_and_random_search_much() -> None:
    robot, random = operated("careful", cliff), operated("random", cliff)
    assert robot.falls <= 1 and robot.mean_reward() > 0.9 - 0.05
    assert random.falls > 5 * max(1, robot.falls) and random.mean_reward() < robot.mean_reward()


def test_it_begins_again_when_the_robot_has_changed() -> None:
    def changing(shares: np.ndarray, minute: float) -> float:
        return hill(shares) if minute < 5.0 else float(0.9 - 1.2 * np.square(shares - 2.0 * START + TOP).sum())

    robot = operated("careful", changing)
    lost = robot.mean_reward(4.0, 5.0) - robot.mean_reward(5.0, 5.5)
    assert lost > 0.2
    assert robot.mean_reward(8.0, 10.0) > robot.mean_reward(5.0, 5.5) + 0.5 * lost


def test_it_does_not_take_chance_for_a_change() -> None:
    """Windows of weak servos differ by more than the process knows: it must not begin again, and drift downhill."""
    robot = FormulaRobot(hill, minutes=30.0, noise=0.15)
    left = LEARNERS["careful"](robot, SHIPPED, 1)
    assert hill(np.array(BOX.shares(left))) > hill(START)


def test_it_follows_a_robot_that_changes_slowly() -> None:
    """Each window falls short by little, but one after the other does."""

    def drifting(shares: np.ndarray, minute: float) -> float:
        share = min(max((minute - 5.0) / 15.0, 0.0), 1.0)
        return float(0.9 - 1.2 * np.square(shares - START - (1.0 - 2.0 * share) * (TOP - START)).sum())

    robot = operated("careful", drifting, minutes=25.0)
    kept = drifting(TOP, 25.0)
    assert robot.mean_reward(20.0) > kept + 0.6 * (0.9 - kept)


@pytest.mark.parametrize("seed", range(3))
def test_where_little_is_known_trials_are_small(seed: int) -> None:
    """A trial may lose a tenth, and nobody knows yet how steep it is."""
    search = CarefulSearch(BOX, seed, SHIPPED)
    search.tell(search.ask(), 0.8)
    assert 0.0 < math.dist(BOX.shares(search.ask()), START) < 0.1


def test_in_the_last_window_there_is_nothing_to_gain_by_a_trial() -> None:
    last, before = (CarefulSearch(BOX, 0, SHIPPED) for _ in range(2))
    for search, left in ((last, 1.0), (before, 2.0)):
        for _ in range(8):
            search.tell(asked := search.ask(left), 0.8)
        assert (asked == SHIPPED) == (search is last)


class Stumbling(FormulaRobot):
    """A robot that stumbles once a minute, whatever its parameters are."""

    def run(self, parameters: Parameters) -> Window:
        window = super().run(parameters)
        stumbles = window.index % 10 == 9 and not window.fell
        return dataclasses.replace(window, observed_reward=0.3) if stumbles else window


def test_a_single_bad_window_is_no_change() -> None:
    robots = [Stumbling(hill) for _ in range(2)]
    for seed, robot in enumerate(robots):
        LEARNERS["careful"](robot, SHIPPED, seed)
    assert np.mean([robot.mean_reward(8.0) for robot in robots]) > ENOUGH


@pytest.mark.parametrize("learner", ["cma-es", "naf"])
def test_the_others_climb_too(learner: str) -> None:
    assert operated(learner, hill).mean_reward(8.0) > hill(START) + 0.03


@pytest.mark.parametrize("learner", LEARNERS)
def test_learners_begin_as_given_and_do_not_see_the_score(learner: str) -> None:
    """Only the robot's own reward: a score from another world changes nothing. Without a learner nothing changes."""

    class Blind(FormulaRobot):
        def run(self, parameters: Parameters) -> Window:
            return dataclasses.replace(super().run(parameters), score=-1.0)

    seen, blind = FormulaRobot(hill, 1.5), Blind(hill, 1.5)
    assert LEARNERS[learner](seen, SHIPPED, 0) == LEARNERS[learner](blind, SHIPPED, 0)
    assert seen.seen[0].parameters == SHIPPED
    assert ({window.parameters for window in seen.seen} == {SHIPPED}) == (learner == "none")


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


def test_after_one_bad_set_nothing_is_pushed_where_the_shipped_ones_are_good() -> None:
    """Also where robots that feel like this one did badly with them."""
    random = np.random.default_rng(1)

    class Alike(KnownRobot):
        def run(self, parameters: Parameters) -> Window:
            return dataclasses.replace(super().run(parameters), felt=felt(1.0, random))

    robot = Alike(0.0)
    operate_recognised(robot, SHIPPED, 0, NEAREST)
    assert sum(window.parameters in {top(-1.0), top(1.0)} for window in robot.seen) <= 1


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


def test_what_was_learned_outlasts_bad_windows() -> None:
    """A known set is better than the mean of windows with a stumble among them, but not than the shipped one."""

    class Known(Stumbling, KnownRobot):
        pass

    robot = Known(0.4, 10.0)
    operate_recognised(robot, SHIPPED, 0, learn([logged(kind, seed) for kind in (-1.0, 0.4, 1.0) for seed in range(2)]))
    assert robot.mean_reward(8.0) > robot.mean_reward(0.0, 1.0) + 0.02


@pytest.mark.parametrize("fall", [None, 1.8])
def test_a_robot_that_was_suited_is_recognised_after_one_window(fall: float | None) -> None:
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
