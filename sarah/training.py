"""Training: an algorithm by name, one simulation after another, everything of it in a run folder."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import torch
from stable_baselines3 import DDPG, SAC, TD3
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.env_util import make_vec_env
from stable_baselines3.common.logger import configure
from stable_baselines3.common.noise import NormalActionNoise
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm
from stable_baselines3.common.vec_env import DummyVecEnv, SubprocVecEnv, VecEnv

from sarah.agents.naf import NAF, PRESETS
from sarah.config import EpisodeConfig, Randomisation, TrainingConfig
from sarah.envs import SteppingEnv, observation_from, parameters_from
from sarah.episode import Episode, EpisodeSpec
from sarah.evaluation import Evaluation, simulate_all, summarise
from sarah.pattern_generator import PARAMETER_NAMES
from sarah.runs import RunFolder

UPDATES_PER_SIMULATION = 5
SUMMARY_EPISODES = 10
"""Episodes on unseen seeds that the closing summary's score is the median of."""
ACTOR_CRITIC_SETTINGS: dict[str, Any] = dict(
    learning_starts=40,
    batch_size=64,
    gamma=0.0,  # the reward is the return
    policy_kwargs=dict(net_arch=[64, 64]),
)
"""For stable-baselines3's own algorithms, whose defaults are for long episodes of small rewards."""


def make_algorithm(config: TrainingConfig, env: VecEnv) -> OffPolicyAlgorithm:
    """Make the agent that a configuration names, with the settings that suit one action per episode.

    :param config: of the training
    :param env: to learn from
    """
    common: dict[str, Any] = dict(seed=config.seed, gradient_steps=UPDATES_PER_SIMULATION * env.num_envs)
    if config.algo == "naf":
        return NAF("MlpPolicy", env, **{**PRESETS["one-step"], **common})
    settings = {**ACTOR_CRITIC_SETTINGS, **common}
    if config.algo == "sac":
        return SAC("MlpPolicy", env, **settings)
    noise = NormalActionNoise(np.zeros(len(PARAMETER_NAMES)), np.full(len(PARAMETER_NAMES), 0.2))
    return {"td3": TD3, "ddpg": DDPG}[config.algo]("MlpPolicy", env, action_noise=noise, **settings)


class EpisodeRecorder(BaseCallback):
    """Writes every simulation to ``episodes.csv`` and to the logger, and keeps to the budget.

    :param run: where to
    :param simulations: after which the training stops
    """

    def __init__(self, run: RunFolder, simulations: int) -> None:
        super().__init__()
        self._run = run
        self._simulations = simulations
        self._done = 0

    def _on_step(self) -> bool:
        for info in self.locals["infos"]:
            if self._done < self._simulations:
                self._run.append_episode(self._done, PARAMETER_NAMES, info)
                self._done += 1
                self._log(info)
        return self._done < self._simulations

    def _log(self, info: dict[str, Any]) -> None:
        x, y, _ = info["final_position"]
        values = {"return": info["episode_return"], "x": x, "y": y}
        for name in (
            "score", "steps_per_second", "duration", "event_driven_shift", "event_driven_lift", "sole_clearance"
        ):  # fmt: skip
            values[name] = info[name]
        for name, value in values.items():
            self.logger.record(f"episode/{name}", value)
        for name, value in zip(PARAMETER_NAMES, info["parameters"], strict=True):
            self.logger.record(f"parameters/{name}", value)
        self.logger.dump(self._done)


def train(config: TrainingConfig, run: RunFolder, progress_bar: bool = False) -> tuple[tuple[float, ...], Evaluation]:
    """Train, and write the run folder.

    :param config: of the training
    :param run: a new run folder
    :param progress_bar: whether to show one
    :return: the learned parameters, and how they do on unseen seeds
    """
    # The networks are small: more threads only wait for each other.
    torch.set_num_threads(1)
    env = make_vec_env(
        SteppingEnv,
        config.n_envs,
        seed=config.seed,
        env_kwargs={"config": config.episode},
        vec_env_cls=DummyVecEnv if config.n_envs == 1 else SubprocVecEnv,
    )
    try:
        model = make_algorithm(config, env)
        model.set_logger(configure(str(run.path), ["csv", "tensorboard"]))
        recorder = EpisodeRecorder(run, config.simulations)
        model.learn(config.simulations, callback=recorder, log_interval=None, progress_bar=progress_bar)  # type: ignore[arg-type]
        model.logger.close()
    finally:
        env.close()
    parameters = recommended_parameters(model, config.episode)
    evaluation = evaluate(parameters, config, range(SUMMARY_EPISODES))
    model.save(run.model_path)
    run.write_parameters(
        {
            "task": config.task,
            "algorithm": config.algo,
            "seed": config.seed,
            "simulations": config.simulations,
            "parameters": dict(zip(PARAMETER_NAMES, parameters, strict=True)),
            "evaluation": dataclasses.asdict(evaluation),
        }
    )
    return parameters, evaluation


def recommended_parameters(model: OffPolicyAlgorithm, config: EpisodeConfig) -> tuple[float, ...]:
    """What the agent does, without exploration, when the robot as designed stands before it.

    :param model: the agent
    :param config: settings of the episodes; the randomisation is left out
    :return: the parameters
    """
    nominal = dataclasses.replace(config, randomisation=Randomisation(enabled=False, start_speed=0.0))
    episode = Episode(nominal, seed=0)
    try:
        observation = observation_from(episode.stand())
    finally:
        episode.close()
    action, _ = model.predict(observation, deterministic=True)
    return parameters_from(action)


def evaluate(parameters: tuple[float, ...], config: TrainingConfig, seeds: range) -> Evaluation:
    """Simulate parameters on some seeds.

    :param parameters: of the pattern generator
    :param config: of the training they come from
    :param seeds: of the episodes; those below 2^31 are in no training
    """
    return summarise(simulate_all([EpisodeSpec(parameters, seed, config.task, config.episode) for seed in seeds]))
