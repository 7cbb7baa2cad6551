"""The learners of trainings: agents of stable-baselines3's kind, and searches.

All learn from corrected returns, without what known disturbances explain of them.
"""

from __future__ import annotations

import dataclasses
from collections import deque
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import torch
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.noise import NormalActionNoise
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm
from stable_baselines3.common.utils import LinearSchedule
from stable_baselines3.common.vec_env import VecEnv
from torch import nn

from sarah.agents import LocalNAF
from sarah.agents.corrections import corrected
from sarah.control.parameters import Parameters
from sarah.envs.episode_vec_env import EpisodeVecEnv
from sarah.envs.sarah_env import draw_seed, observation_from, parameters_from
from sarah.episode.episode import Episode, simulate
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import EpisodeSpec
from sarah.episode.task_answers import check_as_many, disturbances_of
from sarah.episode.tasks import Task
from sarah.episode.workers import Executor, Job
from sarah.errors import ConfigurationError, LearningError
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
from sarah.training.optimisers import OPTIMISERS
from sarah.training.plan import Plan
from sarah.training.recorder import EpisodeRecorder
from sarah.training.replay import LateRankReplayBuffer, LateSmoothedReplayBuffer

SCHEDULED_SHARE = 0.8
"""Share of a training after which NAF's noise around mu is narrowest."""
ALL_ALIKE = {"temperature": 0.0}
"""Arguments of the replay buffer with which it prefers no episode."""
ACTIVATIONS = {"tanh": nn.Tanh, "relu": nn.ReLU, "sigmoid": nn.Sigmoid}


def make_learner(plan: Plan, run: RunFolder, recorder: EpisodeRecorder, workers: Executor) -> Learner:
    """Make the learner that a training's settings name.

    :param plan: plan of the training
    :param run: run folder, in which an agent is saved
    :param recorder: recorder of the episodes
    :param workers: executor that simulates
    """
    if plan.config.algo in OPTIMISERS:
        return _Searching(plan, recorder, workers)
    return _Agent(plan, run, recorder, workers)


class _Agent(BaseCallback):
    """An agent of stable-baselines3's kind, which calls back for every step."""

    def __init__(self, plan: Plan, run: RunFolder, recorder: EpisodeRecorder, workers: Executor) -> None:
        super().__init__()
        self._config, self._run, self._recorder = plan.config, run, recorder
        self._env = EpisodeVecEnv(plan.config.task, plan.config.episode, 0, plan.config.slots, workers)
        self._agent = make_agent(plan, self._env)
        self._agent.set_logger(recorder.log)
        self._nominal = nominal_observation(plan.config)

    def learn(self, episodes: int) -> None:
        """Learn, and save the agent. When it goes on, its schedules are those of all its episodes together."""
        self._env.episodes = episodes
        self._agent.set_env(self._env)  # which is reset for the new episodes
        # The recorder logs every episode; stable-baselines3's own averages are left out.
        self._agent.learn(
            episodes + self._config.slots - 1,
            callback=self,
            log_interval=None,  # type: ignore[arg-type]
            reset_num_timesteps=False,
        )
        check_weights(self._agent)
        with replacing(self._run.model_path) as file:
            self._agent.save(file)  # type: ignore[arg-type]  # any file will do

    def choice(self) -> Parameters:
        """What the agent does before the robot as designed."""
        return chosen_parameters(self._agent, self._nominal, self._config.task)

    def _on_rollout_start(self) -> None:
        check_weights(self._agent)

    def _on_step(self) -> bool:
        for info in self.locals["infos"]:
            if info["transition"] is not None:  # the first steps only fill the slots
                self._recorder.record(info["spec"], info["result"], self.choice)
        return True


def check_weights(model: BaseAlgorithm) -> None:
    """Stop a training whose agent cannot learn any more.

    :param model: agent to check
    :raises LearningError: if one of its weights is not finite
    """
    norms = torch._foreach_norm(list(model.policy.parameters()))
    if not torch.isfinite(torch.stack(norms)).all():
        raise LearningError(
            f"the agent's weights are no longer finite after {model.num_timesteps} episodes: it cannot learn any more"
        )


def make_agent(plan: Plan, env: VecEnv) -> OffPolicyAlgorithm:
    """Make the agent that a training's settings name.

    :param plan: plan of the training
    :param env: environment to learn from
    """
    settings, task, seeds = plan.config.agent, plan.config.task, plan.seeds
    assert isinstance(settings, LearnerSettings)
    check_device(settings)
    # All algorithms of stable-baselines3's kind take these under the same names.
    common = {item.name: getattr(settings, item.name) for item in dataclasses.fields(LearnerSettings)}
    common["learning_starts"] = plan.start.warm_up
    common["replay_buffer_class"] = LateRankReplayBuffer
    algorithm, own_arguments = AGENTS[type(settings)]
    own = own_arguments(settings, task) | {"first_action_centre": plan.start.first is not None}
    model = algorithm("MlpPolicy", env, seed=seeds.algorithm, **(common | own))
    if isinstance(model, LocalNAF) and task.file is None:  # nobody can change the rewards of the package's own tasks
        model.watch.judged_rewards = True
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
    smoothing = dict(length_scales=task.box.length_scales) if settings.smoothed else {}
    return dict(
        replay_buffer_class=LateSmoothedReplayBuffer if settings.smoothed else LateRankReplayBuffer,
        replay_buffer_kwargs=dict(temperature=settings.temperature, **smoothing),
        max_grad_norm=settings.max_grad_norm,
        exploration_std=LinearSchedule(*settings.exploration_std, end_fraction=SCHEDULED_SHARE),
        elite_share=settings.elite_share,
        elite_std=LinearSchedule(*settings.elite_std, end_fraction=settings.elite_end),
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


AGENTS: dict[type[LearnerSettings], tuple[type[OffPolicyAlgorithm], Callable[[Any, Task], dict[str, Any]]]] = {
    NAFSettings: (LocalNAF, _naf_arguments),
    TD3Settings: (BeginningTD3, _td3_arguments),
    SACSettings: (BeginningSAC, _sac_arguments),
    DDPGSettings: (BeginningDDPG, _ddpg_arguments),
}
"""Class of the agent of every kind of settings, and what makes its arguments beyond those that all share."""


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


class _Searching:
    """A search that tries parameters, as many in flight as there are slots."""

    def __init__(self, plan: Plan, recorder: EpisodeRecorder, workers: Executor) -> None:
        config = self._config = plan.config
        self._recorder, self._workers = recorder, workers
        self._search = OPTIMISERS[config.algo](config.agent, config.task.box, plan.seeds.algorithm, plan.start)
        self._generator = np.random.default_rng(plan.seeds.episodes)
        self._running: deque[tuple[EpisodeSpec, Job]] = deque()
        self._returns: list[float] = []
        self._actions: list[Parameters] = []
        self._disturbances: list[Sequence[float]] = []

    def learn(self, episodes: int) -> None:
        """Try parameters, and learn from the returns."""
        config = self._config
        for _ in range(episodes):
            while len(self._running) == config.slots or not self._search.ready():
                self._tell_oldest()
            spec = EpisodeSpec(self._search.ask(), draw_seed(self._generator), config.task, config.episode)
            self._running.append((spec, self._workers.submit(simulate, spec)))
        while self._running:
            self._tell_oldest()

    def choice(self) -> Parameters:
        """What the search would choose."""
        return self._search.choice()

    def _tell_oldest(self) -> None:
        spec, job = self._running.popleft()
        result = job.result()
        self._search.tell(spec.parameters, self._corrected_return(spec, result))
        self._recorder.record(spec, result, self.choice)

    def _corrected_return(self, spec: EpisodeSpec, result: EpisodeResult) -> float:
        """Return without what the episode's disturbances explain of it, by all episodes so far."""
        disturbances = disturbances_of(spec)
        if disturbances is None:
            return result.episode_return
        check_as_many(spec.task, disturbances, self._disturbances)
        self._disturbances.append(disturbances)
        self._returns.append(result.episode_return)
        self._actions.append(spec.task.box.scaled(spec.parameters))
        told = (self._returns, self._actions, self._disturbances)
        return float(corrected(*(np.array(numbers) for numbers in told))[-1])


Learner = _Agent | _Searching
"""What learns a task's parameters from episodes, and can go on."""
