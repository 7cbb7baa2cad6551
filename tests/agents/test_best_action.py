"""The best action and the draws around it, against the formulas written as plain loops."""

import math
from collections.abc import Sequence

import numpy as np
import pytest
from gymnasium import spaces
from stable_baselines3.common.utils import set_random_seed

from sarah.agents import RankReplayBuffer

BOX = spaces.Box(-1, 1, (2,))
Action = Sequence[float]


def buffer_of(actions: Sequence[Action], rewards: Sequence[float]) -> RankReplayBuffer:
    buffer = RankReplayBuffer(1000, BOX, spaces.Box(-1, 1, (len(actions[0]),)), "cpu")
    zeros = np.zeros((1, 2), np.float32)
    for action, reward in zip(actions, rewards, strict=True):
        buffer.add(zeros, zeros, np.array([action], np.float32), np.array([reward]), np.ones(1), [{}])
    return buffer


def random_buffer(seed: int) -> tuple[RankReplayBuffer, list[list[float]], list[float]]:
    """40 transitions, or a few that are far from each other, and their actions and rewards, nearly all negative."""
    rng = np.random.default_rng(seed)
    number, dim = (40, 2) if seed % 2 else (6, 4)
    buffer = buffer_of(rng.uniform(-1, 1, (number, dim)).tolist(), rng.normal(-3.0, 1.0, number).tolist())
    return buffer, buffer.actions[:number, 0].tolist(), buffer.rewards[:number, 0].tolist()


def ranks(rewards: list[float]) -> list[float]:
    """From 0, the lowest, to 1; equal ones share the mean of theirs."""
    places = [sum(other < own for other in rewards) + (rewards.count(own) - 1) / 2 for own in rewards]
    return [place / (len(rewards) - 1) for place in places]


def mean_around(place: Action, actions: list[list[float]], values: list[float], distance: float, doubt: float) -> float:
    weights = [math.exp(-(math.dist(place, action) ** 2) / (2 * distance**2)) for action in actions]
    return sum(w * value for w, value in zip(weights, values, strict=True)) / (sum(weights) + doubt)


def reflected(value: float) -> float:
    """At the bounds -1 and 1, and no further than the other one."""
    return math.copysign(1.0, value) * max(-1.0, min(abs(value), 2.0 - abs(value)))


def test_best_action_has_the_highest_mean_around_it() -> None:
    """Of ranks, over a distance of 0.15, with a quarter of a transition that is as bad as the worst."""
    for seed in range(60):
        buffer, actions, rewards = random_buffer(seed)
        means = [mean_around(action, actions, ranks(rewards), 0.15, 0.25) for action in actions]
        assert buffer.best_action().tolist() == actions[means.index(max(means))]


def test_best_action_is_among_the_100_highest_rewards() -> None:
    """99 lonely ones earn 1, the hundredth 0.99 among neighbours; the next has more of them, and comes too late."""
    lonely = [(float(n), 0.0) for n in range(2, 101)]
    among_neighbours = [(0.05, 0.0), (0.0, 0.0), (-0.05, 0.0), (-0.1, 0.0), (0.0, 0.05)]
    worthless = [(-float(n), 0.0) for n in range(2, 802)]
    rewards = [0.99, 0.98, 0.97, 0.96, 0.95, *[1.0] * 99, *[0.0] * 800]
    buffer = buffer_of([*among_neighbours, *lonely, *worthless], rewards)
    assert buffer.best_action() == pytest.approx((0.05, 0.0))


@pytest.mark.parametrize("std", [0.1, 0.21, 0.22, 0.5, 1.5])
def test_a_draw_near_the_best_has_the_highest_mean_around_it(std: float) -> None:
    """Of ranks above the mean rank, over 0.7 deviations, at least 0.15; draws are reflected at the bounds."""
    for seed in range(20):
        buffer, actions, rewards = random_buffer(seed)
        set_random_seed(seed)
        gaussian = np.random.normal(0.0, 1.0, (8, len(actions[0]))).tolist()
        set_random_seed(seed)
        best = buffer.best_action().tolist()
        draws = [[reflected(b + std * z) for b, z in zip(best, row, strict=True)] for row in gaussian]
        above_average = [rank - 0.5 for rank in ranks(rewards)]
        means = [mean_around(draw, actions, above_average, max(0.15, 0.7 * std), 0.001) for draw in draws]
        drawn = buffer.draw_near_best(std, draws=8)
        assert drawn.dtype == np.float32 and drawn.tolist() == pytest.approx(draws[means.index(max(means))], abs=1e-6)
