"""Actions that are held for several steps, or scaled."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest

from experiments.several_actions import ActionRepeat, Training, kept_course, with_scaled_actions


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


def test_a_kept_course_is_that_of_the_same_settings_and_the_same_algorithm(tmp_path: Path) -> None:
    training = Training("Pendulum-v1", "naf, noise of 0.9", 0, 102, 51, 1, action_repeat=1, action_scale=1.0)
    course = kept_course(training, tmp_path, [1.0, 2.0])
    (file,) = tmp_path.iterdir()
    assert file.name == "Pendulum-v1-naf-noise-of-0.9-102-s0.json" and len(course) == 2
    marked = json.loads(file.read_text()) | {"course": [[0.0, 0.0]]}
    file.write_text(json.dumps(marked))
    assert kept_course(training, tmp_path, [1.0, 2.0001]) == [[0.0, 0.0]]
    for other, fingerprint in ((replace(training, episodes=2), [1.0, 2.0]), (training, [1.0, 2.1])):
        file.write_text(json.dumps(marked))
        assert len(kept_course(other, tmp_path, fingerprint)) == 2
