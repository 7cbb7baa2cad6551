"""Replay buffers that store what :class:`~sarah.envs.episode_vec_env.EpisodeVecEnv` returns with its own action."""

from __future__ import annotations

from typing import Any

import numpy as np

from sarah.agents.buffers import RankReplayBuffer
from sarah.agents.smoothed_buffer import SmoothedReplayBuffer


class _LateTransitions:
    """Stores what :class:`EpisodeVecEnv` returns with the action that it came from, and what others return as it is."""

    def add(
        self,
        obs: np.ndarray,
        next_obs: np.ndarray,
        action: np.ndarray,
        reward: np.ndarray,
        done: np.ndarray,
        infos: list[dict[str, Any]],
    ) -> None:
        """Add the transition that ``infos`` names; none while the first episodes are in flight."""
        if "transition" in infos[0]:
            if infos[0]["transition"] is None:
                return
            obs, action, next_obs = (part[None] for part in infos[0]["transition"])
        super().add(obs, next_obs, action, reward, done, infos)  # type: ignore[misc]  # of the replay buffer


class LateRankReplayBuffer(_LateTransitions, RankReplayBuffer):
    """The replay buffer of learners without smoothing for :class:`EpisodeVecEnv`, and for any other environment."""


class LateSmoothedReplayBuffer(_LateTransitions, SmoothedReplayBuffer):
    """The replay buffer of local NAF for :class:`EpisodeVecEnv`, and for any other environment."""
