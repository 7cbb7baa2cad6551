"""Variants of NAF to compare: of its targets, its curvature and its layers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import torch as th
from torch import nn

from sarah.agents import NAF, MlpPolicy
from sarah.agents.critic import QuadraticCritic, Values
from sarah.agents.policies import NAFPolicy

LAYERS = [64, 64]
EXPLORATION_STD = 0.3


class Watched(NAF):
    """NAF that remembers how near its V came to the bound."""

    highest_ratio = 0.0

    def _check_values(self, *values: float) -> None:
        super()._check_values(*values)
        self.highest_ratio = max(self.highest_ratio, self.logger.name_to_value["train/value_over_bound"])


class OfAllActions(QuadraticCritic):
    """W counts all replayed actions alike, however far they are from mu."""

    def all_values(self, obs: th.Tensor, actions: th.Tensor) -> Values:
        """Values of actions, all of which count as near."""
        values = super().all_values(obs, actions)
        return values._replace(distance=th.zeros_like(values.distance))


class ExpectedUnderNoise(QuadraticCritic):
    """Targets take the mean of Q under noise of 0.3 around mu: V less half its variance times the trace of P."""

    variance = EXPLORATION_STD**2

    def target_value(self, obs: th.Tensor) -> th.Tensor:
        """Mean of Q under the noise."""
        return self.value(obs) - 0.5 * self.variance * self.lower(obs).square().sum(dim=(1, 2)).unsqueeze(1)


class SameEverywhere(nn.Module):
    """Outputs that do not depend on the input.

    :param size: number of outputs
    """

    def __init__(self, size: int) -> None:
        super().__init__()
        self.outputs = nn.Parameter(th.zeros(size))

    def forward(self, features: th.Tensor) -> th.Tensor:
        """The outputs, one row for each input."""
        return self.outputs.expand(len(features), -1)


class OneCurvature(QuadraticCritic):
    """One matrix L for all states."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.lower_net = SameEverywhere(len(self.columns))


class BoundedCurvature(QuadraticCritic):
    """Entries of L within one of zero."""

    def _entries(self, shared: th.Tensor) -> th.Tensor:
        outputs = self.lower_net(shared)
        return th.where(self.on_diagonal, outputs.sigmoid(), outputs.tanh())


class NormalisedLayers(QuadraticCritic):
    """Layer normalisation in the layers of V."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        *hidden, output = self.value_net
        layers = [
            part
            for layer in hidden
            for part in ((layer, nn.LayerNorm(layer.out_features)) if isinstance(layer, nn.Linear) else (layer,))
        ]
        self.value_net = nn.Sequential(*layers, output)


class PlainValues(QuadraticCritic):
    """No layer normalisation in the layers of V and W."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.value_net = nn.Sequential(*(layer for layer in self.value_net if not isinstance(layer, nn.LayerNorm)))


class NoPull(QuadraticCritic):
    """The loss does not pull mu to the centre of the action space."""

    def all_values(self, obs: th.Tensor, actions: th.Tensor) -> Values:
        """Values of actions, beside a mu that is at the centre already."""
        values = super().all_values(obs, actions)
        return values._replace(mu=th.zeros_like(values.mu))


def policy_with(critic: type[QuadraticCritic], base: type[NAFPolicy] = MlpPolicy) -> type[NAFPolicy]:
    """A policy with another critic.

    :param critic: class of the critic
    :param base: class of the policy
    """

    class Policy(base):  # type: ignore[valid-type, misc]
        def make_q_net(self) -> QuadraticCritic:
            net_args = self._update_features_extractor(self.net_args, features_extractor=None)
            return critic(**net_args).to(self.device)

    return Policy


WITH_W: dict[str, list[int]] = dict(W=LAYERS, shared=LAYERS, mu=[], L=[])
WITH_V: dict[str, list[int]] = dict(V=LAYERS, shared=LAYERS, mu=[], L=[])


@dataclass(frozen=True)
class Variant:
    """A variant of NAF.

    :param net_arch: layers, with W or with V
    :param critic: class of the critic
    :param dropout: share of the units of mu and L that are left out, with W
    """

    net_arch: dict[str, list[int]]
    critic: type[QuadraticCritic] = QuadraticCritic
    dropout: float = 0.2


VARIANTS = {
    "NAF": Variant(WITH_W),
    "W of all actions": Variant(WITH_W, OfAllActions),
    "no dropout": Variant(WITH_W, dropout=0.0),
    "no normalisation": Variant(WITH_W, PlainValues),
    "no pull to the centre": Variant(WITH_W, NoPull),
    "one L for all states": Variant(WITH_W, OneCurvature),
    "V, as published": Variant(WITH_V),
    "V less the cost of noise": Variant(WITH_V, ExpectedUnderNoise),
    "V, one L for all states": Variant(WITH_V, OneCurvature),
    "V, entries of L within 1": Variant(WITH_V, BoundedCurvature),
    "V, layer normalisation": Variant(WITH_V, NormalisedLayers),
}
