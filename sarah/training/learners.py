"""How parameters are learned: by an agent of stable-baselines3's kind, or by a black-box optimiser."""

from __future__ import annotations

import dataclasses
from collections import deque
from typing import Any

import numpy as np
from stable_baselines3 import DDPG, SAC, TD3
from stable_baselines3.common.noise import NormalActionNoise
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm
from stable_baselines3.common.vec_env import VecEnv

from sarah.agents import PRESETS, LocalNAF
from sarah.envs.episode_vec_env import EpisodeVecEnv
from sarah.envs.sarah_env import draw_seed, observation_from, parameters_from
from sarah.episode.episode import Episode, simulate
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import TASKS, Task
from sarah.episode.workers import Executor, Job
from sarah.files import replacing
from sarah.runs.config import SEARCHERS, TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.randomisation import Randomisation
from sarah.training.optimisers import Searcher, make_searcher
from sarah.training.recommendation import Parameters
from sarah.training.recorder import EpisodeRecorder, check_weights
from sarah.training.replay import LateRankReplayBuffer, LateReplayBuffer

WARM_UP = 30
"""Simulations before NAF's rivals learn; twice the slots, if that is more."""


def learn(
    config: TrainingConfig,
    simulations: int,
    run: RunFolder,
    recorder: EpisodeRecorder,
    workers: Executor,
) -> Parameters:
    """Learn by what the configuration names.

    :param config: of the training
    :param simulations: to learn from
    :param run: where an agent is saved
    :param recorder: of the simulations
    :param workers: that simulate
    :return: what the algorithm itself would choose in the end
    """
    if config.algo in SEARCHERS:
        return _search(config, simulations, recorder, workers)
    env = EpisodeVecEnv(config.task, config.episode, simulations, config.slots, workers)
    model = make_agent(config, env)
    model.set_logger(recorder.log)
    standing = nominal_observation(config)
    recorder.choose = lambda: chosen_parameters(model, standing, TASKS[config.task])
    # The recorder logs every simulation; stable-baselines3's own averages are left out.
    model.learn(
        simulations + config.slots - 1,
        callback=recorder,
        log_interval=None,  # type: ignore[arg-type]
    )
    check_weights(model)
    with replacing(run.model_path) as file:
        model.save(file)  # type: ignore[arg-type]  # any file will do
    return recorder.choose()


def spread_seed(config: TrainingConfig) -> int:
    """The seed of what learns and of its episodes: from neighbouring seeds come trainings that share no episode."""
    return int(np.random.SeedSequence(config.seed).generate_state(1)[0]) // 2


def make_agent(config: TrainingConfig, env: VecEnv) -> OffPolicyAlgorithm:
    """Make the reinforcement learner that a configuration names, with the settings that suit one action per episode.

    :param config: of the training
    :param env: to learn from
    """
    warm_up = PRESETS["one-step"]["learning_starts"] if config.algo == "naf" else WARM_UP
    # Learning begins with as many outcomes as are in flight.
    common: dict[str, Any] = dict(seed=spread_seed(config), learning_starts=max(warm_up, 2 * config.slots))
    if config.algo == "naf":
        common["first_action_centre"] = TASKS[config.task].neutral is not None  # few uniform draws come near V = 0
        one_step = {**PRESETS["one-step"], **common}
        return LocalNAF("MlpPolicy", env, replay_buffer_class=LateRankReplayBuffer, **one_step)
    # Their defaults are for long episodes of small rewards; here the reward is the return.
    settings = dict(
        batch_size=64,
        gamma=0.0,
        gradient_steps=PRESETS["one-step"]["gradient_steps"],
        policy_kwargs=dict(net_arch=[64, 64]),
        replay_buffer_class=LateReplayBuffer,
        **common,
    )
    if config.algo == "sac":
        return SAC("MlpPolicy", env, **settings)
    dimensions = len(TASKS[config.task].parameter_names)
    noise = NormalActionNoise(np.zeros(dimensions), np.full(dimensions, 0.2))
    return {"td3": TD3, "ddpg": DDPG}[config.algo]("MlpPolicy", env, action_noise=noise, **settings)


def nominal_observation(config: TrainingConfig) -> np.ndarray:
    """What the agent sees when the robot as designed stands before it.

    :param config: of the training; the randomisation is left out
    """
    nominal = dataclasses.replace(config.episode, randomisation=Randomisation(enabled=False, start_speed=0.0))
    episode = Episode(nominal, 0, TASKS[config.task])
    try:
        return observation_from(episode.stand())
    finally:
        episode.close()


def chosen_parameters(model: OffPolicyAlgorithm, observation: np.ndarray, task: Task) -> Parameters:
    """What the agent does, without exploration.

    :param model: the agent
    :param observation: that it acts on
    :param task: whose parameters they are
    """
    action, _ = model.predict(observation, deterministic=True)
    return parameters_from(action, task)


def _search(config: TrainingConfig, simulations: int, recorder: EpisodeRecorder, workers: Executor) -> Parameters:
    """Let a black-box optimiser try parameters, as many in flight as there are slots; its choice is returned."""
    task = TASKS[config.task]
    searcher = make_searcher(config.algo, len(task.parameter_names), spread_seed(config))
    generator = np.random.default_rng(spread_seed(config))
    recorder.choose = lambda: parameters_from(searcher.choice(), task)
    running: deque[tuple[np.ndarray, EpisodeSpec, Job]] = deque()
    for _ in range(simulations):
        while len(running) == config.slots or not searcher.ready():
            _tell_oldest(running, searcher, recorder)
        action = searcher.ask()
        spec = EpisodeSpec(parameters_from(action, task), draw_seed(generator), config.task, config.episode)
        running.append((action, spec, workers.submit(simulate, spec)))
    while running:
        _tell_oldest(running, searcher, recorder)
    return recorder.choose()


def _tell_oldest(
    running: deque[tuple[np.ndarray, EpisodeSpec, Job]], searcher: Searcher, recorder: EpisodeRecorder
) -> None:
    action, spec, job = running.popleft()
    result = job.result()
    searcher.tell(action, result.episode_return)
    recorder.record({**result.fields(), "seed": spec.seed, "parameters": spec.parameters})
