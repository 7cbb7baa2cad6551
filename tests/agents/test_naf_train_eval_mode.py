"""Batch normalisation and dropout: on while training, off while acting, statistics copied to the target."""

import numpy as np
import pytest
import torch as th
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
from torch import nn

from sarah.agents import NAF
from sarah.agents.dropout import ByteDropout

OBS = np.random.default_rng(0).normal(size=(10, 3)).astype(np.float32)


class NormalisedFeatures(BaseFeaturesExtractor):
    """Batch normalisation and dropout in front of the heads; counts its calls in training mode."""

    def __init__(self, observation_space, dropout: float = 0.5):
        super().__init__(observation_space, 16)
        self.net = nn.Sequential(nn.Linear(3, 16), nn.BatchNorm1d(16), nn.ReLU(), nn.Dropout(dropout))
        self.training_calls = 0

    def forward(self, observations):
        self.training_calls += self.training
        return self.net(observations)


@pytest.fixture
def model():
    policy_kwargs = dict(features_extractor_class=NormalisedFeatures, net_arch=[8])
    return NAF("MlpPolicy", "Pendulum-v1", policy_kwargs=policy_kwargs, learning_starts=20, batch_size=8, seed=0)


def running_mean(net):
    return net.features_extractor.net[1].running_mean.clone()


def test_a_pass_in_training_mode_an_update_none_in_the_target(model):
    model.learn(30)
    assert model.q_net.features_extractor.training_calls == 10
    assert model.q_net_target.features_extractor.training_calls == 0
    assert not th.equal(running_mean(model.q_net), th.zeros(16))
    assert th.equal(running_mean(model.q_net), running_mean(model.q_net_target))
    model.policy.set_training_mode(True)
    assert model.policy.training and model.q_net.training and not model.q_net_target.training
    model.predict(OBS)
    assert not model.policy.training and not model.q_net.training


def test_all_units_answer_whoever_asks_outside_of_an_update(model, tmp_path):
    model.save(tmp_path / "fresh")
    model.learn(30).save(tmp_path / "trained")
    for asked in (model, *(NAF.load(tmp_path / name) for name in ("fresh", "trained"))):
        assert not asked.policy.training and not asked.q_net.training


@pytest.mark.parametrize("share", [0.1, 0.9])
def test_the_share_is_left_out_and_the_mean_stays(share):
    th.manual_seed(0)
    units = ByteDropout(share)(th.ones(401, 999))  # 8 bytes are drawn at a time, which do not come out even
    assert units.shape == (401, 999)
    assert (units == 0).double().mean().item() == pytest.approx(share, abs=0.5 / 256 + 0.003)
    assert units.mean().item() == pytest.approx(1, abs=0.02)
    assert len(units.unique()) == 2


def test_units_are_left_out_independently():
    th.manual_seed(0)
    kept = (ByteDropout(0.5)(th.ones(2000, 64)) > 0).float()
    correlations = th.corrcoef(kept.T) - th.eye(64)
    assert correlations.abs().max() < 0.12  # five standard deviations of 2000 draws
    assert th.corrcoef(th.stack([kept[:-1].flatten(), kept[1:].flatten()]))[0, 1].abs() < 0.02


def test_what_a_seed_leaves_out_learns_nothing():
    def draw(seed, units):
        th.manual_seed(seed)
        return ByteDropout(0.25)(units)

    units = th.rand(64, 32, requires_grad=True)
    kept = draw(3, units)
    assert th.equal(kept, draw(3, units)) and not th.equal(kept, draw(4, units))
    kept.sum().backward()
    th.testing.assert_close(units.grad, th.where(kept == 0, 0.0, 1 / 0.75))
    assert ByteDropout(0.5).eval()(units) is units and ByteDropout(0.0)(units) is units
