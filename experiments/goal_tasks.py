"""NAF, DDPG and TD3 on small tasks of two to four actions, in most of which a point is to reach a place.

What makes them hard is that nothing tells the way before the place was reached once, that nothing brings the point
back, or noise beside a best action at the bounds.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from statistics import median
from typing import Any

import gymnasium as gym
import numpy as np
import torch as th
from gymnasium import spaces
from gymnasium.wrappers import TimeLimit
from stable_baselines3 import DDPG, TD3, HerReplayBuffer
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm

from experiments.baselines import documented_noise
from experiments.maker import ParallelExperiment
from experiments.naf_variants import NoPull, Watched, policy_with
from experiments.record import Row
from experiments.several_actions import EVALUATION_SEED
from sarah.agents import NAF
from sarah.agents.critic import QuadraticCritic
from sarah.episode.workers import Workers

WALL = 1.5
"""Largest coordinate of the point, in m."""
STEP = 0.15
"""Way of an action of 1, in m."""


class Point(gym.Env):
    """A point, x' = x + 0.15 u, which is cut at walls, and whose reward falls with its distance from 0.

    :param actions: number of actions, and of coordinates
    """

    drift = 0.0

    def __init__(self, actions: int) -> None:
        self.observation_space: spaces.Space = spaces.Box(-WALL, WALL, (actions,), dtype=np.float32)
        self.action_space = spaces.Box(-1.0, 1.0, (actions,), dtype=np.float32)
        self.at, self.action = np.zeros(actions), np.zeros(actions)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict]:
        """Begin anywhere within 1."""
        super().reset(seed=seed)
        self.at = self.np_random.uniform(-1.0, 1.0, len(self.at))
        return self.observation(), {}

    def step(self, action: np.ndarray) -> tuple[Any, float, bool, bool, dict]:
        """One step."""
        self.action = np.asarray(action, float)
        self.at = np.clip(self.at + STEP * self.action + self.drift, -WALL, WALL)
        return self.observation(), self.reward(), self.reached(), False, {}

    def observation(self) -> Any:
        """Where the point is."""
        return self.at.astype(np.float32)

    def reward(self) -> float:
        """Less the mean square of the coordinates."""
        return -float(np.square(self.at).mean())

    def reached(self) -> bool:
        """Whether the episode ends."""
        return False


class Drifting(Point):
    """A point that is carried off with every step; four fifths of an action hold it."""

    drift = 0.12


class NoisySlope(Point):
    """Wherever the point is, the reward is the mean of the actions, two of them with the other sign, and noise of 1."""

    def reward(self) -> float:
        """Slope along the action, with noise."""
        signs = np.where(np.arange(len(self.action)) % 2, -1.0, 1.0)
        return float((signs * self.action).mean() + self.np_random.normal())


class StepCost(Point):
    """Every step costs 1 until the point is at 0, which ends the episode."""

    radius = 0.25

    def reward(self) -> float:
        """Cost of a step."""
        return -1.0

    def reached(self) -> bool:
        """Whether all coordinates are near 0."""
        return bool(np.abs(self.at).max() < self.radius)


class Sparse(StepCost):
    """The only reward is 1 at 0, which ends the episode."""

    def reward(self) -> float:
        """1 at the end."""
        return float(self.reached())


class Goals(Point):
    """Every step costs 1 while the point is not at the goal of the episode, which the observation tells.

    :param actions: number of actions, and of coordinates
    """

    radius = 0.2

    def __init__(self, actions: int) -> None:
        super().__init__(actions)
        place = self.observation_space
        self.observation_space = spaces.Dict(observation=place, achieved_goal=place, desired_goal=place)
        self._goal = np.zeros(actions)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict]:
        """Begin anywhere within 1, with a goal within 1."""
        super().reset(seed=seed)
        self._goal = self.np_random.uniform(-1.0, 1.0, len(self.at))
        return self.observation(), {}

    def observation(self) -> dict[str, np.ndarray]:
        """Where the point is, and where it should be."""
        at = self.at.astype(np.float32)
        return {"observation": at, "achieved_goal": at, "desired_goal": self._goal.astype(np.float32)}

    def compute_reward(self, achieved_goal: np.ndarray, desired_goal: np.ndarray, info: Any) -> np.ndarray:
        """Rewards of places, of shape (n, actions), for as many goals; hindsight replay asks for them."""
        return -(np.linalg.norm(achieved_goal - desired_goal, axis=-1) > self.radius).astype(np.float32)

    def reward(self) -> float:
        """Cost of a step."""
        return float(self.compute_reward(self.at, self._goal, {}))


@dataclass(frozen=True)
class PointTask:
    """A task and what its agents need.

    :param make: makes the environment, without a time limit
    :param limit: number of steps of an episode
    :param policy: name of the policy
    :param settings: arguments of all algorithms
    """

    make: Callable[[], Point]
    limit: int
    policy: str = "MlpPolicy"
    settings: dict[str, Any] = field(default_factory=dict)

    def env(self) -> gym.Env:
        """A new environment."""
        return TimeLimit(self.make(), self.limit)


TASKS = {
    "a step costs 1": PointTask(partial(StepCost, 2), limit=50),
    "1 at the end only": PointTask(partial(Sparse, 2), limit=50),
    "hindsight replay": PointTask(
        partial(Goals, 2), 30, "MultiInputPolicy", dict(replay_buffer_class=HerReplayBuffer, gamma=0.95)
    ),
    "short episodes": PointTask(partial(Point, 4), limit=50),
    "long episodes": PointTask(partial(Point, 4), limit=1000),
    "drift": PointTask(partial(Drifting, 4), limit=50),
    "noisy slope": PointTask(partial(NoisySlope, 4), limit=50),
}
CRITICS = {"naf": QuadraticCritic, "naf, no pull to the centre": NoPull}
OTHERS: dict[str, type[OffPolicyAlgorithm]] = {"ddpg": DDPG, "td3": TD3}


@dataclass(frozen=True)
class GoalTasks(ParallelExperiment):
    """NAF, DDPG and TD3 on each task, with the defaults of their classes but for narrower layers.

    :param steps: number of steps of a training
    :param seeds: number of trainings of each algorithm
    :param episodes: number of evaluation episodes
    """

    steps: int = 4000
    seeds: int = 10
    episodes: int = 20

    def rows(self) -> Iterator[Row]:
        """A row for each task and algorithm."""
        with Workers(self.workers) as workers:
            jobs = {
                (task, algorithm): [
                    workers.submit(trained, task, algorithm, seed, self.steps, self.episodes)
                    for seed in range(self.seeds)
                ]
                for task in TASKS
                for algorithm in (*CRITICS, *OTHERS)
            }
            for (task, algorithm), running in jobs.items():
                returns, ratios = zip(*(job.result() for job in running), strict=True)
                yield {
                    "task": task,
                    "algorithm": algorithm,
                    "seeds": self.seeds,
                    "median_return": median(returns),
                    "lowest_return": min(returns),
                    "highest_return": max(returns),
                    "largest_v_over_bound": max(ratios) if algorithm in CRITICS else None,
                }


def trained(task: str, algorithm: str, seed: int, steps: int, episodes: int) -> tuple[float, float]:
    """Mean return of evaluation episodes after a training, and the largest V over its bound.

    :param task: name of the task
    :param algorithm: name of the algorithm
    :param seed: seed of the training
    :param steps: number of its steps
    :param episodes: number of evaluation episodes
    """
    th.set_num_threads(1)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # That V runs away is what the rows say
        model = agent(TASKS[task], algorithm, seed).learn(steps)
    judged = Monitor(TASKS[task].env())
    judged.reset(seed=EVALUATION_SEED)
    return float(evaluate_policy(model, judged, episodes)[0]), getattr(model, "highest_ratio", 0.0)


def agent(task: PointTask, algorithm: str, seed: int) -> OffPolicyAlgorithm:
    """An agent that has learned nothing yet.

    :param task: its task
    :param algorithm: name of the algorithm
    :param seed: its seed
    """
    env = task.env()
    common: dict[str, Any] = dict(seed=seed, device="cpu", policy_kwargs=dict(net_arch=[64, 64]), **task.settings)
    if algorithm in OTHERS:
        return OTHERS[algorithm](task.policy, env, action_noise=documented_noise(env), **common)
    return Watched(policy_with(CRITICS[algorithm], NAF.policy_aliases[task.policy]), env, **common)
