"""Batch normalisation and dropout: on while training, off while acting, statistics copied to the target."""

import numpy as np
import pytest
import torch as th
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
from torch import nn

from sarah.agents import NAF

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


def test_statistics_change_in_training_only(model):
    model.learn(20)
    start = running_mean(model.q_net)
    model.learn(20, reset_num_timesteps=False)
    learned = running_mean(model.q_net)
    np.testing.assert_array_equal(model.predict(OBS)[0], model.predict(OBS)[0])
    assert not th.equal(start, learned) and th.equal(learned, running_mean(model.q_net))


def test_a_pass_in_training_mode_an_update_none_in_the_target(model):
    model.learn(30)
    assert model.q_net.features_extractor.training_calls == 10
    assert model.q_net_target.features_extractor.training_calls == 0
    assert not th.equal(running_mean(model.q_net), th.zeros(16))
    assert th.equal(running_mean(model.q_net), running_mean(model.q_net_target))


def test_modes(model):
    model.policy.set_training_mode(True)
    assert model.policy.training and model.q_net.training and not model.q_net_target.training
    model.predict(OBS)
    assert not model.policy.training and not model.q_net.training
