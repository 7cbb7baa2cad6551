"""The rank replay buffer draws by the rank of the reward, and by nothing else."""

from typing import Any

import numpy as np
import pytest
from gymnasium import spaces
from hypothesis import given, settings
from hypothesis import strategies as st
from stable_baselines3.common.utils import set_random_seed

from sarah.agents import NAF, LocalNAF, RankReplayBuffer
from sarah.agents.buffers import average_ranks, neighbourhood_means

BOX = spaces.Box(-1, 1, (2,))


def fill(rewards, n_envs: int = 1, buffer_size: int = 100, **kwargs) -> RankReplayBuffer:
    """A buffer whose k-th transition has the k-th reward and carries k in its observation and action."""
    buffer = RankReplayBuffer(buffer_size, spaces.Box(-np.inf, np.inf, (1,)), BOX, "cpu", n_envs, **kwargs)
    for start in range(0, len(rewards), n_envs):
        numbers = np.arange(start, start + n_envs, dtype=np.float32)
        obs, actions = numbers[:, None], np.stack([numbers, -numbers], axis=1)
        earned = np.array(rewards[start : start + n_envs])
        buffer.add(obs, obs + 0.5, actions, earned, np.ones(n_envs), [{}] * n_envs)
    return buffer


def frequencies(buffer: RankReplayBuffer, n: int, draws: int = 100_000) -> np.ndarray:
    numbers = buffer.sample(draws).observations[:, 0].numpy().astype(int)
    return np.bincount(numbers, minlength=n) / draws


@settings(max_examples=30)
@given(st.lists(st.integers(-5, 5), min_size=1, max_size=30))
def test_ranks_by_counting(values):
    n = len(values)
    by_counting = [(sum(v < x for v in values) + (sum(v == x for v in values) - 1) / 2) for x in values]
    np.testing.assert_allclose(average_ranks(np.array(values)), np.array(by_counting) / max(n - 1, 1))
    assert average_ranks(np.array([1.0, np.nan, 2.0])).tolist() == [0.5, 0.0, 1.0]


RANKS = np.array([4, 1, 7, 4, 2, 6, 4, 0]) / 7


@pytest.mark.parametrize(
    ("rewards", "kwargs", "expected"),
    [
        ([3.0, -1.0, 10.0, 3.0, 0.0, 7.0, 3.0, -8.0], {}, np.exp(4 * RANKS) / np.exp(4 * RANKS).sum()),
        ([1.0] * 8, {}, [1 / 8] * 8),
        (range(8), {"temperature": 0.0}, [1 / 8] * 8),
        (range(8), {"temperature": 1e5}, [0.0] * 7 + [1.0]),
    ],
)
def test_frequencies_follow_the_formula(rewards, kwargs, expected):
    set_random_seed(0)
    found = frequencies(fill(rewards, n_envs=4, **kwargs), 8)
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
    space = spaces.Dict(a=spaces.Box(-1, 1, (1,)))
    with pytest.raises(NotImplementedError, match="doesn't support Dict observations: flatten them"):
        RankReplayBuffer(10, space, spaces.Box(-1, 1, (1,)))


def add(buffer: RankReplayBuffer, action, reward: float, number: float = 0.0) -> None:
    observation = np.full((1, 1), number)
    buffer.add(observation, observation, np.array([action]), np.array([reward]), np.ones(1), [{}])


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


def test_neighbourhood_means_by_hand():
    means = neighbourhood_means(np.array([[0.0], [3.0]]), np.array([[0.0], [0.2]]), np.array([1.0, 3.0]), distance=0.2)
    weight = np.exp(-0.5)
    assert means[0] == pytest.approx((1.0 + 3.0 * weight) / (1.25 + weight))
    assert means[1] == pytest.approx(0.0, abs=1e-9)  # far from all


def test_what_is_far_away_is_no_error_of_numpy():
    buffer = fill([1.0, 2.0, 3.0], temperature=1000.0)  # with actions far from each other
    with np.errstate(all="raise"):
        buffer.best_action()
        buffer.draw_near_best(0.01, 16)
        buffer.sample(4)
