"""What the experiments on NAF train, by name: NAF, NAF without one of its parts, and stable-baselines3's algorithms."""

from __future__ import annotations

import copy
import math
import warnings
from collections.abc import Mapping
from typing import Any, ClassVar, NamedTuple

import gymnasium as gym
import numpy as np
import torch as th
from gymnasium import spaces
from stable_baselines3 import DDPG, SAC, TD3
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.noise import NormalActionNoise
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm
from stable_baselines3.common.type_aliases import PyTorchObs
from torch import nn

from experiments.record import Row
from sarah.agents import NAF
from sarah.agents.critic import QuadraticCritic, Values
from sarah.agents.policies import NAFPolicy

EVALUATION_SEED = 10_000
DOCUMENTED_STD = 0.1
"""Standard deviation of the noise in the documentation of TD3 and DDPG, whose classes have none by default."""


class Watched(NAF):
    """NAF that remembers how near its V came to the bound since somebody asked."""

    highest_ratio = -math.inf

    def train(self, gradient_steps: int, batch_size: int = 100) -> None:
        """Train, and look at the log."""
        super().train(gradient_steps, batch_size)
        self.highest_ratio = max(self.highest_ratio, self.logger.name_to_value["train/value_over_bound"])

    def ratio(self) -> float | None:
        """Highest ratio since the last call; none without an update since."""
        found, self.highest_ratio = self.highest_ratio, -math.inf
        return found if math.isfinite(found) else None


class VInTargets(QuadraticCritic):
    """Critic whose targets take V; all else is as it is."""

    def target_value(self, obs: PyTorchObs) -> th.Tensor:
        """V of the next states."""
        return self.value(obs)


class EvenWeights(QuadraticCritic):
    """Critic whose W weighs all replayed actions alike."""

    def all_values(self, obs: PyTorchObs, actions: th.Tensor) -> Values:
        """Values that say of every action that it is at ``mu``."""
        values = super().all_values(obs, actions)
        return values._replace(distance=th.zeros_like(values.distance))


class NoPull(QuadraticCritic):
    """Critic whose mu is not pulled to the centre."""

    def all_values(self, obs: PyTorchObs, actions: th.Tensor) -> Values:
        """Values that say of every ``mu`` that it is at the centre."""
        values = super().all_values(obs, actions)
        return values._replace(mu=th.zeros_like(values.mu))


class PlainLayers(QuadraticCritic):
    """Critic whose V and W are not normalised."""

    def __init__(self, *arguments: Any, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self.value_net = nn.Sequential(*(layer for layer in self.value_net if not isinstance(layer, nn.LayerNorm)))


class AlteredPolicy(NAFPolicy):
    """Policy with a critic of another class, which subclasses name."""

    critic: ClassVar[type[QuadraticCritic]]

    def make_q_net(self) -> QuadraticCritic:
        """A critic with fresh weights."""
        net_args = self._update_features_extractor(self.net_args, features_extractor=None)
        return self.critic(**net_args).to(self.device)


class Learner(NamedTuple):
    """An algorithm and what is not its default."""

    algorithm: type[OffPolicyAlgorithm]
    noise: float | None = None  # standard deviation of the noise that is given; none leaves the algorithm its own
    critic: type[QuadraticCritic] | None = None  # class of NAF's critic; by default its own
    arguments: Mapping[str, Any] = {}


AS_NAF = {"tau": 0.02, "policy_kwargs": {"net_arch": [256, 256]}}
"""NAF's defaults that differ from those of TD3 and DDPG, beside the noise."""
COMPARED = {
    "NAF": Learner(Watched),
    "TD3": Learner(TD3, DOCUMENTED_STD),
    "SAC": Learner(SAC),
    "DDPG": Learner(DDPG, DOCUMENTED_STD),
}
NO_PARTS = "NAF, none of its parts"
V_IN_TARGETS = "NAF, V in the targets"
WITHOUT = {
    NO_PARTS: Learner(
        Watched, arguments={"policy_kwargs": {"net_arch": dict(V=[256] * 2, shared=[256] * 2, mu=[], L=[])}}
    ),
    V_IN_TARGETS: Learner(Watched, critic=VInTargets),
    "NAF, W without weights": Learner(Watched, critic=EvenWeights),
    "NAF, no dropout": Learner(Watched, arguments={"policy_kwargs": {"dropout": 0.0}}),
    "NAF, no normalisation": Learner(Watched, critic=PlainLayers),
    "NAF, no pull": Learner(Watched, critic=NoPull),
}
"""NAF without its own parts: without all of them, and without one at a time."""
AS_GU = "NAF, settings of Gu et al."
LIKE_GU = {
    AS_GU: Learner(
        Watched,
        arguments={
            "gradient_steps": 5,
            "tau": 0.001,
            "max_grad_norm": None,
            "policy_kwargs": {"net_arch": dict(V=[200] * 2, mu=[200] * 2, L=[200] * 2), "squash_mu": False},
        },
    )
}
"""Beside the targets also updates, target network, layers and linear mu of Gu et al. (2016); the noise is ours."""
WITH_NAFS_SETTINGS = {
    "TD3, NAF's settings": Learner(TD3, 0.3, arguments=AS_NAF),
    "DDPG, NAF's settings": Learner(DDPG, 0.3, arguments=AS_NAF),
    "SAC, NAF's settings": Learner(SAC, arguments={**AS_NAF, "learning_rate": 1e-3}),
}
"""With NAF's learning rate too; that of TD3 and DDPG is the same. SAC learns its own noise."""
WIDER = {f"NAF, noise of {std}": Learner(Watched, arguments={"exploration_std": std}) for std in (0.5, 0.9)}
LEARNERS = {**COMPARED, **WITHOUT, **LIKE_GU, **WITH_NAFS_SETTINGS, **WIDER}


def agent(name: str, env: gym.Env, seed: int) -> OffPolicyAlgorithm:
    """An agent that has learned nothing yet, with the defaults of its class but for what its name says."""
    of = LEARNERS[name]
    # stable-baselines3 writes into the arguments of the policy, and an agent must not find what another one wrote
    settings: dict[str, Any] = {"seed": seed, "device": "cpu", **copy.deepcopy(dict(of.arguments))}
    if of.noise is not None:
        zeros = np.zeros(spaces.flatdim(env.action_space))
        settings["action_noise"] = NormalActionNoise(zeros, np.full_like(zeros, of.noise))
    policy = type("Altered", (AlteredPolicy,), {"critic": of.critic}) if of.critic else "MlpPolicy"
    return of.algorithm(policy, env, **settings)


def mean_return(model: OffPolicyAlgorithm, env: gym.Env, episodes: int, evaluation: int = 0) -> float:
    """Mean return of evaluation episodes, the same for every agent, and others in each evaluation of a training."""
    judged = Monitor(env)
    judged.reset(seed=EVALUATION_SEED + evaluation)
    returns, _ = evaluate_policy(model, judged, episodes, return_episode_rewards=True)
    return float(np.mean(returns))


def course(name: str, task: str, seed: int, steps: int, evaluations: int, episodes: int) -> list[Row]:
    """A training: its returns along the way, and how near V came to its bound since the row before.

    :param name: learner
    :param task: environment
    :param seed: seed of the training
    :param steps: number of steps of the training
    :param evaluations: number of evaluations
    :param episodes: number of episodes of an evaluation
    """
    th.set_num_threads(1)
    model, judged = agent(name, gym.make(task), seed), gym.make(task)
    rows: list[Row] = []

    def evaluate(*_: Any) -> bool:
        if model.num_timesteps % (steps // evaluations) == 0:
            ratio = model.ratio() if isinstance(model, Watched) else None
            found = mean_return(model, judged, episodes, len(rows))
            rows.append({"steps": model.num_timesteps, "return": found, "v_over_bound": ratio})
        return True

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that V runs away is what the rows say
        model.learn(steps, callback=evaluate)
    return rows
