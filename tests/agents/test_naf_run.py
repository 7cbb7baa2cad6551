"""NAF runs wherever SB3's other off-policy algorithms run, also with its presets."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch as th
from gymnasium import spaces
from hypothesis import given, settings
from hypothesis import strategies as st
from stable_baselines3 import HerReplayBuffer
from stable_baselines3.common.env_util import make_vec_env
from stable_baselines3.common.envs import BitFlippingEnv, FakeImageEnv, SimpleMultiObsEnv
from stable_baselines3.common.utils import ConstantSchedule
from stable_baselines3.common.vec_env import DummyVecEnv, VecNormalize
from torch import nn

from sarah.agents import NAF, PRESETS, LocalNAF, MlpPolicy

SMALL: dict[str, Any] = dict(
    policy_kwargs=dict(net_arch=[16]), learning_starts=20, batch_size=8, buffer_size=300, seed=0
)


class Steady(gym.Env):
    """Any action space; checks that every action is a member of it."""

    observation_space = spaces.Box(-1, 1, (3,))

    def __init__(self, action_space: spaces.Box):
        self.action_space = action_space
        self.observation_space.seed(0)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        return self.observation_space.sample(), {}

    def step(self, action):
        assert self.action_space.contains(action), (action, self.action_space)
        truncated = self.np_random.random() < 0.1
        return self.observation_space.sample(), float(-np.square(action).sum()), False, truncated, {}


@pytest.mark.parametrize(("shape", "dtype"), [((1,), np.float32), ((2, 3), np.float64)])
def test_action_shapes_and_types(shape, dtype):
    space = spaces.Box(-0.1, 0.3, shape, dtype)
    model = NAF("MlpPolicy", Steady(space), exploration_std=1.0, **SMALL).learn(40)
    action, _ = model.predict(np.zeros(3, np.float32))
    assert action.shape == shape
    assert space.contains(action.astype(dtype))


@settings(max_examples=20)
@given(low=st.floats(-100, 100, width=32), size=st.floats(2**-7, 100, width=32), seed=st.integers(0, 1000))
def test_saturated_actions_are_in_the_space(low, size, seed):
    """Also where low + (high - low) is rounded to more than high, and with a linear mu far outside."""
    space = spaces.Box(np.float32(low), np.float32(low) + np.float32(size), (3,))
    policy = MlpPolicy(spaces.Box(-1, 1, (2,)), space, ConstantSchedule(1e-3), net_arch=[4], squash_mu=False)
    policy.q_net.mu_net[-1].bias.data = th.tensor([-50.0, 50.0, 1.0])
    action, _ = policy.predict(np.zeros(2, np.float32))
    assert space.contains(action)
    np.testing.assert_array_equal(action, [space.low[0], space.high[1], space.high[2]])
    # The module itself, for instance exported without predict(), keeps to the scaled space too
    np.testing.assert_array_equal(policy(th.zeros(1, 2)).detach().numpy(), [[-1.0, 1.0, 1.0]])


def test_predict():
    model = NAF("MlpPolicy", "Pendulum-v1", **SMALL).learn(30)
    one, state = model.predict(np.zeros(3, np.float32))
    many, _ = model.predict(np.zeros((4, 3), np.float32))
    assert one.shape == (1,) and many.shape == (4, 1) and state is None
    np.testing.assert_array_equal(many, np.tile(one, (4, 1)))
    # Exploration is of training: without it, predictions do not vary
    np.testing.assert_array_equal(one, model.predict(np.zeros(3, np.float32), deterministic=True)[0])
    with th.no_grad():
        mu = model.q_net.mu(th.zeros(1, 3)).numpy()[0]
    np.testing.assert_array_equal(one, -2 + 0.5 * (mu + 1) * 4)  # to the bit: 2 mu itself rounds otherwise


def pendulums(n_envs):
    return make_vec_env("Pendulum-v1", n_envs=n_envs, seed=0)


EXTRACTOR = dict(features_extractor_kwargs=dict(cnn_output_dim=16), net_arch=[16])
HINDSIGHT = dict(replay_buffer_class=HerReplayBuffer, replay_buffer_kwargs=dict(n_sampled_goal=2))


@pytest.mark.parametrize(
    ("policy", "make_env", "kwargs"),
    [
        ("MlpPolicy", lambda: pendulums(1), {}),
        ("MlpPolicy", lambda: pendulums(3), {"n_steps": 3}),
        ("MlpPolicy", lambda: VecNormalize(pendulums(3)), {"gradient_steps": -1}),
        (
            "CnnPolicy",
            lambda: FakeImageEnv(40, 40, n_channels=1, discrete=False),
            dict(batch_size=4, learning_starts=10),
        ),
        ("MultiInputPolicy", lambda: SimpleMultiObsEnv(discrete_actions=False), dict(policy_kwargs=EXTRACTOR)),
        ("MultiInputPolicy", lambda: DummyVecEnv([lambda: BitFlippingEnv(3, continuous=True)] * 2), HINDSIGHT),
    ],
)
def test_run(policy, make_env, kwargs):
    steps = 15 if policy == "CnnPolicy" else 60
    model = NAF(policy, make_env(), **{**SMALL, **kwargs}).learn(steps)
    assert model.num_timesteps == steps
    action, _ = model.predict(model.observation_space.sample())
    assert action.shape == model.action_space.shape
    env: Any = model.env
    fresh = NAF(policy, env, policy_kwargs=model.policy_kwargs, seed=model.seed)
    for old, new in zip(fresh.q_net.parameters(), model.q_net.parameters(), strict=True):
        assert th.isfinite(new).all() and not th.equal(old, new)


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
    assert env.score(model.predict(np.zeros(16, np.float32))[0]) > 0.9
    assert repr(PRESETS) == before


@pytest.mark.parametrize(
    ("arguments", "constant", "said"),
    [
        ({**SMALL, "learning_starts": 0}, -100.0, r"rewards of -9\d.* are far below 0.* as reward \+ 9\d"),
        (dict(learning_starts=5, n_steps=3), 100.0, r"rewards of 10\d on average are far above 0.* reward - 10\d"),
    ],
)
def test_rewards_far_from_zero_get_a_warning_once(arguments, constant, said):
    env = gym.wrappers.TransformReward(Cliff(0), lambda reward: float(reward) + constant)
    model = NAF("MlpPolicy", env, **{"seed": 0, **arguments})
    with pytest.warns(UserWarning, match=said) as seen:
        model.learn((arguments["learning_starts"] or 100) + 2).learn(7, reset_num_timesteps=False)
    assert len(seen) == 1


@pytest.mark.filterwarnings("ignore:rewards of")
@pytest.mark.parametrize(
    ("level", "mu", "curvature"),
    [(-10.0, (0.3, 0.15), (2.0, 0.5)), (0.0, (0.3, 0.06), (2.0, 0.5)), (30.0, (0.0, 0.08), (0.0, 0.2))],
)
def test_rewards_far_above_zero_make_the_parabola_flat_before_v_comes_to_them(level, mu, curvature):
    """Rewards far below 0 do less harm. The best action is 0.3, and the true curvature 2."""
    moved = gym.wrappers.TransformAction(
        Steady(spaces.Box(-2, 2, (1,))), lambda action: action - 0.3, spaces.Box(-1, 1, (1,))
    )
    env = gym.wrappers.TransformReward(moved, lambda reward: float(reward) + level)
    model = NAF("MlpPolicy", env, seed=0, policy_kwargs=dict(net_arch=[64, 64])).learn(400)
    assert model.predict(np.zeros(3, np.float32))[0].item() == pytest.approx(mu[0], abs=mu[1])
    found = model.q_net.lower(th.zeros(1, 3)).square().sum().item()
    assert found == pytest.approx(curvature[0], abs=curvature[1])


@pytest.mark.parametrize(("device", "algorithm"), [("meta", NAF), ("meta", LocalNAF), ("cuda", NAF)])
def test_updates_on_another_device(device, algorithm, monkeypatch):
    """All that an update computes is there: "meta" has the shapes of tensors, and refuses those of another device."""
    if device == "cuda" and not th.cuda.is_available():
        pytest.skip("there is no CUDA here")
    item = th.Tensor.item
    monkeypatch.setattr(th.Tensor, "item", lambda number: 0.5 if number.is_meta else item(number))
    model = algorithm("MlpPolicy", Cliff(0), gradient_steps=0, device=device, **SMALL).learn(20)
    model.train(2, 8)
    assert {tensor.device.type for tensor in model.policy.state_dict().values()} == {device}


@pytest.mark.filterwarnings("error")
def test_it_is_the_reward_of_a_step_that_counts():
    """A sum of three steps would be far below 0, a step is not."""
    env = gym.wrappers.TransformReward(gym.make("MountainCarContinuous-v0"), lambda reward: float(reward) - 3.0)
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


class Hill(Steady):
    """One action an episode; the top is at (0.5, -0.3)."""

    def __init__(self, scale: float, constant: float):
        super().__init__(spaces.Box(-1, 1, (2,)))
        self.scale, self.constant = scale, constant

    def step(self, action):
        observation, *_ = super().step(action)
        height = 1 - 2 * np.square(action - [0.5, -0.3]).sum()
        return observation, float(self.scale * height + self.constant), True, False, {}


@pytest.mark.filterwarnings("ignore:rewards of")
def test_the_size_of_rewards_decides_how_fast_mu_learns():
    """Low rewards push it away, high ones make the parabola flat, small ones make it steep."""

    def error(scale=1.0, constant=0.0) -> float:
        arguments: Any = {**SMALL, "gamma": 0.0, "batch_size": 32, "policy_kwargs": dict(net_arch=[32])}
        model = NAF("MlpPolicy", Hill(scale, constant), **arguments).learn(160)
        return float(np.linalg.norm(model.predict(np.zeros(3, np.float32))[0] - [0.5, -0.3]))

    assert error() < 0.2
    assert min(error(constant=-100), error(constant=100), error(scale=0.01)) > 0.35


def test_w_depends_on_the_exploration_where_v_does_not():
    """W is the mean of what was done near mu, and V the top of the parabola: about 0 here, whatever was done."""
    observation = th.zeros(1, 3)

    def values(std: float) -> tuple[float, float]:
        arguments: Any = {**SMALL, "gamma": 0.0, "batch_size": 32, "policy_kwargs": dict(net_arch=[32])}
        space = spaces.Box(-1, 1, (1,))
        model = NAF("MlpPolicy", Steady(space), exploration_std=std, **{**arguments, "learning_starts": 0}).learn(250)
        with th.no_grad():
            return model.q_net.value(observation).item(), model.q_net.target_value(observation).item()

    (narrow_v, narrow_w), (wide_v, wide_w) = values(0.1), values(0.5)
    assert wide_v - narrow_v > -0.05 and wide_w - narrow_w < -0.08
