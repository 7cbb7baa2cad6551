"""How parameters are learned: by an agent of stable-baselines3's kind, or by a black-box optimiser.

All learn from corrected returns, without what known disturbances explain of them.
"""

from __future__ import annotations

import dataclasses
from collections import deque
from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
import torch
from stable_baselines3.common.noise import NormalActionNoise
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm
from stable_baselines3.common.utils import LinearSchedule
from stable_baselines3.common.vec_env import VecEnv
from torch import nn

from sarah.agents import LocalNAF
from sarah.agents.arguments import checked_disturbances
from sarah.agents.corrections import corrected
from sarah.envs.episode_vec_env import EpisodeVecEnv
from sarah.envs.sarah_env import draw_seed, observation_from, parameters_from
from sarah.episode.episode import Episode, simulate
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import EpisodeSpec
from sarah.episode.task_answers import disturbances_of
from sarah.episode.tasks import Task
from sarah.episode.workers import Executor, Job
from sarah.errors import ConfigurationError
from sarah.files import replacing
from sarah.runs.agent_settings import (
    AgentSettings,
    DDPGSettings,
    LearnerSettings,
    NAFSettings,
    SACSettings,
    TD3Settings,
)
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.randomisation import Randomisation
from sarah.training.beginnings import BeginningDDPG, BeginningSAC, BeginningTD3
from sarah.training.optimisers import OPTIMISERS, Start
from sarah.training.recommendation import Parameters
from sarah.training.recorder import EpisodeRecorder, check_weights
from sarah.training.replay import LateRankReplayBuffer, LateSmoothedReplayBuffer
from sarah.training.seeds import seeds_of
from sarah.training.warm_up import begins_at_centre, warm_up

SCHEDULED_SHARE = 0.8
"""Share of a training after which what NAF's settings change in its course has its last value."""
ALL_ALIKE = {"temperature": 0.0}
"""Arguments of the replay buffer with which it prefers no episode."""
ACTIVATIONS = {"tanh": nn.Tanh, "relu": nn.ReLU, "sigmoid": nn.Sigmoid}


class Learner(Protocol):
    """Something that learns a task's parameters from episodes, and can go on."""

    def learn(self, episodes: int) -> Parameters:
        """Learn from more episodes.

        :param episodes: number of episodes
        :return: what the algorithm itself would choose now
        """


def make_learner(config: TrainingConfig, run: RunFolder, recorder: EpisodeRecorder, workers: Executor) -> Learner:
    """Make what the configuration names.

    :param config: settings of the training
    :param run: run folder, in which an agent is saved
    :param recorder: recorder of the episodes
    :param workers: who simulates
    """
    if config.algo in OPTIMISERS:
        return _Search(config, recorder, workers)
    return _Agent(config, run, recorder, workers)


class _Agent:
    """An agent of stable-baselines3's kind."""

    def __init__(self, config: TrainingConfig, run: RunFolder, recorder: EpisodeRecorder, workers: Executor) -> None:
        self._config, self._run, self._recorder = config, run, recorder
        self._env = EpisodeVecEnv(config.task, config.episode, 0, config.slots, workers)
        self._model = make_agent(config, self._env)
        self._model.set_logger(recorder.log)
        self._nominal = nominal_observation(config)

    def learn(self, episodes: int) -> Parameters:
        """Learn, and save the agent. When it goes on, its schedules are those of all its episodes together."""
        model = self._model
        self._recorder.choose = lambda: chosen_parameters(model, self._nominal, self._config.task)
        self._env.episodes = episodes
        model.set_env(self._env)  # which is reset for the new episodes
        # The recorder logs every episode; stable-baselines3's own averages are left out.
        model.learn(
            episodes + self._config.slots - 1,
            callback=self._recorder,
            log_interval=None,  # type: ignore[arg-type]
            reset_num_timesteps=False,
        )
        check_weights(model)
        with replacing(self._run.model_path) as file:
            model.save(file)  # type: ignore[arg-type]  # any file will do
        return self._recorder.choose()


def make_agent(config: TrainingConfig, env: VecEnv) -> OffPolicyAlgorithm:
    """Make the reinforcement learner that a configuration names, with its settings.

    :param config: settings of the training
    :param env: environment to learn from
    """
    settings = config.agent
    assert isinstance(settings, LearnerSettings)
    check_device(settings)
    # All algorithms of stable-baselines3's kind take these under the same names.
    common = {item.name: getattr(settings, item.name) for item in dataclasses.fields(LearnerSettings)}
    common["learning_starts"] = warm_up(config)
    common["replay_buffer_class"] = LateRankReplayBuffer
    algorithm, own_arguments = LEARNERS[type(settings)]
    task = config.task
    own = own_arguments(settings, task) | {"first_action_centre": begins_at_centre(task)}
    seeds = seeds_of(config.seed)
    model = algorithm("MlpPolicy", env, seed=seeds.algorithm, **(common | own))
    # stable-baselines3 seeds everything alike: torch and numpy then draw the same bits, as do warm-up and episodes.
    np.random.seed(seeds.exploration)
    env.seed(seeds.episodes)
    return model


def check_device(settings: AgentSettings) -> None:
    """Refuse a device that is not there, for which stable-baselines3 would take the processor.

    :param settings: Settings of an algorithm
    :raises ConfigurationError: naming the device
    """
    if isinstance(settings, LearnerSettings) and settings.device.startswith("cuda"):
        found = torch.cuda.device_count()
        if (torch.device(settings.device).index or 0) >= found:
            raise ConfigurationError(f"agent.device {settings.device!r} is not here: torch finds {found} CUDA devices")


def _naf_arguments(settings: NAFSettings, task: Task) -> dict[str, Any]:
    layers = dict(V=settings.v_layers, mu=settings.mu_layers, L=settings.l_layers, shared=settings.shared_layers)
    return dict(
        replay_buffer_class=LateSmoothedReplayBuffer if settings.smoothed else LateRankReplayBuffer,
        replay_buffer_kwargs=dict(temperature=settings.temperature),
        max_grad_norm=settings.max_grad_norm,
        exploration_std=LinearSchedule(*settings.exploration_std, end_fraction=SCHEDULED_SHARE),
        elite_share=settings.elite_share,
        elite_std=LinearSchedule(*settings.elite_std, end_fraction=SCHEDULED_SHARE),
        elite_draws=settings.elite_draws,
        policy_kwargs=dict(
            net_arch={name: list(widths) for name, widths in layers.items()},
            activation_fn=ACTIVATIONS[settings.activation],
            squash_mu=settings.squash_mu,
            min_curvature=settings.min_curvature,
        ),
    )


def _ddpg_arguments(settings: DDPGSettings, task: Task) -> dict[str, Any]:
    dimensions = len(task.parameter_names)
    return dict(
        replay_buffer_kwargs=ALL_ALIKE,
        policy_kwargs=dict(net_arch=list(settings.layers)),
        action_noise=NormalActionNoise(np.zeros(dimensions), np.full(dimensions, settings.action_noise_std)),
    )


def _td3_arguments(settings: TD3Settings, task: Task) -> dict[str, Any]:
    return dict(
        **_ddpg_arguments(settings, task),
        policy_delay=settings.policy_delay,
        target_policy_noise=settings.target_policy_noise,
        target_noise_clip=settings.target_noise_clip,
    )


def _sac_arguments(settings: SACSettings, task: Task) -> dict[str, Any]:
    return dict(
        replay_buffer_kwargs=ALL_ALIKE,
        policy_kwargs=dict(net_arch=list(settings.layers)),
        ent_coef=settings.ent_coef,
    )


LEARNERS: dict[type[LearnerSettings], tuple[type[OffPolicyAlgorithm], Callable[[Any, Task], dict[str, Any]]]] = {
    NAFSettings: (LocalNAF, _naf_arguments),
    TD3Settings: (BeginningTD3, _td3_arguments),
    SACSettings: (BeginningSAC, _sac_arguments),
    DDPGSettings: (BeginningDDPG, _ddpg_arguments),
}
"""Class of every kind of settings' algorithm, and what makes its arguments beyond those that all share."""


def nominal_observation(config: TrainingConfig) -> np.ndarray:
    """What the agent sees when the robot as designed stands before it.

    :param config: settings of the training; the randomisation is left out
    """
    nominal = dataclasses.replace(config.episode, randomisation=Randomisation(enabled=False))
    with Episode(nominal, 0, config.task) as episode:
        return observation_from(episode.stand(), nominal.scale)


def chosen_parameters(model: OffPolicyAlgorithm, observation: np.ndarray, task: Task) -> Parameters:
    """What the agent does, without exploration.

    :param model: the agent
    :param observation: observation that it acts on, of shape (16,)
    :param task: task whose parameters they are
    """
    action, _ = model.predict(observation, deterministic=True)
    return parameters_from(action, task)


class _Search:
    """A black-box optimiser, which tries parameters, as many in flight as there are slots."""

    def __init__(self, config: TrainingConfig, recorder: EpisodeRecorder, workers: Executor) -> None:
        self._config, self._recorder, self._workers = config, recorder, workers
        seeds, dimensions = seeds_of(config.seed), len(config.task.parameter_names)
        start = Start(begins_at_centre(config.task), warm_up(config), config.slots)
        self._optimiser = OPTIMISERS[config.algo](config.agent, dimensions, seeds.algorithm, start)
        self._generator = np.random.default_rng(seeds.episodes)
        self._running: deque[tuple[np.ndarray, EpisodeSpec, Job]] = deque()
        self._returns: list[float] = []
        self._disturbances: list[np.ndarray] = []

    def learn(self, episodes: int) -> Parameters:
        """Try parameters, and learn from the returns."""
        config, optimiser = self._config, self._optimiser
        self._recorder.choose = lambda: parameters_from(optimiser.choice(), config.task)
        for _ in range(episodes):
            while len(self._running) == config.slots or not optimiser.ready():
                self._tell_oldest()
            action = optimiser.ask()
            parameters = parameters_from(action, config.task)
            spec = EpisodeSpec(parameters, draw_seed(self._generator), config.task, config.episode)
            self._running.append((action, spec, self._workers.submit(simulate, spec)))
        while self._running:
            self._tell_oldest()
        return self._recorder.choose()

    def _tell_oldest(self) -> None:
        action, spec, job = self._running.popleft()
        result = job.result()
        self._optimiser.tell(action, self._corrected_return(spec, result))
        self._recorder.record(spec, result)

    def _corrected_return(self, spec: EpisodeSpec, result: EpisodeResult) -> float:
        """Return without what the episode's disturbances explain of it, by all episodes so far."""
        disturbances = disturbances_of(spec)
        if disturbances is None:
            return result.episode_return
        number = len(self._disturbances[0]) if self._disturbances else None
        self._disturbances.append(checked_disturbances(disturbances, number))
        self._returns.append(result.episode_return)
        return float(corrected(np.array(self._returns), np.array(self._disturbances))[-1])
