"""NAF on a task whose truth is known: linear dynamics, a quadratic reward, and V, mu and P in closed form.

States follow x' = A x + B u + noise, the reward is offset - cost |x|^2 - effort |u|^2 + noise, and episodes end by
a time limit only. Then V is quadratic and mu linear in x, and the curvature P is the same everywhere.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from statistics import median
from typing import Any

import gymnasium as gym
import numpy as np
import torch as th
from gymnasium import spaces
from torch import nn

from experiments.experiment import OnWorkers
from experiments.record import Row
from sarah.agents import NAF, MlpPolicy
from sarah.agents.critic import QuadraticCritic, Values
from sarah.episode.workers import Workers

GAMMA = 0.99
STEPS_OF_AN_EPISODE = 200
LAYERS = [64, 64]
EXPLORATION_STD = 0.3
FRESH = 2000
"""Number of the newest transitions on which an agent is judged."""
EVALUATION_EPISODES = 10
EVALUATION_SEED = 10_000
SATURATED = 0.95
"""Size of an entry of mu from which on it counts as at the bound."""


@dataclass(frozen=True)
class Task:
    """A linear-quadratic task.

    :param states: number of states
    :param actions: number of actions
    :param decay: factor by which a state shrinks and turns at each step
    :param gain: effect of an action on the state
    :param noise: standard deviation of a state's noise
    :param cost: cost of a state's squared length
    :param effort: cost of an action's squared length
    :param offset: reward at rest
    :param reward_noise: standard deviation of the reward's noise
    """

    states: int
    actions: int
    decay: float = 0.95
    gain: float = 0.3
    noise: float = 0.1
    cost: float = 0.5
    effort: float = 0.5
    offset: float = 1.0
    reward_noise: float = 0.3


CLEAR: dict[str, Any] = {}
"""Differences of tasks in which an action decides much of what follows."""
FAINT: dict[str, Any] = dict(gain=2.0, noise=3.0, cost=0.0002, effort=0.04, offset=0.5, reward_noise=0.1)
"""Differences of tasks in which noise decides most of it, and states are large."""
TASKS = {
    "two actions, clear": Task(2, 2, **CLEAR),
    "six actions, clear": Task(6, 6, **CLEAR),
    "two actions, faint": Task(6, 2, **FAINT),
    "six actions, faint": Task(17, 6, **FAINT),
}


class LinearQuadratic(gym.Env):
    """A linear-quadratic task as an environment.

    :param task: the task
    :param seed: seed of its noise; the task itself is the same for every seed
    """

    def __init__(self, task: Task, seed: int) -> None:
        self.task = task
        fixed = np.random.default_rng(task.actions)
        self.a = task.decay * rotation(task.states, fixed)
        self.b = task.gain * rotation(task.states, fixed)[:, : task.actions] * np.linspace(1.0, 0.5, task.actions)
        self.observation_space = spaces.Box(-np.inf, np.inf, (task.states,))
        self.action_space = spaces.Box(-1.0, 1.0, (task.actions,))
        self._generator = np.random.default_rng(seed)
        self._solve()

    def _solve(self) -> None:
        """The best linear law, by iteration of the discounted Riccati equation."""
        task, a, b = self.task, self.a, self.b
        s, last = np.zeros((task.states, task.states)), np.inf
        while not np.allclose(s, last, rtol=1e-12, atol=0.0):
            last = s
            half_curvature = task.effort * np.eye(task.actions) + GAMMA * b.T @ s @ b
            law = GAMMA * np.linalg.solve(half_curvature, b.T @ s @ a)
            s = task.cost * np.eye(task.states) + GAMMA * a.T @ s @ (a - b @ law)
        self._cost_to_go, self._law = s, law
        self.curvature = 2.0 * half_curvature
        self._at_rest = (task.offset - GAMMA * task.noise**2 * np.trace(s)) / (1.0 - GAMMA)

    def value(self, states: np.ndarray) -> np.ndarray:
        """V of states, of shape (n, states)."""
        return self._at_rest - np.einsum("ni,ij,nj->n", states, self._cost_to_go, states)

    def mu(self, states: np.ndarray) -> np.ndarray:
        """The best actions, cut at their bounds."""
        return np.clip(-states @ self._law.T, -1.0, 1.0)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict]:
        """Begin near rest."""
        super().reset(seed=seed)
        self._x = self._generator.normal(0.0, 5.0 * self.task.noise, self.task.states)
        self._steps = 0
        return self._x.astype(np.float32), {}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict]:
        """One step."""
        task, x, u = self.task, self._x, np.asarray(action, float)
        reward = task.offset - task.cost * x @ x - task.effort * u @ u
        reward += self._generator.normal(0.0, task.reward_noise)
        self._x = self.a @ x + self.b @ u + self._generator.normal(0.0, task.noise, task.states)
        self._steps += 1
        return self._x.astype(np.float32), float(reward), False, self._steps == STEPS_OF_AN_EPISODE, {}


def rotation(size: int, generator: np.random.Generator) -> np.ndarray:
    """A random orthogonal matrix.

    :param size: number of its rows
    :param generator: source of the draws
    """
    q, r = np.linalg.qr(generator.normal(size=(size, size)))
    return q * np.sign(np.diag(r))


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


def policy_with(critic: type[QuadraticCritic]) -> type[MlpPolicy]:
    """A policy with another critic.

    :param critic: class of the critic
    """

    class Policy(MlpPolicy):
        def make_q_net(self) -> QuadraticCritic:
            net_args = self._update_features_extractor(self.net_args, features_extractor=None)
            return critic(**net_args).to(self.device)

    return Policy


WITH_W: dict[str, list[int]] = dict(W=LAYERS, shared=LAYERS, mu=[], L=[])
WITH_V: dict[str, list[int]] = dict(V=LAYERS, shared=LAYERS, mu=[], L=[])


@dataclass(frozen=True)
class Variant:
    """A way to make NAF's targets.

    :param net_arch: layers, with W or with V
    :param critic: class of the critic
    """

    net_arch: dict[str, list[int]]
    critic: type[QuadraticCritic] = QuadraticCritic


VARIANTS = {
    "W of actions near mu": Variant(WITH_W),
    "W of all actions": Variant(WITH_W, OfAllActions),
    "V, as published": Variant(WITH_V),
    "V less the cost of noise": Variant(WITH_V, ExpectedUnderNoise),
    "V, one L for all states": Variant(WITH_V, OneCurvature),
    "V, entries of L within 1": Variant(WITH_V, BoundedCurvature),
    "V, layer normalisation": Variant(WITH_V, NormalisedLayers),
}


@dataclass(frozen=True)
class Judgement:
    """What an agent has learned, beside the truth.

    :param value_over_bound: largest V of a batch in the training, over the bound
    :param value_error: error of V, mean
    :param curvature: largest eigenvalue of P, over the true one, mean
    :param gap: V - Q of replayed actions over the true one, means
    :param mu_error: root mean square error of mu over that of the centre
    :param saturated: share of mu's entries at their bound
    :param score: return from that of the centre, 0, to that of the best law, 1
    """

    value_over_bound: float
    value_error: float
    curvature: float
    gap: float
    mu_error: float
    saturated: float
    score: float


class Watched(NAF):
    """NAF that remembers how near its V came to the bound."""

    highest_ratio = 0.0

    def _check_values(self, *values: float) -> None:
        super()._check_values(*values)
        self.highest_ratio = max(self.highest_ratio, self.logger.name_to_value["train/value_over_bound"])


@dataclass(frozen=True)
class LinearQuadraticTasks(OnWorkers):
    """Variants of NAF on tasks whose truth is known.

    :param steps: number of steps of a training
    :param seeds: number of trainings of each variant
    """

    steps: int = 5000
    seeds: int = 2

    def rows(self) -> Iterator[Row]:
        """A row for each task, variant and width of the noise."""
        with Workers(self.workers) as workers:
            jobs = {
                (task, variant): [
                    workers.submit(judgement, task, variant, self.steps, seed) for seed in range(self.seeds)
                ]
                for task in TASKS
                for variant in VARIANTS
            }
            for (task, variant), running in jobs.items():
                found = [job.result() for job in running]
                middle = {name: median(getattr(one, name) for one in found) for name in vars(found[0])}
                yield {
                    "task": task,
                    "variant": variant,
                    "seeds": self.seeds,
                    "largest_v_over_bound": max(one.value_over_bound for one in found),
                    "v_error": middle["value_error"],
                    "curvature_over_true": middle["curvature"],
                    "gap_over_true": middle["gap"],
                    "mu_error_over_centre": middle["mu_error"],
                    "saturated_share": middle["saturated"],
                    "median_score": middle["score"],
                    "lowest_score": min(one.score for one in found),
                }


def judgement(task: str, variant: str, steps: int, seed: int) -> Judgement:
    """Train an agent and judge it.

    :param task: name of the task
    :param variant: name of the variant
    :param steps: number of steps of the training
    :param seed: its seed
    """
    th.set_num_threads(1)
    env = LinearQuadratic(TASKS[task], seed)
    chosen = VARIANTS[variant]
    settings: dict[str, Any] = dict(exploration_std=EXPLORATION_STD, policy_kwargs=dict(net_arch=chosen.net_arch))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # That V runs away is what the rows say
        model = Watched(policy_with(chosen.critic), env, seed=seed, device="cpu", **settings).learn(steps)
    buffer = model.replay_buffer
    assert buffer is not None
    newest = np.arange(buffer.pos - min(buffer.size(), FRESH), buffer.pos)  # In a full buffer, negative ones are older
    states, actions = (array[newest, 0].astype(float) for array in (buffer.observations, buffer.actions))
    observations = th.as_tensor(states, dtype=th.float32)
    with th.no_grad():
        value, mu, lower = (
            f(observations).double().numpy() for f in (model.q_net.value, model.q_net.mu, model.q_net.lower)
        )
    curvature = lower @ lower.transpose(0, 2, 1)
    true_mu = env.mu(states)
    return Judgement(
        value_over_bound=model.highest_ratio,
        value_error=float((value - env.value(states)).mean()),
        curvature=float(np.linalg.eigvalsh(curvature)[:, -1].mean() / np.linalg.eigvalsh(env.curvature)[-1]),
        gap=float(gaps(actions - mu, curvature).mean() / gaps(actions - true_mu, env.curvature[None]).mean()),
        mu_error=float(np.sqrt(np.square(mu - true_mu).mean() / np.square(true_mu).mean())),
        saturated=float((np.abs(mu) > SATURATED).mean()),
        score=score(task, lambda state: model.predict(state)[0]),
    )


def gaps(from_mu: np.ndarray, curvature: np.ndarray) -> np.ndarray:
    """V - Q of actions.

    :param from_mu: actions less mu, of shape (n, actions)
    :param curvature: P, of shape (n or 1, actions, actions)
    """
    return 0.5 * np.einsum(
        "ni,nij,nj->n", from_mu, np.broadcast_to(curvature, (len(from_mu), *curvature.shape[1:])), from_mu
    )


def score(task: str, law: Callable[[np.ndarray], np.ndarray]) -> float:
    """Return of a law in some episodes, from that of the centre, 0, to that of the best law, 1.

    :param task: name of the task
    :param law: action by state
    """
    env = LinearQuadratic(TASKS[task], EVALUATION_SEED)
    centre = np.zeros(TASKS[task].actions)
    learned, best, idle = (
        mean_return(task, one) for one in (law, lambda state: env.mu(state[None])[0], lambda state: centre)
    )
    return (learned - idle) / (best - idle)


def mean_return(task: str, law: Callable[[np.ndarray], np.ndarray]) -> float:
    """Mean return of some episodes, the same for every law.

    :param task: name of the task
    :param law: action by state
    """
    env, total = LinearQuadratic(TASKS[task], EVALUATION_SEED), 0.0
    for _ in range(EVALUATION_EPISODES):
        state, truncated = env.reset()[0], False
        while not truncated:
            state, reward, _, truncated, _ = env.step(law(state))
            total += reward
    return total / EVALUATION_EPISODES
