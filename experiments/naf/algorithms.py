"""NAF, variants of it, and the algorithms of stable-baselines3 that it is compared with, by name."""

from __future__ import annotations

from typing import Any, NamedTuple

import gymnasium as gym
import numpy as np
import torch as th
from stable_baselines3 import DDPG, SAC, TD3
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.noise import NormalActionNoise
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm
from torch import nn

from sarah.agents import NAF
from sarah.agents.critic import QuadraticCritic, Values
from sarah.agents.policies import NAFPolicy

EXPLORATION_STD = 0.3
"""Standard deviation of NAF's exploration noise by default."""
DOCUMENTED_STD = 0.1
"""That of the noise in the documentation of TD3 and DDPG, whose classes have none by default."""
EVALUATION_SEED = 10_000


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


class Variant(NamedTuple):
    """A variant of NAF.

    :param critic: class of the critic
    :param values: name of the layers that values have: ``W``, or ``V`` as published
    :param dropout: share of the units of mu and L that are left out; without effect with ``V``
    :param exploration_std: standard deviation of the exploration noise
    """

    critic: type[QuadraticCritic] = QuadraticCritic
    values: str = "W"
    dropout: float = 0.2
    exploration_std: float = EXPLORATION_STD


VARIANTS = {
    "NAF": Variant(),
    "NAF, W of all actions": Variant(OfAllActions),
    "NAF, no dropout": Variant(dropout=0.0),
    "NAF, no normalisation": Variant(PlainValues),
    "NAF, no pull to the centre": Variant(NoPull),
    "NAF, noise of 0.5": Variant(exploration_std=0.5),
    "NAF, noise of 0.9": Variant(exploration_std=0.9),
    "NAF with V, as published": Variant(values="V"),
}
OTHERS: dict[str, type[OffPolicyAlgorithm]] = {"DDPG": DDPG, "TD3": TD3, "SAC": SAC}


def agent(
    algorithm: str, env: gym.Env, seed: int, layers: list[int] | None = None, policy: str = "MlpPolicy", **settings: Any
) -> OffPolicyAlgorithm:
    """An agent that has learned nothing yet, with the defaults of its class but for what is given.

    :param algorithm: name of a variant of NAF, or of another algorithm
    :param env: its environment
    :param seed: its seed
    :param layers: sizes of its hidden layers; by default those of its class
    :param policy: name of its policy
    :param settings: other arguments of its class
    """
    settings |= {"seed": seed, "device": "cpu"}
    if algorithm in VARIANTS:
        variant, layers = VARIANTS[algorithm], layers or [256, 256]
        net_arch = {variant.values: layers, "shared": layers, "mu": [], "L": []}
        settings["policy_kwargs"] = {"net_arch": net_arch, "dropout": variant.dropout}
        base = NAF.policy_aliases[policy]
        return Watched(_policy_with(variant.critic, base), env, exploration_std=variant.exploration_std, **settings)
    if algorithm in ("DDPG", "TD3"):
        zeros = np.zeros(env.action_space.shape)
        settings["action_noise"] = NormalActionNoise(zeros, np.full_like(zeros, DOCUMENTED_STD))
    return OTHERS[algorithm](policy, env, policy_kwargs={"net_arch": layers} if layers else None, **settings)


def _policy_with(critic: type[QuadraticCritic], base: type[NAFPolicy]) -> type[NAFPolicy]:
    """A policy with another critic."""

    class Policy(base):  # type: ignore[valid-type, misc]
        def make_q_net(self) -> QuadraticCritic:
            return critic(**self._update_features_extractor(self.net_args, features_extractor=None)).to(self.device)

    return Policy


def mean_return(model: OffPolicyAlgorithm, env: gym.Env, episodes: int) -> float:
    """Mean return of evaluation episodes, the same for every agent.

    :param model: the agent
    :param env: a new environment
    :param episodes: number of episodes
    """
    judged = Monitor(env)
    judged.reset(seed=EVALUATION_SEED)
    return float(evaluate_policy(model, judged, episodes)[0])
