"""What the networks are trained towards: targets computed by hand, the loss, the target network."""

import math
from copy import deepcopy
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch as th
from gymnasium import spaces
from torch import nn

from sarah.agents import NAF

GAMMA = 0.9


class Corridor(gym.Env):
    """The observation is the step's index, the reward is 1 + index; every end is of the given kind."""

    observation_space = spaces.Box(0, 10, (1,))
    action_space = spaces.Box(-1, 1, (1,))

    def __init__(self, length: int = 3, timeout: bool = False):
        self.length, self.timeout, self.index = length, timeout, 0

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.index = 0
        return np.array([0.0], np.float32), {}

    def step(self, action):
        self.index += 1
        end = self.index == self.length
        obs = np.array([self.index], np.float32)
        return obs, float(self.index), end and not self.timeout, end and self.timeout, {}


WITH_W = dict(W=[8], shared=[8], mu=[], L=[])
WITHOUT_W = dict(V=[8], shared=[8], mu=[], L=[])


def make_model(env, net_arch=WITH_W, **kwargs):
    kwargs = {"gamma": GAMMA, "learning_starts": 1000, "buffer_size": 200, "seed": 0, **kwargs}
    return NAF("MlpPolicy", env, policy_kwargs=dict(net_arch=net_arch, dropout=0), **kwargs)


def fill_target(model) -> dict[int, float]:
    """Random weights for the target network; returns what targets take of every observation, W or V."""
    for parameter in model.q_net_target.parameters():
        nn.init.normal_(parameter)
    with th.no_grad():
        return {i: model.q_net_target.target_value(th.tensor([[float(i)]])).item() for i in range(11)}


def remembered(model) -> Any:
    """The batches that a model will sample."""
    batches: Any = []
    sample = model.replay_buffer.sample
    model.replay_buffer.sample = lambda *args, **kwargs: batches.append(sample(*args, **kwargs)) or batches[-1]
    return batches


def one_update(model, batch_size=64):
    """Run one update; returns its batch and the logged loss."""
    batches = remembered(model)
    weights = {k: v.clone() for k, v in model.q_net.state_dict().items()}
    model.train(1, batch_size)
    model.q_net.load_state_dict(weights)
    return batches[0], model.logger.name_to_value["train/loss"]


@pytest.mark.parametrize(
    ("net_arch", "n_steps", "timeout"),
    [(WITH_W, 1, False), (WITHOUT_W, 1, True), (WITH_W, 2, True), (WITHOUT_W, 2, False)],
)
def test_targets(net_arch, n_steps, timeout):
    """The end of an episode is worth nothing, unless a time limit made it; n steps are discounted n times."""
    model = make_model(Corridor(timeout=timeout), net_arch, n_steps=n_steps).learn(30)
    values = fill_target(model)
    batch, logged = one_update(model)

    def target(start: int) -> float:
        last = min(start + n_steps, 3)
        rewards = sum(GAMMA ** (k - start) * (k + 1) for k in range(start, last))
        bootstrap = 0.0 if last == 3 and not timeout else GAMMA ** (last - start) * values[last]
        return rewards + bootstrap

    # The newest transition cannot look further ahead than the buffer: it is the 30th, an end
    targets = np.array([target(int(start)) for start in batch.observations[:, 0]])
    assert len(set(targets.tolist())) == 3
    with th.no_grad():
        q_values = model.q_net(batch.observations, batch.actions)[:, 0].numpy()
    assert logged == pytest.approx(np.mean((q_values - targets) ** 2), rel=1e-5)


def test_without_a_future_the_reward_is_the_target():
    model = make_model(Corridor(), gamma=0.0).learn(30)
    for parameter in model.q_net_target.parameters():
        nn.init.constant_(parameter, np.inf)
    batch, logged = one_update(model)
    with th.no_grad():
        q_values = model.q_net(batch.observations, batch.actions)
    assert logged == pytest.approx((q_values - batch.rewards).square().mean().item(), rel=1e-5)


def test_target_network_starts_as_a_copy():
    model = make_model(Corridor())
    for target, online in zip(model.q_net_target.parameters(), model.q_net.parameters(), strict=True):
        assert th.equal(target, online) and target.data_ptr() != online.data_ptr()


def test_no_update_changes_nothing_and_each_samples_100():
    model = make_model(Corridor()).learn(30)
    batches, weights = remembered(model), model.policy.parameters_to_vector()
    model.train(0)
    np.testing.assert_array_equal(model.policy.parameters_to_vector(), weights)
    assert "train/loss" not in model.logger.name_to_value
    model.train(1)
    model.train(2, 16)
    assert [len(batch.rewards) for batch in batches] == [100, 16, 16]


@pytest.mark.parametrize(("norm", "is_clipped"), [(None, False), (1e-4, True)])
def test_gradients_are_clipped_unless_the_norm_is_none(norm, is_clipped):
    plain: Any = dict(optimizer_class=th.optim.SGD, net_arch=[8])
    model = NAF("MlpPolicy", Corridor(), learning_starts=50, max_grad_norm=norm, policy_kwargs=plain, seed=0).learn(30)
    before = model.policy.parameters_to_vector()
    model.train(1)
    step = np.linalg.norm(model.policy.parameters_to_vector() - before)
    assert (step < 1e-6) == is_clipped


def test_schedules_and_logs():
    model = make_model(Corridor(), learning_rate=lambda progress: 0.01 * (1 + progress), learning_starts=0)
    # Longer than the training, so that nothing is dumped
    model.learn(20, log_interval=100)
    assert model.policy.optimizer.param_groups[0]["lr"] == pytest.approx(0.01)
    logged = dict(model.logger.name_to_value)
    assert logged["train/learning_rate"] == pytest.approx(0.01)
    assert logged["train/exploration_std"] == pytest.approx(0.3)
    assert logged["train/n_updates"] == 20
    batch, _ = one_update(model)
    with th.no_grad():
        q_values = model.q_net(batch.observations, batch.actions)
    assert model.logger.name_to_value["train/q"] == pytest.approx(q_values.mean().item(), rel=1e-5)


def test_fast_updates_are_the_plain_ones(monkeypatch):
    """Fused Adam, averaging in one call and L in one piece change nothing but rounding: here all of it in loops."""
    env = Corridor()
    env.action_space = spaces.Box(-1, 1, (3,))
    settings: Any = dict(gamma=GAMMA, max_grad_norm=0.1, learning_starts=40, gradient_steps=0, seed=0)
    model = NAF("MlpPolicy", env, policy_kwargs=dict(dropout=0), **settings).learn(50)
    q_net, target = deepcopy(model.q_net), deepcopy(model.q_net_target)
    optimizer = th.optim.Adam(q_net.parameters(), lr=1e-3, foreach=False)
    batches = remembered(model)
    model.train(3, 16)

    for batch in batches:
        with th.no_grad():
            distances = [(batch.actions[n] - q_net.mu(batch.observations[n : n + 1])[0]).norm() ** 2 for n in range(16)]
        weights = [th.exp(-distance * 16 / sum(distances)) for distance in distances]
        q_loss, w_loss, mu_length = (th.zeros(()) for _ in range(3))
        for n in range(16):
            obs, next_obs = batch.observations[n : n + 1], batch.next_observations[n : n + 1]
            with th.no_grad():
                next_value = target.value_net(next_obs)[0, 1]
                wanted = batch.rewards[n, 0] + GAMMA * (1 - batch.dones[n, 0]) * next_value
            difference = batch.actions[n] - q_net.mu(obs)[0]
            outputs = q_net.lower_net(q_net.shared_net(obs))[0]
            advantage, k = 0.0, 0
            lower = {}
            for i in range(len(difference)):
                for j in range(i + 1):
                    lower[i, j] = outputs[k].clamp(-5, 5).exp() if i == j else outputs[k]
                    k += 1
            for j in range(len(difference)):
                advantage -= 0.5 * sum(difference[i] * lower[i, j] for i in range(j, len(difference))) ** 2
            v, w = q_net.value_net(obs)[0]
            q_loss += (v + advantage - wanted) ** 2 / 16
            w_loss += (0.8 * weights[n] / sum(weights) + 0.2 / 16) * (w - wanted) ** 2
            mu_length += sum(entry**2 for entry in q_net.mu(obs)[0]) / 16
        optimizer.zero_grad()
        (q_loss + w_loss + 0.1 * q_loss.detach() * mu_length).backward()
        gradients = [parameter.grad for parameter in q_net.parameters() if parameter.grad is not None]
        norm = math.sqrt(sum(gradient.square().sum().item() for gradient in gradients))
        for gradient in gradients:
            gradient *= min(1.0, settings["max_grad_norm"] / (norm + 1e-6))
        optimizer.step()
        for old, new in zip(target.parameters(), q_net.parameters(), strict=True):
            old.data = (1 - model.tau) * old.data + model.tau * new.data

    for plain, fast in ((q_net, model.q_net), (target, model.q_net_target)):
        for expected, found in zip(plain.parameters(), fast.parameters(), strict=True):
            th.testing.assert_close(found, expected, rtol=1e-4, atol=1e-5)
