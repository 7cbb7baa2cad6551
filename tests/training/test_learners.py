"""Agents are built from their settings, every setting reaches them, and they go on in plain stable-baselines3."""

import copy
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
import torch
from interrupted import EPISODE, trained
from stable_baselines3 import DDPG, SAC, TD3
from stable_baselines3.common.logger import Logger
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm
from stable_baselines3.common.utils import get_device
from stable_baselines3.common.vec_env import DummyVecEnv
from torch import nn

from sarah.agents import NAF, PRESETS, LocalNAF, RankReplayBuffer, SmoothedReplayBuffer
from sarah.envs.episode_vec_env import EpisodeVecEnv
from sarah.envs.sarah_env import draw_seed
from sarah.episode.workers import Job, Workers
from sarah.errors import ConfigurationError
from sarah.runs.agent_settings import AgentSettings, NAFSettings, settings_of
from sarah.runs.config import AGENTS, TrainingConfig
from sarah.training.learners import check_device, make_agent
from sarah.training.plan import plan_of


def built(algo: str = "naf", slots: int = 1, task: str = "stepping", **settings: Any) -> Any:
    """An agent, of the algorithm's own class."""
    config = TrainingConfig(task=task, algo=algo, slots=slots, agent=settings_of(algo)(**settings))
    return make_agent(plan_of(config), EpisodeVecEnv(task, config.episode, 1, slots, Workers()))


def widths(net: nn.Module, outputs: int = 1) -> tuple[int, ...]:
    """Of its layers, but for the last ones, which are outputs."""
    layers = [layer.out_features for layer in net.modules() if isinstance(layer, nn.Linear)]
    return tuple(layers[: len(layers) - outputs])


def pair(schedule: Callable[[float], float]) -> tuple[float, float]:
    """What a schedule begins with and ends with, in a straight line."""
    assert schedule(1.0 - end_of(schedule) / 2) == pytest.approx((schedule(1.0) + schedule(0.0)) / 2)
    return schedule(1.0), schedule(0.0)


def end_of(schedule: Callable[[float], float]) -> float:
    """Share of the training after which a schedule changes no more."""
    shares = [percent / 100 for percent in range(1, 101)]
    return next(share for share in shares if schedule(1.0 - share) == pytest.approx(schedule(0.0)))


def noise_std(model: OffPolicyAlgorithm) -> float:
    assert model.action_noise is not None
    return round(float(np.std([model.action_noise() for _ in range(5000)])), 1)


COMMON: dict[str, tuple[Any, Callable[[Any], Any]]] = {
    "learning_rate": (3e-4, lambda model: model.policy.optimizer.param_groups[0]["lr"]),
    "buffer_size": (77, lambda model: model.buffer_size),
    "learning_starts": (9, lambda model: model.learning_starts),
    "batch_size": (13, lambda model: model.batch_size),
    "tau": (0.5, lambda model: model.tau),
    "gamma": (0.9, lambda model: model.gamma),
    "gradient_steps": (3, lambda model: model.gradient_steps),
    "device": ("auto", lambda model: "auto" if model.device == get_device("auto") else model.device),
}
CRITICS = {
    **COMMON,
    "learning_rate": (5e-4, lambda model: model.critic.optimizer.param_groups[0]["lr"]),
    "layers": ((7, 6), lambda model: widths(model.critic.qf0)),
}
NOISY = {**CRITICS, "action_noise_std": (0.7, noise_std)}
SETTINGS: dict[str, dict[str, tuple[Any, Callable[[Any], Any]]]] = {
    "naf": {
        **{name: entry for name, entry in COMMON.items() if name != "gamma"},  # 0 while good episodes are preferred
        "max_grad_norm": (2.5, lambda model: model.max_grad_norm),
        "exploration_std": ((0.5, 0.2), lambda model: pair(model.exploration_schedule)),
        "temperature": (1.5, lambda model: model.replay_buffer.temperature),
        "smoothed": (False, lambda model: isinstance(model.replay_buffer, SmoothedReplayBuffer)),
        "elite_share": (0.25, lambda model: model.elite_share_schedule(0.5)),
        "elite_std": ((0.1, 0.6), lambda model: pair(model.elite_std_schedule)),
        "elite_end": (0.33, lambda model: end_of(model.elite_std_schedule)),
        "elite_draws": (5, lambda model: model.elite_draws),
        "v_layers": ((7, 6), lambda model: widths(model.q_net.value_net)),
        "mu_layers": ((7, 6), lambda model: widths(model.q_net.mu_net)),
        "l_layers": ((7, 6), lambda model: widths(model.q_net.lower_net)),
        "shared_layers": ((7,), lambda model: widths(model.q_net.shared_net, outputs=0)),
        "activation": ("relu", lambda model: {nn.ReLU: "relu", nn.Tanh: "tanh"}[type(model.q_net.mu_net[1])]),
        "squash_mu": (False, lambda model: isinstance(model.q_net.mu_net[-1], nn.Tanh)),
        "min_curvature": (0.5, lambda model: model.q_net.min_curvature),
    },
    "td3": {
        **NOISY,
        "policy_delay": (4, lambda model: model.policy_delay),
        "target_policy_noise": (0.1, lambda model: model.target_policy_noise),
        "target_noise_clip": (0.3, lambda model: model.target_noise_clip),
    },
    "sac": {**CRITICS, "ent_coef": (0.1, lambda model: model.ent_coef)},
    "ddpg": NOISY,
}
"""Of every setting another value than the default, and where the agent has it."""


def found(algo: str, **settings: Any) -> dict[str, Any]:
    model = built(algo, **settings)
    return {name: of(model) for name, (_, of) in SETTINGS[algo].items()}


@pytest.mark.parametrize("algo", AGENTS)
def test_every_setting_reaches_the_agent(algo: str) -> None:
    changed = {name: value for name, (value, _) in SETTINGS[algo].items()}
    defaults = {name: getattr(settings_of(algo)(), name) for name in changed}
    assert set(changed) | ({"gamma", "preset"} if algo == "naf" else set()) == set(vars(settings_of(algo)()))
    assert not changed.items() & defaults.items()
    assert found(algo, **changed) == changed
    assert found(algo) == {**defaults, "device": found(algo)["device"]}


def test_what_follows_counts_only_where_no_episode_is_preferred() -> None:
    assert built(preset="paper", gamma=0.9).gamma == 0.9
    for preferred in ({}, {"temperature": 0.0}, {"elite_share": 0.0}, {"preset": "paper", "elite_share": 0.1}):
        with pytest.raises(ConfigurationError, match=r"agent\.gamma must be 0 unless .* are 0, not 0\.5$"):
            NAFSettings(gamma=0.5, **preferred)


@pytest.mark.parametrize(("preset", "algorithm"), [("one-step", LocalNAF), ("noisy", LocalNAF), ("paper", NAF)])
def test_presets_are_those_of_the_agents(preset: str, algorithm: type[NAF]) -> None:
    env = EpisodeVecEnv("stepping", TrainingConfig().episode, 1, 1, Workers())
    plain, model = algorithm("MlpPolicy", env, **PRESETS[preset]), built(preset=preset)
    for name in ("value_net", "shared_net", "mu_net", "lower_net"):
        assert str(getattr(model.q_net, name)) == str(getattr(plain.q_net, name))
    assert model.q_net.min_curvature == plain.q_net.min_curvature
    if algorithm is LocalNAF:
        ours, theirs = ({name: of(agent) for name, (_, of) in SETTINGS["naf"].items()} for agent in (model, plain))
        assert {name for name in ours if ours[name] != theirs[name]} <= {"device"} and model.gamma == plain.gamma
    else:
        assert (model.elite_share, model.replay_buffer.temperature) == (0.0, 0.0)


def test_the_warm_up_knows_as_many_outcomes_as_are_in_flight() -> None:
    assert [built(slots=slots).learning_starts for slots in (1, 2, 3, 8)] == [5, 5, 6, 16]
    assert built("sac", slots=20).learning_starts == 40


@pytest.mark.parametrize("algo", AGENTS)
def test_what_all_agents_have_in_common(algo: str) -> None:
    """The others replay all episodes alike and without luck; the first action is neutral where the task has one."""
    stepping, balance = built(algo), built(algo, task="balance")
    assert (stepping.first_action_centre, balance.first_action_centre) == (False, True)
    assert isinstance(stepping.replay_buffer, RankReplayBuffer)
    assert (stepping.replay_buffer.temperature == 0.0) == (algo != "naf")
    scales = getattr(stepping.replay_buffer, "length_scales", None)
    assert scales == ([0.25, 1.0, 1.0, 1.0, 1.0] if algo == "naf" else None)


@pytest.mark.parametrize("algo", AGENTS)
def test_no_random_stream_is_used_twice(algo: str) -> None:
    class Asked(Workers):
        def __init__(self) -> None:
            super().__init__()
            self.seeds: list[int] = []

        def submit(self, function: Callable[..., Any], *subjects: Any) -> Job:
            self.seeds += [subject.seed for subject in subjects]
            return super().submit(function, *subjects)

    config, asked = TrainingConfig(algo=algo, slots=3), Asked()
    env = EpisodeVecEnv("stepping", config.episode, 3, 3, asked)
    model = make_agent(plan_of(config), env)
    # torch and numpy have the same generator, of which torch's draws the weights and numpy's the exploration.
    weights = np.random.RandomState(torch.initial_seed()).get_state(legacy=False)["state"]["key"]
    assert not np.array_equal(np.random.get_state(legacy=False)["state"]["key"], weights)
    warm_up = copy.deepcopy(model.action_space.np_random)
    env.reset()
    assert len(asked.seeds) == 3 and asked.seeds != [draw_seed(warm_up) for _ in range(3)]


@pytest.mark.parametrize("device", ["cuda", "cuda:1"])
def test_a_device_that_is_not_there_is_refused(device: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(torch.cuda, "device_count", lambda: 0)
    with pytest.raises(ConfigurationError, match=f"agent.device '{device}' is not here: torch finds 0 CUDA devices"):
        built(device=device)
    monkeypatch.setattr(torch.cuda, "device_count", lambda: 2)
    check_device(NAFSettings(device=device))
    check_device(AgentSettings())


@pytest.fixture(scope="module")
def models(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The saved agent of a run of each algorithm, with several episodes in flight."""
    folder, paths = tmp_path_factory.mktemp("runs"), {}
    for algo in AGENTS:
        agent = settings_of(algo)(learning_starts=3, gradient_steps=2)  # type: ignore[call-arg]
        config = TrainingConfig(algo=algo, episodes=6, slots=2, episode=EPISODE, agent=agent)
        paths[algo] = trained(folder / algo, config).model_path
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


def test_nobody_is_told_to_change_the_rewards_of_the_packages_tasks() -> None:
    model = built(learning_starts=8)
    model.set_logger(Logger(None, []))
    shape, space = (1, *model.observation_space.shape), model.action_space
    for reward in range(8):
        observation = np.zeros(shape, dtype=np.float32)
        model.replay_buffer.add(
            observation, observation, space.sample()[None], np.array([60.0 + reward]), np.array([True]), [{}]
        )
    with warnings.catch_warnings(record=True) as said:
        model.train(1)
    assert not said
