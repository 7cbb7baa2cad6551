"""A replay buffer whose rewards are those that are expected of the actions."""

import pickle

import numpy as np
import pytest
from gymnasium import spaces
from stable_baselines3.common.utils import set_random_seed

from sarah.agents import RankReplayBuffer, SmoothedReplayBuffer

BOX = spaces.Box(-1, 1, (2,))


def hill(actions: np.ndarray) -> np.ndarray:
    return np.exp(-2 * np.sum((actions - 0.4) ** 2, axis=-1))


def played(kind: type[RankReplayBuffer] = SmoothedReplayBuffer, count: int = 200) -> RankReplayBuffer:
    """A buffer with noisy rewards of a hill."""
    buffer, rng = kind(150, BOX, BOX, "cpu"), np.random.default_rng(0)
    for action in rng.uniform(-1, 1, (count, 2)):
        add(buffer, action, float(hill(action)) + rng.normal(0, 0.5))
    return buffer


def add(buffer: RankReplayBuffer, action: np.ndarray, reward: float) -> None:
    zeros = np.zeros((1, 2), np.float32)
    buffer.add(zeros, zeros, np.array([action], np.float32), np.array([reward]), np.ones(1), [{}])


def sampled(buffer: RankReplayBuffer) -> tuple[np.ndarray, np.ndarray]:
    set_random_seed(0)
    samples = buffer.sample(2000)
    return samples.actions.numpy(), samples.rewards.numpy()[:, 0]


def test_sampled_rewards_are_near_the_truth_and_luck_is_rare() -> None:
    smoothed, plain = played(), played(RankReplayBuffer)
    assert (smoothed.rewards == plain.rewards).all()
    samples = [sampled(buffer) for buffer in (smoothed, plain)]
    errors = [np.std(rewards - hill(actions)) for actions, rewards in samples]
    assert errors[0] < 0.4 * errors[1]
    good = [hill(actions).mean() for actions, _ in samples]
    assert good[0] > good[1] + 0.1


def test_the_best_action_and_draws_near_it_are_near_the_top() -> None:
    buffer = played()
    best = buffer.best_action()
    assert hill(best) > 0.9 and best.tolist() not in buffer.actions[:, 0].tolist()
    set_random_seed(0)
    few, many = (hill(np.array([buffer.draw_near_best(0.5, draws) for _ in range(60)])).mean() for draws in (1, 16))
    assert many > few + 0.1


def test_what_is_known_follows_every_addition() -> None:
    buffer = played(count=30)
    before = buffer.best_action()
    for _ in range(40):
        add(buffer, np.array([-0.9, -0.9]), 5.0)
    assert np.linalg.norm(buffer.best_action() + 0.9) < 0.3 < np.linalg.norm(before + 0.9)
    buffer.reset()
    add(buffer, np.array([0.5, 0.5]), 1.0)
    fresh = SmoothedReplayBuffer(150, BOX, BOX, "cpu")
    add(fresh, np.array([0.5, 0.5]), 1.0)
    assert buffer.best_action().tolist() == fresh.best_action().tolist()
    buffer.reset()
    with pytest.raises(ValueError, match="the replay buffer is empty, so there is no best action"):
        buffer.best_action()


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_reward_that_is_no_number_spoils_no_other(value: float) -> None:
    """So the loss still says that something is wrong."""
    buffer = played(count=60)
    best = buffer.best_action()
    add(buffer, np.array([0.0, 0.0]), value)
    actions, rewards = sampled(buffer)
    of_value = (actions == 0.0).all(axis=1)
    assert np.isfinite(rewards[~of_value]).all() and not np.isfinite(rewards[of_value]).any()
    assert np.linalg.norm(buffer.best_action() - best) < 0.3


def test_a_pickled_buffer_goes_on_as_the_first() -> None:
    buffer = played(count=47)
    copy = pickle.loads(pickle.dumps(buffer))
    for one in (buffer, copy):
        for step in range(8):
            add(one, np.array([0.1 * step, -0.2]), 0.3 * step)
    assert copy.best_action().tolist() == buffer.best_action().tolist()
    assert sampled(copy)[1].tobytes() == sampled(buffer)[1].tobytes()


def test_no_reward_is_expected_from_what_was_forgotten() -> None:
    """Old episodes beside a cliff, where the newest 500 never went, keep no place in the buffer."""
    buffer = SmoothedReplayBuffer(10_000, BOX, BOX, "cpu")
    rng = np.random.default_rng(0)
    for action in (*rng.uniform(-1, 0, (200, 2)), *rng.normal(0.5, 0.05, (500, 2))):
        add(buffer, action, float(action[0] > 0))
    actions, rewards = sampled(buffer)
    assert (actions[:, 0] > 0).all() and np.abs(rewards - 1).max() < 0.1
