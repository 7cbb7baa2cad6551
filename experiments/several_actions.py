"""NAF and DDPG on tasks of MuJoCo with two to six actions, as in Gu et al. (2016), along the training.

All trainings together take most of a day. So the course of each is kept in a file beside the results, and not run again
while its algorithm does the same.
NAF and DDPG run with the defaults of their classes, DDPG with the noise that its documentation adds. NAF as published
has targets with V, and the exploration noise of DDPG. NAF can be tried with wider noise than its 0.3 as well.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import mean, median
from typing import Any

import gymnasium as gym
import numpy as np
import torch
from gymnasium.wrappers import ClipAction, TransformAction
from stable_baselines3 import DDPG
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm
from torch.nn.utils import parameters_to_vector

from experiments.baselines import NOISE, documented_noise
from experiments.maker import ParallelExperiment
from experiments.naf_variants import Watched
from experiments.record import Row
from sarah.episode.workers import Workers
from sarah.errors import ConfigurationError, unknown_name
from sarah.files import replace_text

TASKS = ("HalfCheetah-v5", "Hopper-v5", "Walker2d-v5", "Reacher-v5", "Swimmer-v5")
PUBLISHED: dict[str, Any] = dict(V=[256, 256], shared=[256, 256], mu=[], L=[])
NAFS: dict[str, dict[str, Any]] = {
    "naf": {},
    "naf, noise of 0.9": dict(exploration_std=0.9),
    "naf with V, as published": dict(exploration_std=NOISE, policy_kwargs=dict(net_arch=PUBLISHED)),
}
"""Arguments of each NAF beside the defaults of its class."""
ALGORITHMS = (*NAFS, "ddpg")
EVALUATION_SEED = 10_000
RECENT = 3
"""Number of evaluations up to one that are recent: one alone says little, as returns swing."""
FINGERPRINT_TASK, FINGERPRINT_STEPS = "Reacher-v5", 110
"""What tells one state of an algorithm's code from another: two actions, and ten updates."""
FINGERPRINT_TOLERANCE = 1e-3
"""Relative difference of fingerprints that another processor may make, and no other code."""

Course = list[tuple[float, float]]
"""Return and largest V over its bound at each evaluation of a training."""


@dataclass(frozen=True)
class SeveralActions(ParallelExperiment):
    """NAF, NAF as published and DDPG on tasks with several actions, a training for each worker at a time.

    :param tasks: names of the tasks
    :param algorithms: names of the algorithms
    :param steps: number of steps of a training
    :param seeds: number of trainings of each algorithm
    :param evaluations: number of evaluations along a training, the last at its end
    :param episodes: number of episodes of an evaluation
    :param action_repeat: number of steps for which an action is held
    :param action_scale: factor of actions, which are cut at their bounds
    :param courses: folder that keeps the courses of the trainings; one that is there is not run again
    """

    tasks: tuple[str, ...] = TASKS
    algorithms: tuple[str, ...] = ("naf", "naf with V, as published", "ddpg")
    steps: int = 100_000
    seeds: int = 5
    evaluations: int = 10
    episodes: int = 5
    action_repeat: int = 1
    action_scale: float = 1.0
    courses: Path = Path("results/several_actions")

    def rows(self) -> Iterator[Row]:
        """A row for each task, algorithm and evaluation."""
        for task in self.tasks:
            check_task(task)
        if self.steps % (self.evaluations * self.action_repeat):
            share = f"{self.evaluations} evaluations with actions of {self.action_repeat} steps"
            raise ConfigurationError(f"--steps must be a multiple of {share}, not {self.steps}")
        every = self.steps // self.evaluations
        fingerprints = {algorithm: fingerprint(algorithm) for algorithm in self.algorithms}
        with Workers(self.workers) as workers:
            jobs: dict[tuple[str, str], list[Any]] = {
                (task, algorithm): [] for task in self.tasks for algorithm in self.algorithms
            }
            for seed in range(self.seeds):  # the first seed of all tasks comes first
                for (task, algorithm), running in jobs.items():
                    changes = self.action_repeat, self.action_scale
                    training = Training(task, algorithm, seed, self.steps, every, self.episodes, *changes)
                    running.append(workers.submit(kept_course, training, self.courses, fingerprints[algorithm]))
            for (task, algorithm), running in jobs.items():
                courses = [job.result() for job in running]
                for index in range(self.evaluations):
                    returns, ratios = zip(*(one[index] for one in courses), strict=True)
                    recent = [
                        mean(value for value, _ in one[max(0, index + 1 - RECENT) : index + 1]) for one in courses
                    ]
                    yield {
                        "task": task,
                        "algorithm": algorithm,
                        "steps": (index + 1) * every,
                        "seeds": self.seeds,
                        "return": median(returns),
                        "return_low": min(returns),
                        "return_high": max(returns),
                        "recent_return": median(recent),
                        "recent_return_low": min(recent),
                        "recent_return_high": max(recent),
                        "largest_v_over_bound": None if algorithm == "ddpg" else max(ratios),
                    }


@dataclass(frozen=True)
class Training:
    """What decides the course of a training.

    :param task: name of the task
    :param algorithm: name of the algorithm
    :param seed: its seed
    :param steps: number of its steps
    :param every: number of steps between evaluations
    :param episodes: number of episodes of an evaluation
    :param action_repeat: number of steps for which an action is held
    :param action_scale: factor of actions, which are cut at their bounds
    """

    task: str
    algorithm: str
    seed: int
    steps: int
    every: int
    episodes: int
    action_repeat: int
    action_scale: float

    def env(self) -> gym.Env:
        """A new environment of the task."""
        return ActionRepeat(with_scaled_actions(gym.make(self.task), self.action_scale), self.action_repeat)


def with_scaled_actions(env: gym.Env, scale: float) -> gym.Env:
    """The environment with actions that are multiplied, and then cut at their bounds.

    :param env: the environment; its actions reach as far below 0 as above
    :param scale: factor of the actions
    """
    return TransformAction(ClipAction(env), lambda action: scale * action, env.action_space)


class ActionRepeat(gym.Wrapper):
    """Hold each action for some steps; its reward is their mean, so that the size of rewards stays the same.

    :param env: the environment
    :param steps: number of steps
    """

    def __init__(self, env: gym.Env, steps: int) -> None:
        super().__init__(env)
        self._steps = steps

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Steps with the same action, up to the end of the episode."""
        rewards = 0.0
        for _ in range(self._steps):
            observation, reward, terminated, truncated, info = self.env.step(action)
            rewards += float(reward)
            if terminated or truncated:
                break
        return observation, rewards / self._steps, terminated, truncated, info


class Evaluations(BaseCallback):
    """Mean returns of the same episodes along a training, and the largest V over its bound until then.

    :param training: the training
    """

    def __init__(self, training: Training) -> None:
        super().__init__()
        self.course: Course = []
        self._env, self._episodes = Monitor(training.env()), training.episodes
        self._action_repeat, self._every = training.action_repeat, training.every // training.action_repeat

    def _on_step(self) -> bool:
        if self.num_timesteps % self._every == 0:
            self._env.reset(seed=EVALUATION_SEED)
            mean_return = float(evaluate_policy(self.model, self._env, self._episodes)[0])
            self.course.append((self._action_repeat * mean_return, getattr(self.model, "highest_ratio", 0.0)))
        return True


def kept_course(training: Training, folder: Path, wanted: list[float]) -> Course:
    """The course of a training, from its file if that is of the same settings and the same algorithm.

    :param training: the training
    :param folder: folder of the files
    :param wanted: fingerprint of today's algorithm
    """
    name = f"{training.task}-{training.algorithm}-{training.steps}"
    name += f"-held-{training.action_repeat}" if training.action_repeat > 1 else ""
    name += f"-scaled-{training.action_scale:g}" if training.action_scale != 1.0 else ""
    name += f"-s{training.seed}"
    file = folder / f"{name.replace(', ', '-').replace(' ', '-')}.json"
    if file.exists():
        kept = json.loads(file.read_text(encoding="utf-8"))
        same = np.allclose(kept["fingerprint"], wanted, rtol=FINGERPRINT_TOLERANCE, atol=0.0)
        if same and kept["training"] == asdict(training):
            return kept["course"]
    course = course_of(training)
    folder.mkdir(parents=True, exist_ok=True)
    replace_text(file, json.dumps({"training": asdict(training), "fingerprint": wanted, "course": course}) + "\n")
    return course


def course_of(training: Training) -> Course:
    """The course of a training, which it runs.

    :param training: the training
    """
    torch.set_num_threads(1)
    evaluations = Evaluations(training)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # That V runs away is what the rows say
        agent = model(training.algorithm, training.env(), training.seed)
        agent.learn(training.steps // training.action_repeat, callback=evaluations)
    return evaluations.course


def fingerprint(algorithm: str) -> list[float]:
    """Length of all weights before and after a few updates, and of their change.

    Another state of the code with the same fingerprint is the same algorithm, but for what acts later in a
    training only: whoever changes that deletes the courses.

    :param algorithm: name of the algorithm
    """
    torch.set_num_threads(1)
    agent = model(algorithm, gym.make(FINGERPRINT_TASK), 0)
    before = parameters_to_vector(agent.policy.parameters()).detach().clone()
    agent.learn(FINGERPRINT_STEPS)
    after = parameters_to_vector(agent.policy.parameters()).detach()
    return [vector.norm().item() for vector in (before, after, after - before)]


def check_task(task: str) -> None:
    """Refuse the name of a task that gymnasium does not have.

    :param task: name of the task
    """
    try:
        gym.spec(task)
    except gym.error.Error as error:
        raise ConfigurationError(f"unknown task {task!r}: {error}") from error


def model(algorithm: str, env: gym.Env, seed: int) -> OffPolicyAlgorithm:
    """An agent that has learned nothing yet.

    :param algorithm: name of the algorithm
    :param env: its environment
    :param seed: its seed
    """
    if algorithm not in ALGORITHMS:
        raise ConfigurationError(unknown_name("algorithm", algorithm, ALGORITHMS))
    if algorithm in NAFS:
        return Watched("MlpPolicy", env, seed=seed, device="cpu", **NAFS[algorithm])
    return DDPG("MlpPolicy", env, seed=seed, device="cpu", action_noise=documented_noise(env))
