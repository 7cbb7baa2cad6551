"""A reward of your own, by a wrapper of gymnasium: the score, less what the actuators' power costs.

One sees a few of NAF's trials, each with the package's reward, the return, and with the new one. ``info["result"]`` is
the whole :class:`sarah.EpisodeResult`, so any of its metrics can enter the reward.
"""

import gymnasium
import torch

import sarah
from sarah.agents import NAF

POWER_COST = 0.002
"""Loss of reward per watt of mean actuator power."""


class Thrifty(gymnasium.Wrapper):
    """The robot's environment with another reward."""

    def step(self, action):
        """Simulate the episode and judge it anew."""
        observation, episode_return, terminated, truncated, info = self.env.step(action)
        score, power = info["result"].score, info["result"].actuator_power
        reward = score - POWER_COST * power
        print(f"return {episode_return:.3f}, {power:4.1f} W: reward {reward:.3f}")
        return observation, reward, terminated, truncated, info


torch.set_num_threads(1)  # the networks are small: more threads only wait for each other
config = sarah.EpisodeConfig(time_limit=5.0)
env = Thrifty(gymnasium.make("SarahStepping-v0", config=config))
NAF("MlpPolicy", env, gamma=0.0, learning_starts=5, gradient_steps=10, seed=0).learn(12)
