"""What each part of NAF's preset for episodes of one step is worth, and what the paper's networks do without it.

The task is a stand-in that costs nothing: five numbers, a reward with noise, a hill with its top beside a cliff, and a
lower, wider hill elsewhere, both in other places for every seed. Judged is the agent's own best action, ``mu``, without
noise; and the best action of its replay buffer, if that knows one.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from statistics import median
from typing import Any

import gymnasium as gym
import numpy as np
import torch
from gymnasium import spaces
from stable_baselines3.common.callbacks import BaseCallback

from experiments.maker import ParallelExperiment
from experiments.record import Row
from sarah.agents import NAF, PRESETS, LocalNAF, RankReplayBuffer
from sarah.episode.workers import Workers

NOISE = 0.03
"""Standard deviation of the reward; the top of the hill is 1."""
CHECK_EVERY = 5
HELD = 3
ONE_STEP = PRESETS["one-step"]
NETWORKS = ONE_STEP["policy_kwargs"]
VARIANTS: dict[str, dict[str, Any]] = {
    "the preset": {},
    "rewards as they came": {"replay_buffer_class": RankReplayBuffer},
    "good and bad drawn alike": {"replay_buffer_kwargs": {"temperature": 0.0}},
    "Q may be flat": {"policy_kwargs": {**NETWORKS, "min_curvature": 0.0}},
    "mu and L share their layers": {
        "policy_kwargs": {**NETWORKS, "net_arch": dict(V=[32, 32], shared=[32, 32], mu=[], L=[])}
    },
    "ReLU instead of tanh": {"policy_kwargs": {**NETWORKS, "activation_fn": torch.nn.ReLU}},
    "noise stays at 0.3": {"exploration_std": 0.3},
    "nothing explored around the best": {"elite_share": 0.0},
    "all explored around the best": {"elite_share": 1.0},
    "the most promising of 16 draws": {"elite_draws": 16},
    "warm-up of 30": {"learning_starts": 30},
    "one update per episode": {"gradient_steps": 1},
    "20 updates per episode": {"gradient_steps": 20},
}
PAPER = PRESETS["paper"]
TANH = {"policy_kwargs": {**PAPER["policy_kwargs"], "activation_fn": torch.nn.Tanh}}
UPDATES = {name: ONE_STEP[name] for name in ("gradient_steps", "learning_starts", "batch_size")}
"""What the others spend on learning, for those that are not the preset."""
PLAIN: dict[str, dict[str, Any]] = {
    "NAF's defaults": {},
    "NAF's defaults, with V": {"policy_kwargs": {"net_arch": dict(V=[256, 256], shared=[256, 256], mu=[], L=[])}},
    "the paper's preset": PAPER,
    "the paper's preset with tanh": TANH,
    "the one-step preset with the paper's networks": {**ONE_STEP, **PAPER},
    "the same with tanh": {**ONE_STEP, **TANH},
}


class Hills(gym.Env):
    """A hill beside a cliff, and a decoy."""

    observation_space = spaces.Box(-1.0, 1.0, (16,))
    action_space = spaces.Box(-1.0, 1.0, (5,))

    def __init__(self, seed: int) -> None:
        self._generator = np.random.default_rng(seed)
        self._top = self._generator.uniform(-0.6, 0.6, 5)
        self._decoy = -np.sign(self._top) * self._generator.uniform(0.3, 0.7, 5)

    def score(self, action: np.ndarray) -> float:
        """Mean reward of an action."""
        from_top, from_decoy = action - self._top, action - self._decoy
        hill = np.exp(-3.0 * from_top @ from_top) if from_top[0] < 0.15 else 0.0
        return float(max(hill, 0.6 * np.exp(-1.5 * from_decoy @ from_decoy)))

    def _observe(self) -> np.ndarray:
        return self._generator.normal(0.0, 0.1, 16).clip(-1, 1).astype(np.float32)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict]:
        """Stand."""
        super().reset(seed=seed)
        return self._observe(), {}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict]:
        """The whole episode."""
        reward = self.score(action.astype(float)) + self._generator.normal(0.0, NOISE)
        return self._observe(), reward, True, False, {}


class Watch(BaseCallback):
    """Notes what the agent's own action is worth."""

    def __init__(self, env: Hills) -> None:
        super().__init__()
        self.scores: list[float] = []
        self._env = env

    def _on_step(self) -> bool:
        if self.num_timesteps % CHECK_EVERY == 0:
            action, _ = self.model.predict(np.zeros(16, np.float32), deterministic=True)
            self.scores.append(self._env.score(action.astype(float)))
        return True


@dataclass(frozen=True)
class NafPreset(ParallelExperiment):
    """Variants of NAF's preset on a stand-in for the robot, a training for each worker at a time.

    :param seeds: number of trainings of each variant
    :param episodes: number of episodes of a training
    """

    seeds: int = 8
    episodes: int = 200

    def rows(self) -> Iterator[Row]:
        """A row for each variant."""
        with Workers(self.workers) as workers:
            jobs = {
                name: [workers.submit(trained_scores, name, seed, self.episodes) for seed in range(self.seeds)]
                for name in (*VARIANTS, *PLAIN)
            }
            for name, running in jobs.items():
                curves, best = zip(*(job.result() for job in running), strict=True)
                row: dict[str, object] = {"variant": name, "seeds": self.seeds}
                for share in (0.8, 0.9):
                    counts = [episodes_until(curve, share) for curve in curves]
                    row[f"episodes_to_{100 * share:.0f}"] = median(counts)
                    row[f"reached_{100 * share:.0f}"] = sum(map(math.isfinite, counts))
                ends = [curve[-1] for curve in curves]
                row |= {"mu_median_score": median(ends), "mu_lowest_score": min(ends)}
                yield {**row, "best_action_median_score": None if None in best else median(best)}


def trained_scores(name: str, seed: int, episodes: int) -> tuple[list[float], float | None]:
    """Scores of mu along one training, and of the best action in the end, if the agent knows one.

    :param name: name of a variant
    :param seed: seed of the training
    :param episodes: number of its episodes
    """
    torch.set_num_threads(1)
    env = Hills(seed)
    settings = {**ONE_STEP, **VARIANTS[name]} if name in VARIANTS else {"gamma": 0.0, **UPDATES, **PLAIN[name]}
    watch = Watch(env)
    algorithm = LocalNAF if "elite_share" in settings else NAF
    model = algorithm("MlpPolicy", env, seed=seed, **settings).learn(episodes, callback=watch)
    if not isinstance(model.replay_buffer, RankReplayBuffer):
        return watch.scores, None
    return watch.scores, env.score(model.replay_buffer.best_action().astype(float))


def episodes_until(scores: list[float], score: float) -> float:
    """Episodes until a score is reached and held; infinite if it never is.

    :param scores: scores along a training
    :param score: score to reach
    """
    reached = [value >= score for value in scores]
    for index in range(len(reached) - HELD + 1):
        if all(reached[index : index + HELD]):
            return float(CHECK_EVERY * (index + 1))
    return float("inf")
