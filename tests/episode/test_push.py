"""The push: what is drawn of it, how long it lasts, what it does."""

import math

import numpy as np
import pytest
from laboratory import NoPhysics

from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.episode import Episode, simulate
from sarah.episode.push import NO_PUSH, SAGITTAL_DEGREES, DrawnPush, Push, draw_push, push_words
from sarah.episode.result import EpisodeResult
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.robot.reading import Vector
from sarah.simulation.randomisation import Randomisation


def test_hard_push_throws_the_robot_over_and_a_soft_one_does_not() -> None:
    def pushed(newtons: float) -> EpisodeResult:
        push = Push(newtons=(newtons, newtons), degrees=(90.0, 90.0), at_seconds=(2.0, 2.0))
        config = BalanceConfig(push=push, time_limit=4.0, randomisation=Randomisation(enabled=False))
        return simulate(EpisodeSpec((1.0, 0.0, 1.0, 0.0), 0, "balance", config))

    assert pushed(40.0).survived
    thrown = pushed(300.0)
    assert thrown.termination == "left_box" and thrown.final_position[1] > 0.2
    assert 2.15 < thrown.duration < 3.0


def test_push_is_the_only_difference_between_forces() -> None:
    for share in (0.0, 1.0):
        soft, hard = (draw_push(Push((force, force), sagittal_share=share), seed=5) for force in (50.0, 100.0))
        assert hard.begin == soft.begin
        assert hard.force == pytest.approx(tuple(2 * component for component in soft.force))


def test_pushes_cover_every_direction_force_and_time() -> None:
    pushes = [draw_push(Push(), seed) for seed in range(400)]
    newtons = [np.hypot(*push.force[:2]) for push in pushes]
    assert min(newtons) < 5.0 and 95.0 < max(newtons) <= 100.0
    quadrants = {(push.force[0] > 0, push.force[1] > 0) for push in pushes}
    assert len(quadrants) == 4 and all(push.force[2] == 0.0 for push in pushes)
    begins = [push.begin for push in pushes]
    assert 1.0 <= min(begins) < 1.1 and 3.9 < max(begins) <= 4.0


def from_right(push: DrawnPush) -> float:
    """Direction in degrees, from 0 to the right, against the clock."""
    return math.degrees(math.atan2(push.force[1], push.force[0])) % 360.0


def test_sagittal_pushes_point_within_30_degrees_of_the_y_axis() -> None:
    push = Push(newtons=(80.0, 80.0), degrees=(0.0, 0.0), sagittal_share=0.5)
    directions = [from_right(draw_push(push, seed)) for seed in range(1000)]
    forward = [d for d in directions if abs(d - 90.0) <= SAGITTAL_DEGREES]
    backward = [d for d in directions if abs(d - 270.0) <= SAGITTAL_DEGREES]
    assert len(forward) + len(backward) + directions.count(0.0) == 1000
    assert len(forward) == pytest.approx(250, abs=50) and len(backward) == pytest.approx(250, abs=50)
    for group, middle in ((forward, 90.0), (backward, 270.0)):
        assert min(group) < middle - 28.0 and max(group) > middle + 28.0


def test_a_larger_sagittal_share_turns_some_pushes_only() -> None:
    """It changes neither force nor time; and a push that is sagittal at one share is the same at a larger one."""
    some, more = ([draw_push(Push(sagittal_share=share), seed) for seed in range(200)] for share in (0.3, 0.6))
    drawn = [draw_push(Push(), seed) for seed in range(200)]
    assert [push.begin for push in some] == [push.begin for push in drawn]
    assert [math.hypot(*push.force) for push in some] == pytest.approx([math.hypot(*push.force) for push in drawn])
    for plain, first, second in zip(drawn, some, more, strict=True):
        assert first in (plain, second)


def test_push_lasts_as_long_as_it_says() -> None:
    class Pushed(NoPhysics):
        forces: list[Vector]

        def push(self, force: Vector) -> None:
            self.forces.append(force)

    Pushed.forces = []
    push = Push(newtons=(80.0, 80.0), degrees=(0.0, 0.0), at_seconds=(2.0, 2.0), duration=0.15)
    episode = Episode(BalanceConfig(push=push), 0, BALANCE, build=Pushed)
    episode.stand()
    episode.run((1.0, 0.0, 1.0, 0.0))
    assert Pushed.forces == [(80.0, 0.0, 0.0)] * 15


def test_balance_without_v_and_push_steps_as_the_first_training() -> None:
    config = BalanceConfig(push=NO_PUSH, time_limit=2.5, stepping=PAPER_STEPPING)
    balance = simulate(EpisodeSpec((0.0,) * 4, 1, "balance", config))
    assert balance == simulate(EpisodeSpec(PAPER_STEPPING, 1, config=EpisodeConfig(time_limit=2.5)))


def test_a_push_in_words() -> None:
    assert push_words((100.0, 0.0, 0.0)) == ("push of 100 N", "to its right")
    assert push_words((0.0, 0.4, 0.0)) == ("push of 0.4 N", "forward")
    assert push_words((-50.0, -50.0, 0.0)) == ("push of 71 N", "left and backward")
    assert push_words((1.0, 0.0, 8.0)) == ("push of 8.1 N", "upward")
