"""NAF and DDPG where the best action is at the bounds, or inside, with larger actions and with wider noise.

Larger actions do two things at once: bounds are nearer, and noise is wider in the units of the task. So NAF is also
tried with either alone.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from statistics import median
from typing import NamedTuple

import numpy as np
import torch as th

from experiments.baselines import NOISE
from experiments.maker import ParallelExperiment
from experiments.known_tasks import TASKS
from experiments.known_truth import DDPG_NAME, FRESH, SATURATED, agent, score
from experiments.naf_variants import EXPLORATION_STD
from experiments.record import Row
from experiments.several_actions import with_scaled_actions
from sarah.episode.workers import Workers
from sarah.errors import ConfigurationError, unknown_name


class Case(NamedTuple):
    """What is changed of actions.

    :param algorithm: name of the algorithm
    :param action_scale: factor of its actions, which are cut at the bounds of the task
    :param exploration_std: standard deviation of its noise, before that factor
    """

    algorithm: str
    action_scale: float
    exploration_std: float


CASES = {
    "NAF": Case("NAF", 1.0, EXPLORATION_STD),
    "NAF with larger actions": Case("NAF", 3.0, EXPLORATION_STD / 3.0),
    "NAF with wider noise": Case("NAF", 1.0, 3.0 * EXPLORATION_STD),
    "NAF with larger actions and wider noise": Case("NAF", 3.0, EXPLORATION_STD),
    "DDPG": Case(DDPG_NAME, 1.0, NOISE),
    "DDPG with larger actions and wider noise": Case(DDPG_NAME, 3.0, NOISE),
}


class Judged(NamedTuple):
    """What an agent has learned.

    :param score: return from that of the centre, 0, to that of the best law, 1
    :param saturated: share of the entries of its actions that are at their bounds, once scaled
    """

    score: float
    saturated: float


@dataclass(frozen=True)
class ScaledActions(ParallelExperiment):
    """NAF and DDPG on tasks whose truth is known, by the factor of their actions and the width of their noise.

    :param tasks: names of the tasks
    :param actions: names of what is changed
    :param steps: number of steps of a training
    :param seeds: number of trainings of each algorithm
    :param episodes: number of evaluation episodes
    """

    tasks: tuple[str, ...] = ("six actions, at the bounds", "six actions, clear")
    actions: tuple[str, ...] = tuple(CASES)
    steps: int = 5000
    seeds: int = 5
    episodes: int = 10

    def rows(self) -> Iterator[Row]:
        """A row for each task and change of actions."""
        for kind, names, known in (("task", self.tasks, TASKS), ("actions", self.actions, CASES)):
            for name in names:
                if name not in known:
                    raise ConfigurationError(unknown_name(kind, name, known))
        with Workers(self.workers) as workers:
            jobs = {
                (task, name): [workers.submit(judged, task, CASES[name], seed, self) for seed in range(self.seeds)]
                for task in self.tasks
                for name in self.actions
            }
            for (task, name), running in jobs.items():
                scores, saturated = zip(*(job.result() for job in running), strict=True)
                case = CASES[name]
                yield {
                    "task": task,
                    "actions": name,
                    "action_scale": case.action_scale,
                    "noise_std": case.action_scale * case.exploration_std,
                    "seeds": self.seeds,
                    "score": median(scores),
                    "score_low": min(scores),
                    "score_high": max(scores),
                    "saturated_share": median(saturated),
                }


def judged(task: str, case: Case, seed: int, of: ScaledActions) -> Judged:
    """Train an agent and judge its actions.

    :param task: name of the task
    :param case: what is changed
    :param seed: seed of the training
    :param of: sizes
    """
    th.set_num_threads(1)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # What becomes of V is for known_truth to say
        env = with_scaled_actions(TASKS[task](seed), case.action_scale)
        model = agent(case.algorithm, env, seed, case.exploration_std).learn(of.steps)

    def law(states: np.ndarray) -> np.ndarray:
        return np.clip(case.action_scale * model.predict(states.astype(np.float32), deterministic=True)[0], -1.0, 1.0)

    assert model.replay_buffer is not None
    newest = model.replay_buffer.observations[: model.replay_buffer.size()][-FRESH:, 0]
    return Judged(score(task, law, of.episodes), float((np.abs(law(newest)) > SATURATED).mean()))
