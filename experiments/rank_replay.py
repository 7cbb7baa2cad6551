"""What ranked replay makes of a noisy reward: how far V is too high, and whether mu moves to where the noise is.

Good episodes are replayed more often, and so are lucky ones. The task is a stand-in that costs nothing: two numbers, a
reward that falls from its top in the centre, and noise which is the same everywhere or grows with the first number.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from statistics import mean
from typing import Any

import gymnasium as gym
import numpy as np
import torch
from gymnasium import spaces

from experiments.maker import ParallelExperiment
from experiments.record import Row
from sarah.agents import PRESETS, LocalNAF, RankReplayBuffer
from sarah.episode.workers import Workers

NOISE = 0.3
"""Standard deviation of the reward in the centre. The mean reward falls from 1 there to 0 in the corners."""
NOISES = {"the same everywhere": 0.0, "grows with the action": 0.9}
"""How much the noise differs: from the centre to the end, as a share of the noise in the centre."""
TEMPERATURES = (4.0, 0.0)
OBSERVATION = np.zeros(2, np.float32)
NOISY_SIDE = 0.1
"""First number of mu from which on it counts as moved to the noisy side."""


class NoisyHill(gym.Env):
    """One action of two numbers an episode, with a noisy reward."""

    observation_space = spaces.Box(-1.0, 1.0, (2,))
    action_space = spaces.Box(-1.0, 1.0, (2,))

    def __init__(self, growth: float, seed: int) -> None:
        self._growth = growth
        self._generator = np.random.default_rng(seed)

    def score(self, action: np.ndarray) -> float:
        """Mean reward of an action."""
        return 1.0 - float(action @ action) / 2.0

    def noise(self, action: np.ndarray) -> float:
        """Standard deviation of an action's reward."""
        return NOISE * (1.0 + self._growth * float(action[0]))

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict]:
        """Stand."""
        super().reset(seed=seed)
        return OBSERVATION, {}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict]:
        """The whole episode."""
        reward = self.score(action) + self._generator.normal(0.0, self.noise(action))
        return OBSERVATION, reward, True, False, {}


@dataclass(frozen=True)
class RankReplay(ParallelExperiment):
    """Trainings of the preset on noisy rewards, with ranked replay and without.

    :param seeds: number of trainings of each kind
    :param episodes: number of episodes of a training
    """

    seeds: int = 5
    episodes: int = 200

    def rows(self) -> Iterator[Row]:
        """A row for each kind of noise and each temperature."""
        with Workers(self.workers) as workers:
            jobs = {
                (noise, temperature): [
                    workers.submit(learned, growth, temperature, seed, self.episodes) for seed in range(self.seeds)
                ]
                for noise, growth in NOISES.items()
                for temperature in TEMPERATURES
            }
            for (noise, temperature), running in jobs.items():
                errors, firsts, scores = zip(*(job.result() for job in running), strict=True)
                yield {
                    "noise": noise,
                    "temperature": temperature,
                    "seeds": self.seeds,
                    "v_error_in_deviations": mean(errors),
                    "highest_v_error_in_deviations": max(errors),
                    "mean_first_number_of_mu": mean(firsts),
                    "seeds_on_the_noisy_side": sum(first > NOISY_SIDE for first in firsts),
                    "mu_mean_score": mean(scores),
                }


def learned(growth: float, temperature: float, seed: int, episodes: int) -> tuple[float, float, float]:
    """How far V is too high, in standard deviations of the reward; the first number of mu; the mean reward of mu.

    :param growth: growth of the noise from the centre to the end of the first number
    :param temperature: temperature of the replay; 0 draws good and bad alike
    :param seed: seed of the training
    :param episodes: number of its episodes
    """
    torch.set_num_threads(1)
    env = NoisyHill(growth, seed)
    buffer = {"replay_buffer_class": RankReplayBuffer, "replay_buffer_kwargs": {"temperature": temperature}}
    settings = {**PRESETS["one-step"], **buffer}
    model = LocalNAF("MlpPolicy", env, seed=seed, device="cpu", **settings).learn(episodes)
    action = model.predict(OBSERVATION, deterministic=True)[0].astype(float)
    with torch.no_grad():
        value = model.q_net.value(torch.as_tensor(OBSERVATION)[None]).item()
    return (value - env.score(action)) / env.noise(action), float(action[0]), env.score(action)
