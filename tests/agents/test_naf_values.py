"""V stays within what rewards allow, also where they hardly depend on actions; where it does not, a warning says so.

The tasks are linear-quadratic: V, mu and the curvature are known in closed form.
"""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch as th
from gymnasium import spaces
from stable_baselines3.common.buffers import BaseBuffer
from stable_baselines3.common.env_util import make_vec_env
from stable_baselines3.common.type_aliases import ReplayBufferSamples

from sarah.agents import NAF, RankReplayBuffer
from sarah.agents.critic import Values
from sarah.agents.losses import centre_loss, nearby_loss

LAYERS = [64, 64]
PUBLISHED = dict(V=LAYERS, shared=LAYERS, mu=[], L=[])
GAMMA = 0.99


class Drift(gym.Env):
    """17 states that drift by noise, and six actions that move them a little: what is done hardly counts."""

    observation_space = spaces.Box(-np.inf, np.inf, (17,))
    action_space = spaces.Box(-1, 1, (6,))

    def __init__(self, gain=2.0, noise=3.0, cost=0.0002, effort=0.005, seed=0):
        self.gain, self.noise, self.cost, self.effort = gain, noise, cost, effort
        self.generator = np.random.default_rng(seed)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.x, self.steps = self.generator.normal(0.0, 5 * self.noise, 17), 0
        return self.x.astype(np.float32), {}

    def step(self, action):
        reward = 0.5 - self.cost * self.x @ self.x - self.effort * action @ action + self.generator.normal(0.0, 0.1)
        self.x = 0.95 * np.roll(self.x, 1) + self.generator.normal(0.0, self.noise, 17)
        self.x[:6] += self.gain * action
        self.steps += 1
        return self.x.astype(np.float32), reward, False, self.steps == 200, {}


class Recorder(NAF):
    """NAF that keeps its largest ratio of V to the bound."""

    highest = 0.0

    def train(self, gradient_steps, batch_size=100):
        super().train(gradient_steps, batch_size)
        self.highest = max(self.highest, self.logger.name_to_value.get("train/value_over_bound", 0.0))


def trained(steps, **kwargs):
    arguments: Any = (
        dict(seed=0, learning_starts=1000, exploration_std=0.3, policy_kwargs=dict(net_arch=LAYERS)) | kwargs
    )
    return Recorder("MlpPolicy", Drift(), **arguments).learn(steps)


def test_v_stays_within_the_bound_where_the_published_runs_away():
    fast = dict(learning_starts=300, tau=0.1, batch_size=64)  # a target that follows faster shows it sooner
    held = trained(1600, **fast)
    with pytest.warns(UserWarning, match="it runs away"):
        published = trained(1600, policy_kwargs=dict(net_arch=PUBLISHED), **fast)
    assert held.highest < 1.0 and published.highest > 1.5
    observations = th.as_tensor(held.replay_buffer.observations[300:1600, 0])
    with th.no_grad():
        curvatures = [model.q_net.lower(observations).square().sum(dim=(1, 2)).mean() for model in (held, published)]
    assert curvatures[0] < 0.2 * curvatures[1]


def test_the_bound_is_that_of_the_environment(tmp_path, monkeypatch):
    """A V that was right for larger rewards is said to be too large for smaller ones."""
    monkeypatch.setattr("sarah.agents.naf_warnings.FRESH_UPDATES", 1)
    model = trained(1020, policy_kwargs=dict(net_arch=[8]))
    model.q_net.value_net[-1].bias.data.fill_(200.0)
    model.save(tmp_path / "agent")
    seen, env, rewards = model.watch, model.env, model.replay_buffer.rewards[:1020]
    assert env is not None and seen.value_bound == pytest.approx(np.abs(rewards).max() / (1 - GAMMA), rel=1e-5)
    assert seen.value_ceiling == pytest.approx(rewards.max() / (1 - GAMMA), rel=1e-5)
    model.set_env(env)
    assert model.watch is seen
    weak = gym.wrappers.TransformReward(Drift(), lambda reward: 0.1 * float(reward))
    model.set_env(weak)
    for agent in (model, Recorder.load(tmp_path / "agent", env=weak)):
        assert agent.watch.value_bound == 0.0
        agent.replay_buffer.reset()
        with pytest.warns(UserWarning, match="wider exploration_std"):
            agent.learn(1005)


@pytest.mark.parametrize(("gamma", "is_bounded"), [(0.0, False), (0.99, True), (1.0, False)])
def test_without_a_horizon_there_is_no_bound(gamma, is_bounded):
    model = trained(1020, gamma=gamma)
    assert ("train/value_over_bound" in model.logger.name_to_value) is is_bounded


def test_w_is_the_mean_of_what_actions_near_mu_led_to():
    """An action as far from mu as the mean counts by a factor of e less than mu, beside a share that all have."""
    targets = th.tensor([[1.0], [2.0], [6.0]])
    distances = th.tensor([[0.0], [1.0], [2.0]])
    weights = 0.8 * th.exp(-distances) / th.exp(-distances).sum() + 0.2 / 3
    w = th.zeros(1, 1, requires_grad=True)
    values = Values(targets, targets, w.expand(3, 1), targets, distances)
    for _ in range(100):
        (slope,) = th.autograd.grad(nearby_loss(values._replace(target=w.expand(3, 1)), targets), w)
        w = (w - 0.25 * slope).detach().requires_grad_()
    assert w.item() == pytest.approx(((weights * targets).sum() / weights.sum()).item(), rel=1e-4)
    targets, w = th.tensor([[1.0], [3.0]]), th.full((2, 1), 3.0, requires_grad=True)
    loss = nearby_loss(Values(targets, targets, w, targets, th.zeros(2, 1)), targets)  # all actions are mu itself
    (slope,) = th.autograd.grad(loss, w)
    assert loss.item() == pytest.approx(2.0) and slope.flatten().tolist() == pytest.approx([2.0, 0.0])


def test_the_more_actions_the_more_alike_are_the_weights():
    """Distances from mu are nearly equal then. What the nearer half of a batch weighs, and how many equal weights would
    make as sure a mean."""

    def shares(action_dim: int) -> tuple[float, float]:
        th.manual_seed(0)
        distances = th.randn(4000, action_dim).square().sum(dim=1, keepdim=True)
        w = th.ones(4000, 1, requires_grad=True)
        targets = th.zeros(4000, 1)
        nearby_loss(Values(targets, targets, w, targets, distances), targets).backward()
        assert w.grad is not None
        weights = w.grad / w.grad.sum()
        return weights[distances < distances.median()].sum().item(), 1.0 / (4000 * weights.square().sum().item())

    assert shares(1) == pytest.approx((0.71, 0.82), abs=0.01)
    assert shares(17) == pytest.approx((0.60, 0.94), abs=0.01)


@pytest.mark.parametrize(("transitions", "weight"), [(1, 0.1), (300, 0.1), (600, 0.05), (30_000, 0.001)])
def test_the_pull_of_mu_to_the_centre_fades_with_data(transitions, weight):
    """Mean of |mu|^2 over states is (1 + 4) / 2; the error of Q is in reward^2, and is not made smaller by it."""
    mu = th.tensor([[1.0, 0.0], [0.0, -2.0]], requires_grad=True)
    q_loss = th.tensor(9.0, requires_grad=True)
    other = th.zeros(2, 1)
    loss = centre_loss(Values(other, other, other, mu, other), q_loss, transitions)
    assert loss.item() == pytest.approx(weight * 9 * 2.5)
    (slope,) = th.autograd.grad(loss, mu)
    assert slope.numpy() == pytest.approx(weight * 9 * mu.detach().numpy())


RANKED = dict(replay_buffer_class=RankReplayBuffer, replay_buffer_kwargs=dict(temperature=0))


@pytest.mark.parametrize(("n_envs", "buffer"), [(1, dict(buffer_size=40)), (4, RANKED), (4, {})])
def test_all_transitions_count_beside_the_prior_of_mu(n_envs, buffer, monkeypatch):
    """Those of all environments and of earlier calls, and also those that a small replay buffer has forgotten."""
    counted: Any = []
    monkeypatch.setattr("sarah.agents.naf.centre_loss", lambda *args: counted.extend(args[2:]) or centre_loss(*args))
    env = make_vec_env(Drift, n_envs)
    model = NAF("MlpPolicy", env, learning_starts=20, batch_size=8, device="cpu", **buffer).learn(100)
    assert counted[-1] == 100
    model.learn(20).train(1, 8)
    assert counted[-1] == 120
    again = NAF("MlpPolicy", env, learning_starts=20, batch_size=8, device="cpu", **buffer)
    again.replay_buffer = model.replay_buffer
    again.learn(20)
    again.train(1, 8)
    assert counted[-1] == min(140, buffer.get("buffer_size", 140))


def test_a_replay_buffer_of_ones_own_needs_no_rewards():
    """Only the samples that it gives are looked at."""

    class Own(BaseBuffer):
        def __init__(self, *args, optimize_memory_usage=False, **kwargs):
            super().__init__(*args, **kwargs)
            self.kept = []

        def add(self, obs, next_obs, action, reward, done, infos):
            self.kept.append([th.as_tensor(part, dtype=th.float32) for part in (obs, action, next_obs, done, reward)])
            self.pos += 1

        def _get_samples(self, batch_inds, env=None):
            parts = zip(*(self.kept[index] for index in batch_inds), strict=True)
            obs, action, next_obs, done, reward = map(th.cat, parts)
            return ReplayBufferSamples(obs, action, next_obs, done.reshape(-1, 1), reward.reshape(-1, 1))

    kind: Any = Own  # stable-baselines3 takes it, although its types ask for a ReplayBuffer
    model = NAF("MlpPolicy", Drift(), learning_starts=20, replay_buffer_class=kind, device="cpu").learn(30)
    assert model.logger.name_to_value["train/loss"] > 0.0
