"""What the algorithms of stable-baselines3 that NAF is compared with need beside their defaults."""

from __future__ import annotations

import gymnasium as gym
import numpy as np
from stable_baselines3.common.noise import NormalActionNoise

NOISE = 0.1
"""Standard deviation of the exploration noise in the documentation of TD3 and DDPG."""


def documented_noise(env: gym.Env) -> NormalActionNoise:
    """The exploration noise that the documentation of TD3 and DDPG adds; by default they have none.

    :param env: environment of the actions
    """
    assert env.action_space.shape is not None
    return NormalActionNoise(np.zeros(env.action_space.shape), np.full(env.action_space.shape, NOISE))
