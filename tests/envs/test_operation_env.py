"""The environment of a robot in operation."""

import warnings
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from operated import quick
from stable_baselines3 import TD3
from stable_baselines3.common.env_checker import check_env as sb3_check_env

from sarah.agents import NAF
from sarah.envs.operation_env import SarahOperationEnv
from sarah.episode.settings import EpisodeConfig
from sarah.errors import ConfigurationError
from sarah.operation.settings import BOX, PARAMETERS, SHIPPED, Change
from sarah.operation.window import FELT

CENTRE = np.zeros(len(PARAMETERS), np.float32)
KICKED: dict[str, Any] = {"push": {"newtons": 400.0, "duration": 0.3}}


def test_gymnasium_knows_it_by_name() -> None:
    env = gymnasium.make("SarahOperation-v0", minutes=3.0, robot={"payload": 2.0})
    assert isinstance(env.unwrapped, SarahOperationEnv)
    assert env.unwrapped.config.minutes == 3.0 and env.unwrapped.config.robot.payload == 2.0
    assert env.action_space.shape == (9,) and env.observation_space.shape == (len(FELT) + 9,)
    env.close()


def test_changes_are_objects_or_mappings() -> None:
    named = SarahOperationEnv(changes=[{"minute": 1.0, "settings": {"payload": 3.0}}])
    assert SarahOperationEnv(changes=[Change(1.0, {"payload": 3.0})]).config == named.config
    with pytest.raises(ConfigurationError, match="changes must hold minute and settings, not '1: payload=3'"):
        SarahOperationEnv(changes=["1: payload=3"])


def test_checkers_find_nothing() -> None:
    env = SarahOperationEnv(quick(minutes=0.2))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", message=".*gymnasium.make.*")
        check_env(env, skip_render_check=True)
        sb3_check_env(env)
    env.close()


def test_a_step_is_a_window_whose_reward_the_robot_observes() -> None:
    env = SarahOperationEnv(quick(minutes=0.2))
    observation, info = env.reset(seed=1)
    assert info["window"].parameters == SHIPPED
    assert observation[len(FELT) :] == pytest.approx(BOX.scaled(SHIPPED))
    _, reward, terminated, truncated, info = env.step(CENTRE)
    assert reward == info["window"].observed_reward and info["window"].index == 1
    assert info["window"].parameters == SHIPPED and not terminated and not truncated
    action = np.full(9, 0.4, np.float32)
    _, _, _, _, info = env.step(action)
    assert BOX.shares(info["window"].parameters) == pytest.approx(np.minimum(np.array(BOX.shares(SHIPPED)) + 0.1, 1.0))
    env.close()


def test_the_time_truncates_and_another_operation_begins() -> None:
    env = SarahOperationEnv(quick(minutes=0.1))
    env.reset(seed=1)
    steps = 0
    while True:
        steps += 1
        _, _, terminated, truncated, info = env.step(CENTRE)
        assert not terminated
        if truncated:
            break
    assert info["window"].end >= 6.0 and steps == 4
    with pytest.raises(ConfigurationError, match="the episode is over"):
        env.step(CENTRE)
    _, info = env.reset()
    assert info["window"].index == 0
    env.close()


def test_a_fall_terminates_and_the_same_robot_goes_on() -> None:
    env = SarahOperationEnv(quick(minutes=1.0, robot=KICKED))
    env.reset(seed=1)
    terminated = False
    while not terminated:
        _, _, terminated, _, info = env.step(CENTRE)
    fallen = info["window"]
    _, info = env.reset()
    assert fallen.fell and info["window"].index == fallen.index + 1 and info["window"].begin == fallen.end
    _, info = env.reset(seed=1)
    assert info["window"].index == 0
    env.close()


def test_settings_of_another_kind_are_refused() -> None:
    with pytest.raises(ConfigurationError, match=r"^config must be an OperationConfig, not .*$"):
        SarahOperationEnv(EpisodeConfig())  # type: ignore[arg-type]
    with pytest.raises(ConfigurationError, match=r"^unknown render_mode 'rgb_array' \(allowed: None\)$"):
        SarahOperationEnv(render_mode="rgb_array")
    with pytest.raises(ConfigurationError, match="time_limit has no effect in an operation: leave it out"):
        SarahOperationEnv(robot={"time_limit": 3.0})


@pytest.mark.parametrize("action", [np.zeros(4), np.full(9, 1.5)])
def test_actions_out_of_their_box_are_refused(action: np.ndarray) -> None:
    env = SarahOperationEnv(quick())
    env.reset(seed=0)
    with pytest.raises(ConfigurationError, match="an action must be 9 numbers within -1 and 1"):
        env.step(action)
    env.close()


@pytest.mark.parametrize(("algorithm", "gamma"), [(NAF, 0.9), (TD3, 0.0)])
def test_agents_learn_on_it_with_any_discount(algorithm: type, gamma: float) -> None:
    env = SarahOperationEnv(quick(minutes=0.2, robot=KICKED))
    model = algorithm(
        "MlpPolicy", env, gamma=gamma, learning_starts=4, batch_size=8, seed=0, policy_kwargs=dict(net_arch=[16])
    )
    model.learn(10)
    action, _ = model.predict(env.observation_space.sample(), deterministic=True)
    assert np.isfinite(action).all() and model.num_timesteps == 10
    env.close()
