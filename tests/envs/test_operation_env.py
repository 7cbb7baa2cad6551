"""The environment of a robot in operation."""

from typing import Any, cast

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
    changes = [{"minute": 1.0, "settings": {"payload": 3.0}}]
    env: Any = gymnasium.make("SarahOperation-v0", minutes=3.0, robot={"payload": 2.0}, changes=changes)
    config = env.unwrapped.config
    assert (config.minutes, config.robot.payload, config.changes) == (3.0, 2.0, (Change(1.0, {"payload": 3.0}),))
    assert SarahOperationEnv(config, changes=[Change(1.0, {"payload": 3.0})]).config == config
    assert env.action_space.shape == (9,) and env.observation_space.shape == (len(FELT) + 9,)


@pytest.mark.filterwarnings("error", "ignore:.*gymnasium.make.*")
def test_checkers_find_nothing() -> None:
    env = SarahOperationEnv(quick(minutes=0.2))
    check_env(env, skip_render_check=True)
    sb3_check_env(env)


def test_a_step_is_a_window_whose_reward_the_robot_observes() -> None:
    env = SarahOperationEnv(quick(minutes=0.2))
    observation, info = env.reset(seed=1)
    assert info["window"].parameters == SHIPPED
    assert observation[len(FELT) :] == pytest.approx(BOX.scaled(SHIPPED))
    _, reward, terminated, truncated, info = env.step(CENTRE)
    assert reward == info["window"].observed_reward and info["window"].index == 1
    assert info["window"].parameters == SHIPPED and not terminated and not truncated
    _, _, _, _, info = env.step(np.full(9, 0.4, np.float32))
    assert BOX.shares(info["window"].parameters) == pytest.approx(np.minimum(np.array(BOX.shares(SHIPPED)) + 0.1, 1.0))
    for outside in (np.zeros(4), np.full(9, 1.5)):
        with pytest.raises(ConfigurationError, match="an action must be 9 numbers within -1 and 1"):
            env.step(outside)


def test_the_time_truncates_and_another_operation_begins() -> None:
    env = SarahOperationEnv(quick(minutes=0.1))
    env.reset(seed=1)
    ends = [env.step(CENTRE) for _ in range(4)]
    assert [end[2:4] for end in ends] == [(False, False)] * 3 + [(False, True)] and ends[-1][4]["window"].end >= 6.0
    with pytest.raises(ConfigurationError, match="the episode is over"):
        env.step(CENTRE)
    assert env.reset()[1]["window"].index == 0


def test_a_fall_terminates_and_the_same_robot_goes_on() -> None:
    env = SarahOperationEnv(quick(minutes=1.0, robot=KICKED))
    env.reset(seed=1)
    terminated = False
    while not terminated:
        _, _, terminated, _, info = env.step(CENTRE)
    fallen = info["window"]
    _, info = env.reset()
    assert fallen.fell and info["window"].index == fallen.index + 1 and info["window"].begin == fallen.end
    assert env.reset(seed=1)[1]["window"].index == 0


def test_settings_of_another_kind_are_refused() -> None:
    for settings, words in (
        ({"config": EpisodeConfig()}, r"^config must be an OperationConfig, not .*$"),
        ({"render_mode": "rgb_array"}, r"^unknown render_mode 'rgb_array' \(allowed: None\)$"),
        ({"robot": {"time_limit": 3.0}}, "time_limit has no effect in an operation: leave it out"),
        ({"changes": ["1: payload=3"]}, "must hold minute and settings, not '1: payload=3'"),
    ):
        with pytest.raises(ConfigurationError, match=words):
            SarahOperationEnv(**cast(Any, settings))


@pytest.mark.parametrize(("algorithm", "gamma"), [(NAF, 0.9), (TD3, 0.0)])
def test_agents_learn_on_it_with_any_discount(algorithm: type, gamma: float) -> None:
    env = SarahOperationEnv(quick(minutes=0.2, robot=KICKED))
    settings = dict(learning_starts=4, batch_size=8, seed=0, policy_kwargs=dict(net_arch=[16]))
    model = algorithm("MlpPolicy", env, gamma=gamma, **settings).learn(10)
    action, _ = model.predict(env.observation_space.sample(), deterministic=True)
    assert np.isfinite(action).all() and model.num_timesteps == 10
