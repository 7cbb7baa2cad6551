"""A warm-up whose actions are spread evenly over the action space, so that a few find what works."""

import math

import numpy as np
from gymnasium import spaces
from stable_baselines3.common.noise import ActionNoise
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm

MOST_AT_ONCE = 1_000
"""Largest number of actions that are spread together: a longer warm-up is spread in parts."""


def latin_hypercube(count: int, dim: int, generator: np.random.Generator) -> np.ndarray:
    """
    Points of which each equal slice of each axis has one: a Latin hypercube (McKay et al. 1979)

    :param count: Number of points, and of slices
    :param dim: Number of axes
    :param generator: Source of the draws
    :return: Points from -1 to 1, of shape (count, dim)
    """
    slices = generator.permuted(np.tile(np.arange(count), (dim, 1)), axis=1).T
    return (slices + generator.random((count, dim))) * (2 / max(count, 1)) - 1


class EvenWarmUp(OffPolicyAlgorithm):
    """
    Mixin: the warm-up is a Latin hypercube, unless the first action is the centre of the action space.

    Where a single number decides whether an action is any good, a few uniform draws may all be bad. An agent that
    explores around the best of them does not leave it.
    """

    action_space: spaces.Box
    first_action_centre: bool
    _even_actions = np.empty((0, 0), np.float32)
    """Next actions of the warm-up, scaled."""

    def _sample_action(
        self,
        learning_starts: int,
        action_noise: ActionNoise | None = None,
        n_envs: int = 1,
    ) -> tuple[np.ndarray, np.ndarray]:
        if self.num_timesteps >= learning_starts or self.first_action_centre:
            return super()._sample_action(learning_starts, action_noise, n_envs)
        scaled_action = self._next_even_actions(learning_starts - self.num_timesteps, n_envs)
        if action_noise is not None:
            scaled_action = np.clip(scaled_action + action_noise(), -1, 1)
        return self.policy.unscale_action(scaled_action), scaled_action

    def _next_even_actions(self, steps: int, n_envs: int) -> np.ndarray:
        """
        The next actions of the warm-up.

        :param steps: Number of steps that are left of it
        :param n_envs: Number of environments
        :return: Scaled actions of shape (n_envs, *action shape)
        """
        shape = self.action_space.low.shape
        dim = math.prod(shape)
        if self.num_timesteps == 0 or len(self._even_actions) < n_envs:
            count = max(n_envs, math.ceil(min(steps, MOST_AT_ONCE) / n_envs) * n_envs)
            self._even_actions = latin_hypercube(count, dim, self.action_space.np_random).astype(np.float32)
        actions, self._even_actions = np.split(self._even_actions, [n_envs])
        return actions.reshape(n_envs, *shape)

    def _begin_at_centre(self, action: np.ndarray, scaled_action: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """
        Replace the very first action by the centre, if that is asked for.

        :param action: Actions, one of each environment
        :param scaled_action: The same, scaled; changed in place
        :return: Both
        """
        if self.first_action_centre and self.num_timesteps == 0:
            scaled_action[0] = 0.0  # Of the first environment: the others warm up as ever
            action = self.policy.unscale_action(scaled_action)
        return action, scaled_action
