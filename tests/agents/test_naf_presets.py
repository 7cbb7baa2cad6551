"""The presets: "one-step" solves a task of one step, "paper" is the paper's networks."""

import warnings

import gymnasium as gym
import numpy as np
import pytest
from gymnasium import spaces
from torch import nn

from sarah.agents import NAF, PRESETS, LocalNAF


class Cliff(gym.Env):
    """One action of five numbers per episode; a noisy hill whose top is near a cliff."""

    observation_space = spaces.Box(-1, 1, (16,))
    action_space = spaces.Box(0, 2, (5,))

    def __init__(self, seed: int):
        self.top = np.random.default_rng(seed).uniform(-0.5, 0.5, 5)

    def score(self, action) -> float:
        difference = np.asarray(action, float) - 1 - self.top
        return 0.0 if difference[0] > 0.15 else float(np.exp(-2 * difference @ difference))

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        return self.np_random.uniform(-0.1, 0.1, 16).astype(np.float32), {}

    def step(self, action):
        reward = self.score(action) + self.np_random.normal(scale=0.05)
        return np.zeros(16, np.float32), reward, True, False, {}


def test_one_step_solves_a_hill_beside_a_cliff():
    env, before = Cliff(0), repr(PRESETS)
    model = LocalNAF("MlpPolicy", env, seed=0, **PRESETS["one-step"]).learn(100)
    assert env.score(model.predict(np.zeros(16, np.float32))[0]) > 0.85
    assert repr(PRESETS) == before


@pytest.mark.parametrize(
    ("algorithm", "arguments", "constant", "said"),
    [
        (LocalNAF, PRESETS["one-step"], -100.0, r"rewards of -9\d.* are far below 0.* as reward \+ 9\d"),
        (NAF, dict(learning_starts=5, n_steps=3), 100.0, r"rewards of 10\d on average are far above 0.* reward - 10\d"),
    ],
)
def test_rewards_far_from_zero_get_a_warning_once(algorithm, arguments, constant, said):
    env = gym.wrappers.TransformReward(Cliff(0), lambda reward: reward + constant)
    with pytest.warns(UserWarning, match=said) as seen:
        algorithm("MlpPolicy", env, seed=0, **arguments).learn(7).learn(7, reset_num_timesteps=False)
    assert len(seen) == 1


def test_it_is_the_reward_of_a_step_that_counts():
    """A sum of three steps would be far below 0, a step is not."""
    env = gym.wrappers.TransformReward(gym.make("MountainCarContinuous-v0"), lambda reward: reward - 3.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        NAF("MlpPolicy", env, seed=0, learning_starts=5, n_steps=3).learn(12)


def test_paper_networks():
    model = NAF("MlpPolicy", Cliff(0), seed=0, learning_starts=5, **PRESETS["paper"])

    def layers(net):
        return [layer.out_features if isinstance(layer, nn.Linear) else type(layer) for layer in net]

    assert layers(model.q_net.value_net) == [256, nn.Sigmoid] * 3 + [1]
    assert layers(model.q_net.mu_net) == [16, nn.Sigmoid] * 4 + [5]
    assert layers(model.q_net.lower_net) == [80, nn.Sigmoid] * 4 + [15]
    # The paper's bias of 1 is the centre of Box(0, 2)
    np.testing.assert_array_equal(model.predict(np.zeros(16, np.float32))[0], np.ones(5))
    model.learn(10)
    assert model.action_space.contains(model.predict(np.zeros(16, np.float32))[0])
