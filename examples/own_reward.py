"""A reward of your own as an environment: NAF learns to step with a low torso.

One sees a few of NAF's trials, each with its return. A reward knows everything of a control tick: :class:`sarah.Tick`.
"""

import dataclasses
from typing import Any

import gymnasium
import torch

import sarah
from sarah.agents import NAF


def reward(tick: sarah.Tick, config: sarah.EpisodeConfig) -> float:
    """Reward per second at the end of a control tick: steps, and centimetres below 0.85 m."""
    return tick.steps_per_second + 100.0 * (0.85 - tick.height)


LOW = dataclasses.replace(sarah.STEPPING, name="low", reward=reward, best_reward=5.0)


class Printed(gymnasium.Wrapper):
    """The environment, whose steps are printed."""

    def step(self, action: Any) -> tuple[Any, Any, bool, bool, dict[str, Any]]:
        """Simulate an episode."""
        outcome = self.env.step(action)
        print(f"return {outcome[1]:5.2f}, {outcome[4]['result'].steps} steps")
        return outcome


torch.set_num_threads(1)  # the networks are small: more threads only wait for each other
env = Printed(gymnasium.make("SarahEpisode-v0", task=LOW, time_limit=5))
NAF("MlpPolicy", env, gamma=0.0, learning_starts=5, gradient_steps=10, seed=0).learn(12)
