"""The rank replay buffer draws by the rank of the reward, and knows the best action and draws around it.

Best actions are compared with the formulas, written as plain loops.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from gymnasium import spaces
from stable_baselines3.common.utils import set_random_seed

from sarah.agents import NAF, LocalNAF, RankReplayBuffer
from sarah.agents.buffers import average_ranks

NUMBER, BOX = spaces.Box(-np.inf, np.inf, (1,)), spaces.Box(-1, 1, (2,))
Action = Sequence[float]


def fill(rewards, n_envs: int = 1, buffer_size: int = 100, **kwargs) -> RankReplayBuffer:
    """A buffer whose k-th transition has the k-th reward and carries k in its observation and action."""
    buffer = RankReplayBuffer(buffer_size, NUMBER, BOX, "cpu", n_envs, **kwargs)
    for start in range(0, len(rewards), n_envs):
        numbers = np.arange(start, start + n_envs, dtype=np.float32)
        obs, actions = numbers[:, None], np.stack([numbers, -numbers], axis=1)
        earned = np.array(rewards[start : start + n_envs])
        buffer.add(obs, obs + 0.5, actions, earned, np.ones(n_envs), [{}] * n_envs)
    return buffer


def add(buffer: RankReplayBuffer, action: Action, reward: float, number: float = 0.0) -> None:
    observation = np.full((1, 1), number)
    buffer.add(observation, observation, np.array([action]), np.array([reward]), np.ones(1), [{}])


def frequencies(buffer: RankReplayBuffer, n: int, draws: int = 100_000) -> np.ndarray:
    numbers = buffer.sample(draws).observations[:, 0].numpy().astype(int)
    return np.bincount(numbers, minlength=n) / draws


def shares(*ranks: float) -> np.ndarray:
    return np.exp(4 * np.array(ranks)) / np.exp(4 * np.array(ranks)).sum()


def test_ranks_go_from_0_to_1_and_equal_values_share_theirs() -> None:
    assert average_ranks(np.array([3.0, 1.0, 1.0, 2.0])).tolist() == pytest.approx([1.0, 1 / 6, 1 / 6, 2 / 3])
    assert average_ranks(np.array([5.0])).tolist() == [0.0]


@pytest.mark.parametrize(
    ("rewards", "kwargs", "expected"),
    [
        ([3.0, -1.0, 10.0, 3.0, 0.0, 7.0, 3.0, -8.0], {}, shares(*np.array([4, 1, 7, 4, 2, 6, 4, 0]) / 7)),
        ([2.0, np.nan, 1.0, 2.0], {}, shares(5 / 6, 0, 1 / 3, 5 / 6)),
        ([1.0] * 8, {}, [1 / 8] * 8),
        (range(8), {"temperature": 0.0}, [1 / 8] * 8),
        (range(8), {"temperature": 1e5}, [0.0] * 7 + [1.0]),
    ],
)
def test_frequencies_follow_the_formula(rewards, kwargs, expected):
    set_random_seed(0)
    found = frequencies(fill(rewards, n_envs=4, **kwargs), len(rewards))
    np.testing.assert_allclose(found, expected, atol=0.005)  # the standard error is at most 0.001


def test_transitions_stay_together():
    batch = fill(list(np.linspace(-1, 1, 12)), 3).sample(200)
    number = batch.observations[:, 0].numpy()
    assert set(number) <= set(range(12)) and len(set(number)) > 6
    np.testing.assert_array_equal(batch.next_observations[:, 0], number + 0.5)
    np.testing.assert_array_equal(batch.actions, np.stack([number, -number], axis=1))
    np.testing.assert_allclose(batch.rewards[:, 0], np.linspace(-1, 1, 12)[number.astype(int)], rtol=1e-6)
    assert batch.rewards.shape == batch.dones.shape == (200, 1)
    full = fill(list(range(12, 0, -1)), 3, buffer_size=5)  # the oldest are overwritten
    assert full.size() == 5 and set(full.sample(1000).observations[:, 0].numpy()) == {7.0, 8.0, 9.0, 10.0, 11.0}


def test_ranks_follow_additions_and_reset():
    set_random_seed(0)
    buffer = fill([0.0, 1.0])
    assert frequencies(buffer, 3)[1] > 0.9
    add(buffer, [2.0, 2.0], 9.0, number=2.0)
    assert np.argmax(frequencies(buffer, 3)) == 2
    buffer.reset()
    with pytest.raises(ValueError, match="the replay buffer is empty, so there is nothing to sample"):
        buffer.sample(4)
    add(buffer, [0.0, 0.0], -9.0)
    assert frequencies(buffer, 3)[0] == 1.0


def test_time_limits_are_not_ends():
    buffer = RankReplayBuffer(10, BOX, BOX, "cpu", n_envs=2)
    obs = np.array([[0.0, 0.0], [1.0, 1.0]], np.float32)
    buffer.add(obs, obs, obs, np.zeros(2), np.ones(2), [{"TimeLimit.truncated": True}, {}])
    batch = buffer.sample(100)
    np.testing.assert_array_equal(batch.dones[:, 0], batch.observations[:, 0])


def test_what_is_not_supported_is_refused():
    with pytest.raises(NotImplementedError, match="optimize_memory_usage"):
        fill([], optimize_memory_usage=True)
    with pytest.raises(NotImplementedError, match="doesn't support Dict observations: flatten them"):
        RankReplayBuffer(10, spaces.Dict(a=NUMBER), BOX)


def test_of_a_large_buffer_the_newest_decide():
    """Also where the oldest have been overwritten."""
    buffer = fill([], buffer_size=12_000)
    rng = np.random.default_rng(0)
    buffer.actions[:, 0], buffer.rewards[:, 0] = rng.uniform(-1, 0, (12_000, 2)), rng.normal(size=12_000)
    buffer.full, buffer.pos = True, 11_999
    assert (buffer.best_action() < 0).all()
    for _ in range(5):
        add(buffer, [0.5, 0.5], 9.0)
    np.testing.assert_array_equal(buffer.best_action(), [0.5, 0.5])


@pytest.mark.parametrize("algorithm", [NAF, LocalNAF])
def test_ranks_say_nothing_of_what_follows(algorithm):
    """So values of next observations cannot be learned from them."""
    arguments: dict[str, Any] = dict(replay_buffer_class=RankReplayBuffer, policy_kwargs={"net_arch": [8]}, gamma=0.5)
    plain: dict[str, Any] = dict(replay_buffer_kwargs={"temperature": 0.0})
    with pytest.raises(ValueError, match=r"^gamma must be 0 with a RankReplayBuffer of temperature 4, not 0.5: .*$"):
        algorithm("MlpPolicy", "Pendulum-v1", **arguments)
    if algorithm is LocalNAF:
        with pytest.raises(ValueError, match=r"^gamma must be 0 with elite_share above 0, not 0.5: .*$"):
            LocalNAF("MlpPolicy", "Pendulum-v1", **arguments, **plain)
        plain["elite_share"] = 0.0
    assert algorithm("MlpPolicy", "Pendulum-v1", **arguments, **plain).gamma == 0.5
    assert LocalNAF("MlpPolicy", "Pendulum-v1", policy_kwargs={"net_arch": [8]}).gamma == 0.0


def test_what_is_far_away_is_no_error_of_numpy():
    buffer = fill([1.0, 2.0, 3.0], temperature=1000.0)  # with actions far from each other
    with np.errstate(all="raise"):
        buffer.best_action()
        buffer.draw_near_best(0.01, 16)
        buffer.sample(4)


def tried(actions: Sequence[Action], rewards: Sequence[float]) -> RankReplayBuffer:
    buffer = RankReplayBuffer(1000, NUMBER, spaces.Box(-1, 1, (len(actions[0]),)), "cpu")
    for action, reward in zip(actions, rewards, strict=True):
        add(buffer, action, reward)
    return buffer


def random_buffer(seed: int) -> tuple[RankReplayBuffer, list[list[float]], list[float]]:
    """40 transitions, or a few that are far from each other, and their actions and rewards, nearly all negative."""
    rng = np.random.default_rng(seed)
    number, dim = (40, 2) if seed % 2 else (6, 4)
    buffer = tried(rng.uniform(-1, 1, (number, dim)).tolist(), rng.normal(-3.0, 1.0, number).tolist())
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
    assert tried([*among_neighbours, *lonely, *worthless], rewards).best_action() == pytest.approx((0.05, 0.0))


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
