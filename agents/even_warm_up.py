"""A warm-up whose actions are spread evenly over the action space, so that few of them find what works."""

import math

import numpy as np
from gymnasium import spaces
from stable_baselines3.common.noise import ActionNoise
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm


def latin_hypercube(count: int, dim: int, generator: np.random.Generator) -> np.ndarray:
    """
    Points of which each equal slice of each axis has one: a Latin hypercube (McKay et al. 1979)

    :param count: Number of points, and of slices
    :param dim: Number of axes
    :param generator: Source of the draws
    :return: Points from -1 to 1, of shape (count, dim)
    """
    slices = generator.permuted(np.tile(np.arange(count), (dim, 1)), axis=1).T
    return (slices + generator.random((count, dim))) * (2 / count) - 1


class EvenWarmUp(OffPolicyAlgorithm):
    """
    Mixin: the warm-up is a Latin hypercube, or the first action is the centre of the action space.

    Where a single number decides whether an action is any good, a few uniform draws may all be bad. An agent that
    explores around the best of them does not leave it.
    """

    action_space: spaces.Box
    first_action_centre: bool
    _even_actions: np.ndarray | None = None

    def _sample_action(
        self,
        learning_starts: int,
        action_noise: ActionNoise | None = None,
        n_envs: int = 1,
    ) -> tuple[np.ndarray, np.ndarray]:
        if self.num_timesteps < learning_starts and not self.first_action_centre:
            scaled_action = self._next_even_actions(learning_starts, n_envs)
            if action_noise is not None:
                scaled_action = np.clip(scaled_action + action_noise(), -1, 1)
            return self.policy.unscale_action(scaled_action), scaled_action
        action, scaled_action = super()._sample_action(learning_starts, action_noise, n_envs)
        if self.first_action_centre and self.num_timesteps == 0:
            scaled_action[0] = 0.0  # Of the first environment: the others warm up as ever
            action = self.policy.unscale_action(scaled_action)
        return action, scaled_action

    def _next_even_actions(self, learning_starts: int, n_envs: int) -> np.ndarray:
        """
        The next actions of the warm-up.

        :param learning_starts: Number of steps of the warm-up
        :param n_envs: Number of environments
        :return: Scaled actions of shape (n_envs, *action shape)
        """
        shape = self.action_space.low.shape
        count = math.ceil(learning_starts / n_envs) * n_envs
        if self._even_actions is None or self.num_timesteps == 0 or len(self._even_actions) != count:
            points = latin_hypercube(count, math.prod(shape), self.action_space.np_random)
            self._even_actions = points.astype(np.float32)
        return self._even_actions[self.num_timesteps : self.num_timesteps + n_envs].reshape(n_envs, *shape)
