"""NAF and its variants on tasks whose truth is known, beside DDPG."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from statistics import median

import gymnasium as gym
import numpy as np
import torch as th
from stable_baselines3 import DDPG
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm

from experiments.baselines import documented_noise
from experiments.maker import ParallelExperiment
from experiments.known_tasks import TASKS, KnownTask
from experiments.naf_variants import EXPLORATION_STD, LAYERS, VARIANTS, Watched, policy_with
from experiments.record import Row
from sarah.episode.workers import Workers

FRESH = 2000
"""Number of the newest transitions on which an agent is judged."""
EVALUATION_SEED = 10_000
SATURATED = 0.95
"""Size of an entry of mu from which on it counts as at the bound."""
DDPG_NAME = "DDPG"


@dataclass(frozen=True)
class Judgement:
    """What an agent has learned, beside the truth; DDPG has an action only.

    :param score: return from that of the centre, 0, to that of the best law, 1
    :param mu_error: root mean square error of mu over that of the centre
    :param saturated: share of mu's entries at their bound
    :param value_over_bound: largest V of a batch in the training, over the bound
    :param value_error: error of V, mean
    :param curvature: largest eigenvalue of P, mean
    :param gap: V - Q of replayed actions over the true one, means
    """

    score: float
    mu_error: float
    saturated: float
    value_over_bound: float | None = None
    value_error: float | None = None
    curvature: float | None = None
    gap: float | None = None


@dataclass(frozen=True)
class KnownTruth(ParallelExperiment):
    """Variants of NAF, and DDPG, on tasks whose truth is known.

    :param steps: number of steps of a training
    :param seeds: number of trainings of each variant
    :param episodes: number of evaluation episodes
    """

    steps: int = 5000
    seeds: int = 5
    episodes: int = 10

    def rows(self) -> Iterator[Row]:
        """A row for each task and variant."""
        with Workers(self.workers) as workers:
            jobs = {
                (task, variant): [
                    workers.submit(judgement, task, variant, self.steps, seed, self.episodes)
                    for seed in range(self.seeds)
                ]
                for task in TASKS
                for variant in (*VARIANTS, DDPG_NAME)
            }
            for (task, variant), running in jobs.items():
                found = [job.result() for job in running]
                row: Row = {"task": task, "variant": variant, "seeds": self.seeds}
                row["largest_v_over_bound"] = of_known(max, [one.value_over_bound for one in found])
                for column, name in MIDDLES.items():
                    row[column] = of_known(median, [getattr(one, name) for one in found])
                yield {
                    **row,
                    "true_curvature": TASKS[task](0).curvature,
                    "lowest_score": min(one.score for one in found),
                }


MIDDLES = {
    "v_error": "value_error",
    "curvature": "curvature",
    "gap_over_true": "gap",
    "mu_error_over_centre": "mu_error",
    "saturated_share": "saturated",
    "median_score": "score",
}
"""Columns that are medians of the seeds, and what of."""


def of_known(function: Callable[[list[float]], float], values: list[float | None]) -> float | None:
    """A statistic of values; none if they are not known.

    :param function: the statistic
    :param values: the values
    """
    known = [value for value in values if value is not None]
    return function(known) if known else None


def judgement(task: str, variant: str, steps: int, seed: int, episodes: int) -> Judgement:
    """Train an agent and judge it.

    :param task: name of the task
    :param variant: name of the variant
    :param steps: number of steps of the training
    :param seed: its seed
    :param episodes: number of evaluation episodes
    """
    th.set_num_threads(1)
    env = TASKS[task](seed)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # That V runs away is what the rows say
        model = agent(variant, env, seed).learn(steps)
    buffer = model.replay_buffer
    assert buffer is not None
    newest = np.arange(buffer.pos - min(buffer.size(), FRESH), buffer.pos)  # In a full buffer, negative ones are older
    states, actions = (array[newest, 0].astype(float) for array in (buffer.observations, buffer.actions))
    true_mu = env.mu(states)
    mu, _ = model.predict(states.astype(np.float32), deterministic=True)
    of_action = Judgement(
        score=score(task, lambda state: model.predict(state)[0], episodes),
        mu_error=float(np.sqrt(np.square(mu - true_mu).mean() / np.square(true_mu).mean())),
        saturated=float((np.abs(mu) > SATURATED).mean()),
    )
    return of_value(of_action, model, env, states, actions) if isinstance(model, Watched) else of_action


def agent(variant: str, env: gym.Env, seed: int, exploration_std: float = EXPLORATION_STD) -> OffPolicyAlgorithm:
    """An agent that has learned nothing yet.

    :param variant: name of a variant of NAF, or DDPG
    :param env: its task
    :param seed: its seed
    :param exploration_std: standard deviation of NAF's noise; DDPG has that of its documentation
    """
    if variant == DDPG_NAME:
        layers = dict(net_arch=LAYERS)
        return DDPG("MlpPolicy", env, seed=seed, device="cpu", action_noise=documented_noise(env), policy_kwargs=layers)
    chosen = VARIANTS[variant]
    return Watched(
        policy_with(chosen.critic),
        env,
        seed=seed,
        device="cpu",
        exploration_std=exploration_std,
        policy_kwargs=dict(net_arch=chosen.net_arch, dropout=chosen.dropout),
    )


def of_value(judged: Judgement, model: Watched, env: KnownTask, states: np.ndarray, actions: np.ndarray) -> Judgement:
    """A judgement with what NAF knows beside the best action.

    :param judged: judgement of the action
    :param model: the agent
    :param env: its task
    :param states: newest states, of shape (n, observations)
    :param actions: replayed actions, of shape (n, actions)
    """
    model.policy.set_training_mode(False)
    observations = th.as_tensor(states, dtype=th.float32)
    with th.no_grad():
        values = model.q_net.all_values(observations, th.as_tensor(actions, dtype=th.float32))
        lower = model.q_net.lower(observations).double().numpy()
    return replace(
        judged,
        value_over_bound=model.highest_ratio,
        value_error=float((values.best[:, 0].double().numpy() - env.value(states)).mean()),
        curvature=float(np.linalg.eigvalsh(lower @ lower.transpose(0, 2, 1))[:, -1].mean()),
        gap=(values.best - values.q).mean().item() / float(env.gap(states, actions).mean()),
    )


def score(task: str, law: Callable[[np.ndarray], np.ndarray], episodes: int) -> float:
    """Return of a law in some episodes, from that of the centre, 0, to that of the best law, 1.

    :param task: name of the task
    :param law: action by state
    :param episodes: number of episodes
    """
    env = TASKS[task](EVALUATION_SEED)
    assert env.action_space.shape is not None
    centre = np.zeros(env.action_space.shape)
    learned, best, idle = (
        mean_return(task, one, episodes) for one in (law, lambda state: env.mu(state[None])[0], lambda state: centre)
    )
    return (learned - idle) / (best - idle)


def mean_return(task: str, law: Callable[[np.ndarray], np.ndarray], episodes: int) -> float:
    """Mean return of some episodes, the same for every law.

    :param task: name of the task
    :param law: action by state
    :param episodes: number of episodes
    """
    env, total = TASKS[task](EVALUATION_SEED), 0.0
    for _ in range(episodes):
        state, truncated = env.reset()[0], False
        while not truncated:
            state, reward, _, truncated, _ = env.step(law(state))
            total += reward
    return total / episodes
