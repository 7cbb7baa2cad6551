"""mu leads to goals with hindsight replay, where all rewards are below 0 and V has far to go at first."""

import gymnasium as gym
import numpy as np
import pytest
import torch as th
from gymnasium import spaces
from stable_baselines3 import HerReplayBuffer

from sarah.agents import NAF

STEPS, RADIUS, STEP, WALL = 30, 0.2, 0.15, 1.5


class Goals(gym.Env):
    """A point within walls moves by the action; a step costs 1 while it is not at the goal."""

    action_space = spaces.Box(-1, 1, (2,))
    place = spaces.Box(-WALL, WALL, (2,))
    observation_space = spaces.Dict(observation=place, achieved_goal=place, desired_goal=place)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=0)
        self.at, self.goal = self.np_random.uniform(-1, 1, (2, 2))
        self.steps = 0
        return self.observation(), {}

    def step(self, action):
        self.at, self.steps = np.clip(self.at + STEP * action, -WALL, WALL), self.steps + 1
        return self.observation(), float(self.compute_reward(self.at, self.goal, {})), False, self.steps == STEPS, {}

    def observation(self):
        at = self.at.astype(np.float32)
        return {"observation": at, "achieved_goal": at, "desired_goal": self.goal.astype(np.float32)}

    def compute_reward(self, achieved_goal, desired_goal, info):
        return -(np.linalg.norm(achieved_goal - desired_goal, axis=-1) > RADIUS).astype(np.float32)


@pytest.mark.slow
def test_mu_leads_to_the_goal_with_hindsight_replay():
    """Without the pull to the centre an entry of mu ends at one bound in all states, and leads right in two thirds."""
    model = NAF(
        "MultiInputPolicy",
        Goals(),
        gamma=0.95,
        replay_buffer_class=HerReplayBuffer,
        policy_kwargs=dict(net_arch=[32, 32]),
        seed=0,
        device="cpu",
    ).learn(1500)
    observations = model.replay_buffer.sample(500).observations
    with th.no_grad():
        mu = model.q_net.mu(observations).numpy()
    way = (observations["desired_goal"] - observations["observation"]).numpy()
    far = np.abs(way) > 0.3
    assert (np.sign(mu) == np.sign(way))[far].mean() > 0.85
    assert np.abs(mu.mean(axis=0)).max() < 0.6
