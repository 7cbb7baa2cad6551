"""The agent of a run goes on learning in plain stable-baselines3, from any environment."""

from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
import torch
from interrupted import EPISODE
from stable_baselines3 import DDPG, SAC, TD3
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm
from stable_baselines3.common.vec_env import DummyVecEnv

from sarah.agents import NAF, LocalNAF
from sarah.runs.agent_settings import settings_of
from sarah.runs.config import AGENTS, TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.training.train import train


@pytest.fixture(scope="module")
def models(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The saved agent of a run of each algorithm, with several episodes in flight."""
    folder, paths = tmp_path_factory.mktemp("runs"), {}
    for algo in AGENTS:
        agent = settings_of(algo)(learning_starts=3, gradient_steps=2)  # type: ignore[call-arg]
        config = TrainingConfig(algo=algo, episodes=6, slots=2, episode=EPISODE, agent=agent)
        run = RunFolder.create(folder / algo, config)
        train(config, run)
        paths[algo] = run.model_path
    return paths


def environment(count: int = 1) -> gymnasium.Env[np.ndarray, np.ndarray] | DummyVecEnv:
    """The First Training's environment, or several of it side by side."""

    def make() -> gymnasium.Env[np.ndarray, np.ndarray]:
        return gymnasium.make("SarahStepping-v0", config=EPISODE)

    return make() if count == 1 else DummyVecEnv([make] * count)


def weights(model: OffPolicyAlgorithm) -> torch.Tensor:
    return torch.nn.utils.parameters_to_vector(model.policy.parameters()).detach().clone()


@pytest.mark.parametrize(
    ("algo", "algorithm", "count"),
    [("naf", LocalNAF, 1), ("naf", NAF, 3), ("td3", TD3, 3), ("sac", SAC, 1), ("ddpg", DDPG, 1)],
)
def test_the_agent_of_a_run_goes_on(algo: str, algorithm: Any, count: int, models: dict[str, Path]) -> None:
    model = algorithm.load(models[algo], env=environment(count))
    before, steps = weights(model), model.num_timesteps
    if algorithm is LocalNAF:  # without another warm-up
        model.learn(2, reset_num_timesteps=False)
        assert model.num_timesteps == steps + 2 and not torch.equal(weights(model), before)
    model = algorithm.load(models[algo], env=environment(count)).learn(6)
    assert model.replay_buffer is not None and model.num_timesteps == 6
    assert model.replay_buffer.size() * model.replay_buffer.n_envs == 6
    assert not torch.equal(weights(model), before) and torch.isfinite(weights(model)).all()


def test_what_goes_on_is_what_was_done(models: dict[str, Path]) -> None:
    """Nothing of the slots is left: each reward is stored with the action that it came from."""
    actions: Any = []
    rewards: Any = []
    env: Any = environment()
    env = gymnasium.wrappers.TransformReward(env, lambda reward: rewards.append(reward) or reward)
    env = gymnasium.wrappers.TransformAction(env, lambda action: actions.append(action) or action, env.action_space)
    buffer: Any = TD3.load(models["td3"], env=env).learn(5).replay_buffer
    np.testing.assert_allclose(buffer.actions[:5, 0], actions, atol=1e-6)
    np.testing.assert_allclose(buffer.rewards[:5, 0], rewards, rtol=1e-6)
