"""The push: what is drawn of it, how long it lasts, what it does."""

import numpy as np
import pytest
from laboratory import NoPhysics

from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.episode import Episode, simulate
from sarah.episode.push import Push, draw_push
from sarah.episode.result import EpisodeResult
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.robot.reading import Vector
from sarah.simulation.randomisation import Randomisation


def test_hard_push_throws_the_robot_over_and_a_soft_one_does_not() -> None:
    def pushed(newtons: float) -> EpisodeResult:
        push = Push(newtons=(newtons, newtons), degrees=(90.0, 90.0), at_seconds=(2.0, 2.0))
        config = BalanceConfig(push=push, time_limit=5.0, randomisation=Randomisation(enabled=False))
        return simulate(EpisodeSpec((1.0, 0.0, 1.0, 0.0), 0, "balance", config))

    assert pushed(40.0).survived
    thrown = pushed(300.0)
    assert thrown.termination == "left_box" and thrown.final_position[1] > 0.2
    assert 2.15 < thrown.duration < 3.0


def test_push_is_the_only_difference_between_forces() -> None:
    """The force changes neither direction nor time of the push, nor the episode's other draws."""
    soft, hard = (draw_push(Push(newtons=(newtons, newtons)), seed=5) for newtons in (50.0, 100.0))
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


def test_balance_without_v_and_without_a_push_steps_as_in_the_first_training() -> None:
    config = BalanceConfig(push=Push(newtons=(0.0, 0.0)), time_limit=4.0, stepping=PAPER_STEPPING)
    balance = simulate(EpisodeSpec((0.0,) * 4, 1, "balance", config))
    assert balance == simulate(EpisodeSpec(PAPER_STEPPING, 1, config=EpisodeConfig(time_limit=4.0)))
