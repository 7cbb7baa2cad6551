"""Exploration: the warm-up, then noise around mu and draws around the best action, by their schedules."""

import math
from functools import partial
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium import spaces
from stable_baselines3.common.buffers import ReplayBuffer
from stable_baselines3.common.noise import NormalActionNoise
from stable_baselines3.common.utils import LinearSchedule
from stable_baselines3.common.vec_env import DummyVecEnv

from sarah.agents import NAF, LocalNAF

SMALL: Any = {"policy_kwargs": {"net_arch": [8]}}
"""Networks that nothing is learned with: quick ones."""


class Recorder(gym.Env):
    """Keeps its actions; the centre of the action space is (1, -1)."""

    observation_space = spaces.Box(-1, 1, (2,))
    action_space = spaces.Box(np.array([0.0, -3.0], np.float32), np.array([2.0, 1.0], np.float32))

    def __init__(self):
        self.actions = []

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        return np.zeros(2, np.float32), {}

    def step(self, action):
        self.actions.append(action)
        return np.zeros(2, np.float32), 0.0, True, False, {}


def explore(steps: int, n_envs: int = 1, algorithm: type[NAF] = NAF, **kwargs) -> np.ndarray:
    """Scaled actions of a model that is never trained, so that mu stays 0; (steps, n_envs, 2)."""
    envs = [Recorder() for _ in range(n_envs)]
    kwargs = {"learning_starts": 0, "gradient_steps": 0, "buffer_size": 10_000, "seed": 0, **SMALL, **kwargs}
    remaining = iter(envs)
    model = algorithm("MlpPolicy", DummyVecEnv([lambda: next(remaining)] * n_envs), **kwargs)
    model.learn(steps * n_envs)
    actions = (np.stack([e.actions for e in envs], axis=1) - [1.0, -1.0]) / [1.0, 2.0]
    # What the buffer keeps is what was done
    np.testing.assert_allclose(model.replay_buffer.actions.reshape(-1, n_envs, 2)[:steps], actions, atol=1e-6)
    return actions


def test_noise_has_its_standard_deviation():
    actions = explore(1000, n_envs=3, exploration_std=0.2)
    np.testing.assert_allclose(actions.std(axis=0), 0.2, rtol=0.1)
    np.testing.assert_allclose(actions.mean(axis=0), 0.0, atol=0.03)
    assert np.abs(np.corrcoef(actions.reshape(1000, 6).T) - np.eye(6)).max() < 0.13  # independent
    np.testing.assert_array_equal(explore(20, exploration_std=0.0), 0.0)


DEVIATIONS = [
    (np.array([0.3, 0.1]), [(0, 800, [0.3, 0.1])]),
    (LinearSchedule(0.3, 0.05, end_fraction=0.5), [(0, 100, [0.28] * 2), (400, 800, [0.05] * 2)]),
    ("lin_0.3", [(0, 100, [0.28] * 2), (350, 450, [0.15] * 2), (799, 800, [0.0] * 2)]),  # the text of RL Zoo
]


@pytest.mark.parametrize(("std", "parts"), DEVIATIONS)
def test_they_can_differ_between_dimensions_and_in_time(std, parts):
    actions = explore(800, exploration_std=std)
    for begin, end, expected in parts:
        np.testing.assert_allclose(actions[begin:end].std(axis=(0, 1)), expected, rtol=0.15, atol=0.002)


@pytest.mark.parametrize("std", [lambda left: 0.3 * left, LinearSchedule(0.2, 0.0, end_fraction=0.8)])
def test_a_schedule_keeps_its_end(std):
    """In steps beyond those asked for, and where rounding goes below 0: the second is -3e-17 after 80 of 100 steps."""
    model = NAF("MlpPolicy", "Pendulum-v1", exploration_std=std, learning_starts=0, train_freq=8, batch_size=8)
    model.learn(100, log_interval=100)
    assert model.num_timesteps == 104 and model.logger.name_to_value["train/exploration_std"] == 0.0


def test_given_action_noise_takes_precedence_in_the_warm_up_too():
    """As in TD3: where it is 2, every action ends at a bound."""
    for mean, learning_starts, expected in ((0.5, 0, 0.5), (2.0, 5, 1.0)):
        noise = NormalActionNoise(np.array([mean, -mean]), np.zeros(2))
        actions = explore(10, 2, action_noise=noise, exploration_std=0.3, learning_starts=learning_starts)
        np.testing.assert_allclose(actions, np.broadcast_to([expected, -expected], actions.shape), atol=1e-6)


@pytest.mark.parametrize("algorithm", [NAF, LocalNAF])
def test_its_own_noise_moves_no_warm_up_action(algorithm):
    """Otherwise many of them would be clipped to the bounds."""
    actions = explore(1050, algorithm=algorithm, learning_starts=1000, exploration_std=0.3)
    warm_up = actions[:1000]
    assert np.abs(warm_up).max() < 1.0
    np.testing.assert_allclose(warm_up.mean(axis=0), 0.0, atol=0.06)
    np.testing.assert_allclose(warm_up.std(axis=0), 1 / np.sqrt(3), rtol=0.05)
    assert len(np.unique(actions[1000:], axis=0)) > 40  # noise again


@pytest.mark.parametrize(("n_envs", "learning_starts"), [(1, 5), (4, 10)])
def test_the_warm_up_of_local_naf_is_spread_evenly(n_envs: int, learning_starts: int):
    """Few uniform draws may all miss the part of a dimension where something works."""
    steps = math.ceil(learning_starts / n_envs)
    noise = NormalActionNoise(np.full(2, 9.0), np.zeros(2))
    explored = partial(explore, n_envs=n_envs, algorithm=LocalNAF, learning_starts=learning_starts)
    warm_up = explored(steps + 1)[:steps].reshape(-1, 2)
    slices = np.sort(np.floor((warm_up + 1) / 2 * len(warm_up)), axis=0)
    np.testing.assert_array_equal(slices, np.arange(len(warm_up))[:, None].repeat(2, axis=1))
    assert (explored(steps, seed=1).reshape(-1, 2) != warm_up).all()
    np.testing.assert_allclose(explored(steps, action_noise=noise), 1.0, atol=1e-6)  # that is given, it counts


def test_a_warm_up_goes_on_with_more_environments(tmp_path: Path):
    LocalNAF("MlpPolicy", Recorder(), learning_starts=6, seed=0, **SMALL).learn(3).save(tmp_path / "model")
    envs = [Recorder() for _ in range(2)]
    remaining = iter(envs)
    model = LocalNAF.load(tmp_path / "model", env=DummyVecEnv([lambda: next(remaining)] * 2))
    model.learn(8, reset_num_timesteps=False)
    actions = np.array([env.actions for env in envs])
    assert actions.shape == (2, 4, 2) and len(np.unique(actions)) == 16


class Target(Recorder):
    """Rewards what is near (0.5, -0.5), in scaled actions."""

    def step(self, action):
        scaled = (action - [1.0, -1.0]) / [1.0, 2.0]
        observation, _, *rest = super().step(action)
        return observation, -float(np.abs(scaled - [0.5, -0.5]).sum()), *rest


def elite_actions(steps: int, environment: type[Recorder] = Target, **kwargs) -> tuple[np.ndarray, np.ndarray]:
    """Scaled actions of the warm-up and after it, by a model that is never trained; (steps, 2)."""
    env = environment()
    kwargs = dict(gradient_steps=0, seed=0, exploration_std=0.0, elite_draws=1) | SMALL | kwargs
    LocalNAF("MlpPolicy", env, learning_starts=30, **kwargs).learn(30 + steps)
    actions = (np.array(env.actions) - [1.0, -1.0]) / [1.0, 2.0]
    return actions[:30], actions[30:]


@pytest.mark.parametrize("on_request", [False, True])
def test_only_the_first_environment_begins_at_the_centre(on_request: bool):
    envs = [Recorder() for _ in range(2)]
    remaining = iter(envs)
    kwargs: Any = (
        dict(learning_starts=30, gradient_steps=0, seed=0, elite_share=1.0, first_action_centre=on_request) | SMALL
    )
    model = LocalNAF("MlpPolicy", DummyVecEnv([lambda: next(remaining)] * 2), **kwargs)
    model.learn(8).learn(8)  # the second time a best action is known from the beginning
    actions = (np.stack([env.actions for env in envs], axis=1) - [1.0, -1.0]) / [1.0, 2.0]
    assert [(actions[step, 0] == 0.0).all() for step in (0, 4)] == [on_request] * 2
    assert (actions[[1, 2, 3, 5, 6, 7]] != 0.0).all() and (actions[:, 1] != 0.0).all()


def test_from_the_centre_the_draws_begin_at_once():
    """Where the centre is a fair choice, no action is spent on uniform draws."""
    warm_up, _ = elite_actions(1, Recorder, elite_share=1.0, elite_std=0.1, first_action_centre=True)
    steps = np.abs(np.diff(warm_up, axis=0)).max(axis=1)
    assert (np.abs(warm_up[0]) == 0.0).all() and (steps > 0.0).all()
    assert np.abs(warm_up).max() < 0.6


def test_elite_actions_follow_the_best_of_the_replay_buffer():
    _, after = elite_actions(200, elite_share=1.0, elite_std=0.1)
    np.testing.assert_allclose(after[100:].mean(axis=0), [0.5, -0.5], atol=0.1)
    np.testing.assert_allclose(after.std(axis=0), 0.1, rtol=0.5)
    warm_up, after = elite_actions(1, elite_share=1.0, elite_std=0.0)
    assert np.abs(warm_up - after).sum(axis=1).min() < 1e-6  # one of those that have been tried


def test_elite_draws_follow_their_schedule_others_keep_to_mu():
    _, after = elite_actions(200, elite_share=1.0, elite_std=LinearSchedule(0.3, 0.02, end_fraction=0.5))
    spread = np.abs(np.diff(after, axis=0))
    assert spread[:40].mean() > 5 * spread[120:].mean()
    _, after = elite_actions(400, elite_share=0.7, elite_std=0.01)
    assert np.mean(np.abs(after).sum(axis=1) == 0.0) == pytest.approx(0.3, abs=0.06)


def test_of_many_draws_the_most_promising_is_tried():
    """With wide draws only those towards what has been good are worth an episode."""
    distances = {
        draws: np.abs(elite_actions(100, elite_share=1.0, elite_std=0.5, elite_draws=draws)[1] - [0.5, -0.5]).mean()
        for draws in (1, 16)
    }
    assert distances[16] < 0.6 * distances[1]


def test_elite_actions_need_a_buffer_that_knows_the_best():
    with pytest.raises(ValueError, match="LocalNAF needs a RankReplayBuffer, not a ReplayBuffer"):
        LocalNAF("MlpPolicy", Recorder(), replay_buffer_class=ReplayBuffer)  # type: ignore[arg-type]  # refused
