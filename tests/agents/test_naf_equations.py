"""Q, V, mu and L against the equations, written as plain loops."""

from typing import Any

import numpy as np
import pytest
import torch as th
from gymnasium import spaces
from stable_baselines3.common.torch_layers import FlattenExtractor
from stable_baselines3.common.utils import ConstantSchedule
from torch import nn

from sarah.agents.critic import QuadraticCritic
from sarah.agents.policies import MlpPolicy

OBS_DIM = 4
ARCHITECTURES = {
    "shared": [16],
    "separate": dict(W=[16], mu=[16], L=[16]),
    "published": dict(V=[16], shared=[16], mu=[], L=[]),
    "both": dict(V=[16], shared=[12], mu=[8], L=[6]),
}
for_every_architecture = pytest.mark.parametrize("net_arch", ARCHITECTURES.values(), ids=ARCHITECTURES)


def make_policy(action_dim: int, seed: int = 0, **policy_kwargs) -> MlpPolicy:
    th.manual_seed(seed)
    box, actions = spaces.Box(-1, 1, (OBS_DIM,)), spaces.Box(-1, 1, (action_dim,))
    return MlpPolicy(box, actions, ConstantSchedule(1e-3), **{"net_arch": [16], **policy_kwargs})


def make_critic(action_dim: int, seed: int = 0, **policy_kwargs) -> QuadraticCritic:
    """A critic whose weights are all random and large, so that no term of Q is small."""
    policy = make_policy(action_dim, seed, **policy_kwargs)
    for parameter in policy.q_net.parameters():
        nn.init.normal_(parameter, std=0.5)
    policy.set_training_mode(False)
    return policy.q_net


def draw(action_dim: int, batch: int = 7, seed: int = 1) -> tuple[th.Tensor, th.Tensor]:
    generator = th.Generator().manual_seed(seed)
    obs = th.randn(batch, OBS_DIM, generator=generator)
    return obs, 2 * th.rand(batch, action_dim, generator=generator) - 1


def lower_by_hand(outputs: np.ndarray, action_dim: int) -> np.ndarray:
    """Equation 4 of Kouppas et al.: L1; L2 L3; L4 L5 L6; ... row by row."""
    lower = np.zeros((action_dim, action_dim))
    k = 0
    for i in range(action_dim):
        for j in range(i + 1):
            lower[i, j] = np.exp(np.clip(outputs[k], -5, 5)) if i == j else outputs[k]
            k += 1
    return lower


@pytest.mark.parametrize("min_curvature", [0.0, 0.5])
@for_every_architecture
@pytest.mark.parametrize("action_dim", [1, 5])
def test_q_is_equation_3(action_dim, net_arch, min_curvature):
    critic = make_critic(action_dim, net_arch=net_arch, min_curvature=min_curvature)
    obs, actions = draw(action_dim)
    with th.no_grad():
        q_values, mu = critic(obs, actions), critic.mu(obs)
        outputs = critic.lower_net(critic.shared_net(obs)).double().numpy()
        values = critic.value(obs).double().numpy()
        lowers = critic.lower(obs).numpy()
    assert q_values.shape == (7, 1)
    for n in range(7):
        lower = lower_by_hand(outputs[n], action_dim)
        np.testing.assert_allclose(lowers[n], lower, rtol=1e-6)
        difference = actions[n].double().numpy() - mu[n].double().numpy()
        product = np.array([[sum(a * b for a, b in zip(p, q, strict=True)) for q in lower] for p in lower])
        product += min_curvature * np.eye(action_dim)
        quadratic = sum(
            difference[i] * product[i, j] * difference[j] for i in range(action_dim) for j in range(action_dim)
        )
        assert q_values[n].item() == pytest.approx(values[n, 0] - 0.5 * quadratic, rel=1e-5, abs=1e-5)


def test_the_diagonal_is_bounded_and_finds_back():
    """Otherwise curvature that is at a bound in all states would stay there for good."""
    critic = make_critic(3)
    critic.lower_net[-1].bias.data = 1e9 * th.tensor([1.0, 0.0, -1.0, 0.0, 0.0, 1.0])
    diagonal = critic.lower(draw(3)[0]).detach().diagonal(dim1=1, dim2=2)
    assert {round(value, 3) for value in diagonal.log().unique().tolist()} == {-5.0, 5.0}
    critic = make_critic(1, net_arch=ARCHITECTURES["separate"])
    bias: Any = critic.lower_net[-1].bias
    for side in (-1.0, 1.0):
        bias.data[:] = 50.0 * side
        signs = (1e-3 * side, -1e-3 * side)
        slopes = [th.autograd.grad(sign * critic.lower(draw(1)[0]).sum(), bias)[0].item() for sign in signs]
        assert slopes[0] * side > 0 and slopes[1] == 0


def test_an_untrained_policy_proposes_the_centre():
    """The layers before it are not: there the gradient would be zero for good."""
    th.manual_seed(0)
    space = spaces.Box(np.array([0.0, -4.0], np.float32), np.array([2.0, 2.0], np.float32))
    net_arch = dict(V=[8], shared=[8], mu=[16, 16], L=[8])
    policy = MlpPolicy(spaces.Box(-1, 1, (OBS_DIM,)), space, ConstantSchedule(1e-3), net_arch=net_arch)
    np.testing.assert_array_equal(policy.predict(draw(2)[0].numpy())[0], np.tile([1.0, -1.0], (7, 1)))
    *hidden, output = [layer for layer in policy.q_net.mu_net if isinstance(layer, nn.Linear)]
    assert not output.weight.any() and not output.bias.any()
    assert len(hidden) == 2 and all(layer.weight.all() for layer in hidden)


def test_a_critic_by_itself_is_the_publications():
    """Images in [0, 1], mu behind a tanh, and no curvature but that of L. Its weights are the networks' only."""
    th.manual_seed(0)
    image = spaces.Box(0, 255, (3, 4, 4), np.uint8)
    extractor = FlattenExtractor(image)
    net_arch = dict(V=[8], shared=[], mu=[8], L=[8])
    critic = QuadraticCritic(image, spaces.Box(-1, 1, (2,)), extractor, extractor.features_dim, net_arch)
    for parameter in critic.parameters():
        nn.init.normal_(parameter, std=2.0)
    pictures = th.randint(0, 256, (5, 3, 4, 4), dtype=th.uint8)
    actions = th.full((5, 2), 0.5)
    with th.no_grad():
        features = pictures.flatten(1) / 255
        th.testing.assert_close(critic.value(pictures), critic.value_net(features))
        mu, lower = critic.mu(pictures), critic.lower(pictures)
        th.testing.assert_close(mu, th.tanh(critic.mu_net[:-1](features)))
        row = ((actions - mu).unsqueeze(1) @ lower).squeeze(1)
        expected = critic.value(pictures) - 0.5 * row.square().sum(dim=1, keepdim=True)
        th.testing.assert_close(critic(pictures, actions), expected)
    assert {name.split(".")[0] for name in critic.state_dict()} == {"value_net", "mu_net", "lower_net"}
    assert critic.min_curvature == 0.0


def test_the_first_layer_of_v_and_w_is_normalised_before_its_activation():
    critic = make_critic(2, net_arch=dict(W=[16, 12], mu=[8], L=[8]))
    obs, _ = draw(2)
    first, norm, _, *others = critic.value_net
    with th.no_grad():
        hidden = first(obs)
        centred = hidden - hidden.mean(dim=1, keepdim=True)
        normalised = centred / (centred.square().mean(dim=1, keepdim=True) + 1e-5).sqrt()
        expected = nn.Sequential(*others)((norm.weight * normalised + norm.bias).clamp(min=0))
        th.testing.assert_close(critic.value(obs), expected[:, :1])
        th.testing.assert_close(critic.target_value(obs), expected[:, 1:])


@for_every_architecture
def test_every_head_gets_a_gradient(net_arch):
    critic = make_critic(3, net_arch=net_arch)
    values = critic.all_values(*draw(3))
    (values.q + values.target).sum().backward()
    assert all(p.grad is not None and p.grad.abs().sum() > 0 for p in critic.parameters())


@pytest.mark.parametrize("net_arch", [[16], ARCHITECTURES["published"]], ids=["W", "V"])
def test_what_targets_take_shares_no_layer(net_arch):
    critic = make_critic(3, net_arch=net_arch)
    critic.target_value(draw(3)[0]).sum().backward()
    assert all(p.grad is None for net in (critic.shared_net, critic.mu_net, critic.lower_net) for p in net.parameters())


def test_v_and_w_are_two_outputs_of_the_same_layers():
    """Q does not reach the output of W: a parabola gets into targets only by the layers that both share."""
    critic = make_critic(3)
    obs, actions = draw(3)
    with th.no_grad():
        v, w = critic.value_net(obs).split(1, dim=1)
        values = critic.all_values(obs, actions)
        th.testing.assert_close(th.cat([critic.value(obs), values.best]), th.cat([v, v]))
        th.testing.assert_close(th.cat([critic.target_value(obs), values.target]), th.cat([w, w]))
    assert not th.allclose(v, w)
    critic(obs, actions).sum().backward()
    output: Any = critic.value_net[-1]
    assert output.weight.grad[0].any() and not output.weight.grad[1].any()
    assert output.bias.grad[0] != 0 and output.bias.grad[1] == 0


def test_hidden_layers_of_mu_and_l_have_dropout_where_there_is_w():
    def dropout(net_arch, *nets: str, **policy_kwargs) -> list[float]:
        critic = make_critic(2, net_arch=net_arch, **policy_kwargs)
        return [layer.p for net in nets for layer in getattr(critic, net).modules() if isinstance(layer, nn.Dropout)]

    separate = ARCHITECTURES["separate"]
    assert dropout([16, 16], "shared_net", dropout=0.3) == [0.3, 0.3]
    assert dropout(separate, "mu_net", "lower_net", dropout=0.3) == [0.3, 0.3]
    assert dropout(separate, "value_net", dropout=0.3) == []
    assert dropout(ARCHITECTURES["published"], "shared_net", "mu_net", "lower_net", "value_net") == []


def test_values_of_states_that_nobody_has_seen_are_bounded():
    """They grow along with the distance of a state otherwise, and targets with them."""
    th.manual_seed(0)
    far = th.randn(1000, OBS_DIM)

    def growth(net_arch) -> float:
        critic = make_critic(2, net_arch=net_arch)
        _, bias = critic.value_net[0].parameters()
        bias.data.zero_()
        with th.no_grad():
            near, further = (critic.target_value(distance * far).abs().max().item() for distance in (1e2, 1e6))
        return further / near

    assert growth([16, 16]) == pytest.approx(1, abs=0.01)
    assert growth(ARCHITECTURES["separate"]) == pytest.approx(1, abs=0.01)
    assert growth(ARCHITECTURES["published"]) > 1e3
    assert make_critic(2, net_arch=dict(W=[], mu=[], L=[])).value_net[0].out_features == 2  # nothing to normalise


def test_only_updates_leave_units_out():
    policy = make_policy(2)
    first: Any = policy.q_net.mu_net[0]
    nn.init.normal_(first.weight)
    obs = draw(2)[0]
    policy.set_training_mode(True)
    assert not th.equal(policy.q_net.mu(obs), policy.q_net.mu(obs))
    np.testing.assert_array_equal(policy.predict(obs.numpy())[0], policy.predict(obs.numpy())[0])
    th.testing.assert_close(policy.q_net_target.lower(obs), policy.q_net_target.lower(obs))


def test_heads_take_their_own_sizes():
    def sizes(net_arch):
        q_net = make_policy(2, net_arch=net_arch).q_net
        nets = (q_net.value_net, q_net.shared_net, q_net.mu_net, q_net.lower_net)
        return [[layer.out_features for layer in net if isinstance(layer, nn.Linear)] for net in nets]

    assert sizes(dict(V=[7, 8], mu=[], L=[5])) == [[7, 8, 1], [], [2], [5, 3]]
    assert sizes(dict(V=[7], shared=[6, 4], mu=[], L=[5])) == [[7, 1], [6, 4], [2], [5, 3]]
    assert sizes([6, 4]) == [[6, 4, 2], [6, 4], [2], [3]]
