"""NAF and DDPG where the best action is at the bounds, or inside, with actions that reach the bounds sooner."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from statistics import median
from typing import NamedTuple

import numpy as np
import torch as th

from experiments.experiment import OnWorkers
from experiments.known_tasks import TASKS
from experiments.known_truth import DDPG_NAME, FRESH, SATURATED, agent, score
from experiments.record import Row
from experiments.several_actions import with_scaled_actions
from sarah.episode.workers import Workers
from sarah.errors import ConfigurationError, unknown_name


class Judged(NamedTuple):
    """What an agent has learned.

    :param score: return from that of the centre, 0, to that of the best law, 1
    :param saturated: share of the entries of its actions that are at their bounds, once scaled
    """

    score: float
    saturated: float


@dataclass(frozen=True)
class ScaledActions(OnWorkers):
    """NAF and DDPG on tasks whose truth is known, by a factor of actions, which are cut at their bounds.

    :param tasks: names of the tasks
    :param action_scales: factors of actions
    :param steps: number of steps of a training
    :param seeds: number of trainings of each algorithm
    :param episodes: number of evaluation episodes
    """

    tasks: tuple[str, ...] = ("six actions, at the bounds", "six actions, clear")
    action_scales: tuple[float, ...] = (1.0, 3.0)
    steps: int = 5000
    seeds: int = 5
    episodes: int = 10

    def rows(self) -> Iterator[Row]:
        """A row for each task, factor and algorithm."""
        for task in self.tasks:
            if task not in TASKS:
                raise ConfigurationError(unknown_name("task", task, TASKS))
        with Workers(self.workers) as workers:
            jobs = {
                (task, scale, algorithm): [
                    workers.submit(judged, task, algorithm, scale, seed, self) for seed in range(self.seeds)
                ]
                for task in self.tasks
                for scale in self.action_scales
                for algorithm in ("NAF", DDPG_NAME)
            }
            for (task, scale, algorithm), running in jobs.items():
                scores, saturated = zip(*(job.result() for job in running), strict=True)
                yield {
                    "task": task,
                    "action_scale": scale,
                    "algorithm": algorithm,
                    "seeds": self.seeds,
                    "score": median(scores),
                    "score_low": min(scores),
                    "score_high": max(scores),
                    "saturated_share": median(saturated),
                }


def judged(task: str, algorithm: str, scale: float, seed: int, of: ScaledActions) -> Judged:
    """Train an agent and judge its actions.

    :param task: name of the task
    :param algorithm: name of the algorithm
    :param scale: factor of its actions
    :param seed: seed of the training
    :param of: sizes
    """
    th.set_num_threads(1)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # What becomes of V is for known_truth to say
        model = agent(algorithm, with_scaled_actions(TASKS[task](seed), scale), seed).learn(of.steps)

    def law(states: np.ndarray) -> np.ndarray:
        return np.clip(scale * model.predict(states.astype(np.float32), deterministic=True)[0], -1.0, 1.0)

    assert model.replay_buffer is not None
    newest = model.replay_buffer.observations[: model.replay_buffer.size()][-FRESH:, 0]
    return Judged(score(task, law, of.episodes), float((np.abs(law(newest)) > SATURATED).mean()))
