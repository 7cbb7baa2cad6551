"""NAF on standard tasks, against stable-baselines3's TD3, SAC and DDPG: mean return of evaluation episodes at the end.

Every algorithm runs with the defaults of its class, TD3 and DDPG with the noise that their documentation adds. NAF can
be tried with wider noise as well, and without parts of it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from statistics import median
from typing import Any

import gymnasium as gym
import torch
import tyro
from stable_baselines3 import DDPG, SAC, TD3
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm

from experiments.baselines import documented_noise
from experiments.maker import ParallelExperiment
from experiments.naf_variants import NoPull, policy_with
from experiments.record import Row
from sarah.agents import NAF
from sarah.episode.workers import Workers
from sarah.errors import ConfigurationError, unknown_name

NAF_VARIANTS: dict[str, tuple[type[OffPolicyAlgorithm], dict[str, Any]]] = {
    "naf": (NAF, {}),
    "naf, noise of 0.5": (NAF, {"exploration_std": 0.5}),
    "naf, no pull to the centre": (NAF, {"policy": policy_with(NoPull)}),
    "naf, no dropout": (NAF, {"policy_kwargs": {"dropout": 0.0}}),
}
"""Class of each, and its settings beside the defaults."""
ALGORITHMS = {**NAF_VARIANTS, "td3": (TD3, {}), "sac": (SAC, {}), "ddpg": (DDPG, {})}
"""The same of all algorithms."""
EVALUATION_SEED = 10_000


@dataclass(frozen=True)
class StandardTask(ParallelExperiment):
    """Algorithms on a task of gymnasium, a training for each worker at a time.

    :param task: name of the task
    :param steps: number of steps of a training
    :param algorithms: names of the algorithms
    :param seeds: number of trainings of each algorithm
    :param episodes: number of evaluation episodes
    """

    task: tyro.conf.Suppress[str]
    steps: int
    algorithms: tuple[str, ...] = ("naf", "td3", "sac", "ddpg")
    seeds: int = 5
    episodes: int = 20

    def rows(self) -> Iterator[Row]:
        """A row for each algorithm."""
        for algo in self.algorithms:
            if algo not in ALGORITHMS:
                raise ConfigurationError(unknown_name("algorithm", algo, ALGORITHMS))
        with Workers(self.workers) as workers:
            jobs = {
                algo: [
                    workers.submit(trained_return, self.task, algo, seed, self.steps, self.episodes)
                    for seed in range(self.seeds)
                ]
                for algo in self.algorithms
            }
            for algo, running in jobs.items():
                returns = [job.result() for job in running]
                yield {
                    "task": self.task,
                    "steps": self.steps,
                    "algorithm": algo,
                    "seeds": self.seeds,
                    "median_return": median(returns),
                    "lowest_return": min(returns),
                    "highest_return": max(returns),
                }


def trained_return(task: str, algo: str, seed: int, steps: int, episodes: int) -> float:
    """Mean return of evaluation episodes after a training, the same episodes for every algorithm and seed.

    :param task: name of the task
    :param algo: name of the algorithm
    :param seed: seed of the training
    :param steps: number of its steps
    :param episodes: number of evaluation episodes
    """
    torch.set_num_threads(1)
    env = gym.make(task)
    algorithm, settings = ALGORITHMS[algo]
    if algorithm in (TD3, DDPG):
        settings = settings | {"action_noise": documented_noise(env)}
    arguments: dict[str, Any] = {"policy": "MlpPolicy", **settings}
    model = algorithm(env=env, seed=seed, device="cpu", **arguments).learn(steps)
    judged = Monitor(gym.make(task))
    judged.reset(seed=EVALUATION_SEED)
    return float(evaluate_policy(model, judged, episodes)[0])
