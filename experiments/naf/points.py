"""Tasks in most of which a point is to reach a place.

What makes them hard is that nothing tells the way before the place was reached once, that nothing brings the point
back, or noise beside a best action at the bounds.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces
from stable_baselines3 import HerReplayBuffer

WALL = 1.5
"""Largest coordinate of the point, in m."""
STEP = 0.15
"""Way of an action of 1, in m."""


class Point(gym.Env):
    """A point, x' = x + 0.15 u + drift, which is cut at walls.

    :param actions: number of actions, and of coordinates
    :param limit: number of steps of an episode
    :param drift: way by which each step carries the point off, in m
    :param radius: largest coordinate of a point whose episode ends, in m
    """

    settings: dict[str, Any] = {}
    """Arguments of all algorithms."""

    def __init__(self, actions: int, limit: int = 50, drift: float = 0.0, radius: float = 0.0) -> None:
        self.observation_space: spaces.Space = spaces.Box(-WALL, WALL, (actions,), dtype=np.float32)
        self.action_space = spaces.Box(-1.0, 1.0, (actions,), dtype=np.float32)
        self._limit, self._drift, self._radius = limit, drift, radius
        self.at, self.action = np.zeros(actions), np.zeros(actions)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict]:
        """Begin anywhere within 1."""
        super().reset(seed=seed)
        self._steps = 0
        self.at = self.np_random.uniform(-1.0, 1.0, len(self.at))
        return self.observation(), {}

    def step(self, action: np.ndarray) -> tuple[Any, float, bool, bool, dict]:
        """One step."""
        self.action = np.asarray(action, float)
        self.at = np.clip(self.at + STEP * self.action + self._drift, -WALL, WALL)
        self._steps += 1
        return self.observation(), self.reward(), self.arrived(), self._steps >= self._limit, {}

    def observation(self) -> Any:
        """Where the point is."""
        return self.at.astype(np.float32)

    def arrived(self) -> bool:
        """Whether all coordinates are near 0, which ends the episode."""
        return bool(np.abs(self.at).max() < self._radius)

    def reward(self) -> float:
        """Less the mean square of the coordinates."""
        return -float(np.square(self.at).mean())


class StepCost(Point):
    """Every step costs 1."""

    def reward(self) -> float:
        """Cost of a step."""
        return -1.0


class Sparse(Point):
    """The only reward is 1 at the end."""

    def reward(self) -> float:
        """1 at the end."""
        return float(self.arrived())


class NoisySlope(Point):
    """Wherever the point is, the reward is the mean of the actions, two of them with the other sign, and noise of 1."""

    def reward(self) -> float:
        """Slope along the action, with noise."""
        signs = np.where(np.arange(len(self.action)) % 2, -1.0, 1.0)
        return float((signs * self.action).mean() + self.np_random.normal())


class Goals(Point):
    """Every step costs 1 while the point is not at the goal of the episode, which the observation tells."""

    settings = {"policy": "MultiInputPolicy", "replay_buffer_class": HerReplayBuffer, "gamma": 0.95}

    def __init__(self, actions: int, limit: int) -> None:
        super().__init__(actions, limit)
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
        return -(np.linalg.norm(achieved_goal - desired_goal, axis=-1) > 0.2).astype(np.float32)

    def reward(self) -> float:
        """Cost of a step."""
        return float(self.compute_reward(self.at, self._goal, {}))


POINT_TASKS: dict[str, Callable[[], Point]] = {
    "a step costs 1": partial(StepCost, 2, radius=0.25),
    "1 at the end only": partial(Sparse, 2, radius=0.25),
    "hindsight replay": partial(Goals, 2, limit=30),
    "short episodes": partial(Point, 4),
    "long episodes": partial(Point, 4, limit=1000),
    "drift": partial(Point, 4, drift=0.12),  # four fifths of an action hold it
    "noisy slope": partial(NoisySlope, 4),
}
