"""Actions that are held for several steps, or scaled."""

from __future__ import annotations

import gymnasium as gym
import numpy as np
import pytest

from experiments.several_actions import ActionRepeat, with_scaled_actions


def test_held_actions_add_up_to_the_episode_that_repeats_them() -> None:
    """Also if the last action is cut short: 200 steps are 66 actions of three, and one of two."""
    held, plain = ActionRepeat(gym.make("Pendulum-v1"), 3), gym.make("Pendulum-v1")
    held.reset(seed=0)
    plain.reset(seed=0)
    actions = np.random.default_rng(0).uniform(-2.0, 2.0, (67, 1)).astype(np.float32)
    mean_rewards, rewards, ends = [], [], []
    for action in actions:
        observation, reward, _, truncated, _ = held.step(action)
        mean_rewards.append(reward)
        ends.append(truncated)
    for action in np.repeat(actions, 3, axis=0)[:200]:
        last, reward, *_ = plain.step(action)
        rewards.append(float(reward))
    assert ends == [False] * 66 + [True]
    assert observation == pytest.approx(last)
    assert mean_rewards[:66] == pytest.approx(np.reshape(rewards[:198], (66, 3)).mean(axis=1))
    assert 3 * sum(mean_rewards) == pytest.approx(sum(rewards))


def test_scaled_actions_are_cut_at_the_bounds_of_the_task() -> None:
    scaled, plain = with_scaled_actions(gym.make("Pendulum-v1"), 3.0), gym.make("Pendulum-v1")
    assert scaled.action_space == plain.action_space
    scaled.reset(seed=0)
    plain.reset(seed=0)
    for action, done in ((0.5, 1.5), (-0.6, -1.8), (0.7, 2.0), (-2.0, -2.0)):
        observation, reward, *_ = scaled.step(np.array([action], np.float32))
        expected, expected_reward, *_ = plain.step(np.array([done], np.float32))
        assert observation == pytest.approx(expected) and reward == pytest.approx(expected_reward)
