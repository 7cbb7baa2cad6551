"""NAF and DDPG on tasks of MuJoCo with two to six actions, as in Gu et al. (2016), along the training.

All trainings together take most of a day. So the course of each is kept, and not run again while its algorithm does
the same to the bit.
NAF and DDPG run with the defaults of their classes, DDPG with the noise that its documentation adds. NAF as published
has targets with V, and the exploration noise of DDPG.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

import gymnasium as gym
import numpy as np
import torch
from stable_baselines3 import DDPG
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.noise import NormalActionNoise
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm

from experiments.experiment import OnWorkers
from experiments.linear_quadratic import Watched
from experiments.made_with import short_hash
from experiments.record import Row
from experiments.trainings import identity, kept
from sarah.episode.workers import Workers

TASKS = ("HalfCheetah-v5", "Hopper-v5", "Walker2d-v5", "Reacher-v5", "Swimmer-v5")
ALGORITHMS = ("naf", "naf with V, as published", "ddpg")
PUBLISHED: dict[str, Any] = dict(V=[256, 256], shared=[256, 256], mu=[], L=[])
NOISE = 0.1
"""Standard deviation of the exploration noise of DDPG, and of NAF as published."""
EVALUATION_SEED = 10_000
FINGERPRINT_TASK, FINGERPRINT_STEPS = "Reacher-v5", 110
"""What tells one state of an algorithm's code from another: two actions, and ten updates."""


@dataclass(frozen=True)
class SeveralActions(OnWorkers):
    """NAF, NAF as published and DDPG on tasks with several actions, a training for each worker at a time.

    :param tasks: names of the tasks
    :param algorithms: names of the algorithms
    :param steps: number of steps of a training
    :param seeds: number of trainings of each algorithm
    :param evaluations: number of evaluations along a training, the last at its end
    :param episodes: number of episodes of an evaluation
    :param runs: folder that keeps the courses of the trainings; one that is there is not run again
    """

    tasks: tuple[str, ...] = TASKS
    algorithms: tuple[str, ...] = ALGORITHMS
    steps: int = 100_000
    seeds: int = 5
    evaluations: int = 10
    episodes: int = 5
    runs: Path = Path("runs/experiments")

    def rows(self) -> Iterator[Row]:
        """A row for each task, algorithm and evaluation."""
        every = self.steps // self.evaluations
        settings = (self.steps, every, self.episodes)
        folders = {
            algorithm: self.runs / f"several-actions-{identity((*settings, fingerprint(algorithm)), ())}"
            for algorithm in self.algorithms
        }
        with Workers(self.workers) as workers:
            jobs: dict[tuple[str, str], list[Any]] = {
                (task, algorithm): [] for task in self.tasks for algorithm in self.algorithms
            }
            for seed in range(self.seeds):  # the first seed of all tasks comes first
                for (task, algorithm), running in jobs.items():
                    file = folders[algorithm] / f"{task}-{algorithm}-s{seed}.json"
                    running.append(
                        workers.submit(kept, file, course, task, algorithm, seed, self.steps, every, self.episodes)
                    )
            for (task, algorithm), running in jobs.items():
                courses = [job.result() for job in running]
                for index in range(self.evaluations):
                    returns, ratios = zip(*(one[index] for one in courses), strict=True)
                    yield {
                        "task": task,
                        "algorithm": algorithm,
                        "steps": (index + 1) * every,
                        "seeds": self.seeds,
                        "return": median(returns),
                        "return_low": min(returns),
                        "return_high": max(returns),
                        "largest_v_over_bound": None if algorithm == "ddpg" else max(ratios),
                    }


class Evaluations(BaseCallback):
    """Mean returns of the same episodes along a training, and the largest V over its bound until then.

    :param env: environment of the episodes
    :param every: number of steps between evaluations
    :param episodes: number of episodes
    """

    def __init__(self, env: gym.Env, every: int, episodes: int) -> None:
        super().__init__()
        self.course: list[tuple[float, float]] = []
        self._env, self._every, self._episodes = env, every, episodes

    def _on_step(self) -> bool:
        if self.num_timesteps % self._every == 0:
            self._env.reset(seed=EVALUATION_SEED)
            mean_return = float(evaluate_policy(self.model, self._env, self._episodes)[0])
            self.course.append((mean_return, getattr(self.model, "highest_ratio", 0.0)))
        return True


def course(task: str, algorithm: str, seed: int, steps: int, every: int, episodes: int) -> list[tuple[float, float]]:
    """Return and largest V over its bound at each evaluation of a training.

    :param task: name of the task
    :param algorithm: name of the algorithm
    :param seed: seed of the training
    :param steps: number of its steps
    :param every: number of steps between evaluations
    :param episodes: number of episodes of an evaluation
    """
    torch.set_num_threads(1)
    evaluations = Evaluations(Monitor(gym.make(task)), every, episodes)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # That V runs away is what the rows say
        model(algorithm, gym.make(task), seed).learn(steps, callback=evaluations)
    return evaluations.course


def fingerprint(algorithm: str) -> str:
    """Hash of what an algorithm makes of a few steps: another state of the code with the same one is no other.

    :param algorithm: name of the algorithm
    """
    torch.set_num_threads(1)
    learned = model(algorithm, gym.make(FINGERPRINT_TASK), 0).learn(FINGERPRINT_STEPS)
    weights = [tensor.tolist() for tensor in learned.policy.state_dict().values()]
    return short_hash([weights, getattr(learned, "highest_ratio", 0.0)])


def model(algorithm: str, env: gym.Env, seed: int) -> OffPolicyAlgorithm:
    """An agent that has learned nothing yet.

    :param algorithm: name of the algorithm
    :param env: its environment
    :param seed: its seed
    """
    shared: dict[str, Any] = dict(seed=seed, device="cpu")
    if algorithm == "naf":
        return Watched("MlpPolicy", env, **shared)
    if algorithm == "ddpg":
        assert isinstance(env.action_space, gym.spaces.Box)
        (dimensions,) = env.action_space.shape
        noise = NormalActionNoise(np.zeros(dimensions), np.full(dimensions, NOISE))
        return DDPG("MlpPolicy", env, action_noise=noise, **shared)
    return Watched("MlpPolicy", env, exploration_std=NOISE, policy_kwargs=dict(net_arch=PUBLISHED), **shared)
