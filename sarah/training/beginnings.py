"""stable-baselines3's algorithms, which begin as NAF does, so that only what they learn is compared.

They warm up as :class:`~sarah.agents.even_warm_up.EvenWarmUp` says, without noise: stable-baselines3 adds the action
noise, so that many actions lie on a bound. A saved model is that of the plain algorithm, and loads as such.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from stable_baselines3 import DDPG, SAC, TD3
from stable_baselines3.common.noise import ActionNoise

from sarah.agents.even_warm_up import EvenWarmUp


class _Beginning(EvenWarmUp):
    """Begins as NAF does.

    :param arguments: arguments of the algorithm
    :param first_action_centre: whether the first action is the centre of the action space
    :param keywords: arguments of the algorithm, by name
    """

    def __init__(self, *arguments: Any, first_action_centre: bool = False, **keywords: Any) -> None:
        super().__init__(*arguments, **keywords)
        self.first_action_centre = first_action_centre

    def _sample_action(
        self, learning_starts: int, action_noise: ActionNoise | None = None, n_envs: int = 1
    ) -> tuple[np.ndarray, np.ndarray]:
        noise = None if self.num_timesteps < learning_starts else action_noise
        return self._begin_at_centre(*super()._sample_action(learning_starts, noise, n_envs))


class BeginningTD3(_Beginning, TD3):
    """TD3 that begins as NAF does."""


class BeginningDDPG(_Beginning, DDPG):
    """DDPG that begins as NAF does."""


class BeginningSAC(_Beginning, SAC):
    """SAC that begins as NAF does."""
