"""Times what a training computes between two episodes, by how many episodes there have been, on one thread.

The replay buffer holds them all, more than it does by default: local NAF's is 10,000 episodes long.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from statistics import median
from typing import Any

import numpy as np
from gymnasium import spaces

from experiments.record import Row
from sarah.agents import PRESETS, RankReplayBuffer
from sarah.episode.tasks import STEPPING
from sarah.training.recommendation import Tried
from sarah.training.recorder import EPISODES_PER_RECOMMENDATION

OBSERVATION = np.zeros((1, 16), np.float32)
ELITE_STD = 0.2
CENTRE = (1.0,) * len(STEPPING.parameters)
PRESET: dict[str, Any] = PRESETS["one-step"]


@dataclass(frozen=True)
class Decisions:
    """Time of a decision of local NAF, and of a recommendation. Updates are not among it: they always take as long.

    :param episodes: numbers of episodes before
    :param rounds: number of decisions that are timed
    """

    episodes: tuple[int, ...] = (1000, 10_000, 100_000)
    rounds: int = 51

    def rows(self) -> Iterator[Row]:
        """A row for each number of episodes."""
        for count in self.episodes:
            generator = np.random.default_rng(0)
            actions, rewards = generator.uniform(-1, 1, (count, len(CENTRE))), generator.random(count)
            buffer = RankReplayBuffer(count, spaces.Box(-1, 1, (16,)), spaces.Box(-1, 1, (len(CENTRE),)), "cpu")
            tried = Tried(STEPPING)
            for action, reward in zip(actions, rewards, strict=True):
                remember(action, reward, buffer, tried)
            note = milliseconds(partial(tried.append, CENTRE, 0.5), self.rounds)
            recommend = milliseconds(partial(tried.best, CENTRE), self.rounds)
            yield {
                "episodes": count,
                "action_milliseconds": milliseconds(partial(decide, buffer), self.rounds),
                "recommendation_milliseconds": note + recommend / EPISODES_PER_RECOMMENDATION,
            }


def remember(action: np.ndarray, reward: float, buffer: RankReplayBuffer, tried: Tried) -> None:
    """Keep an episode as a training does.

    :param action: its action
    :param reward: its return, and its merit
    :param buffer: replay buffer
    :param tried: episodes so far
    """
    buffer.add(OBSERVATION, OBSERVATION, action[None], np.array([reward]), np.ones(1), [{}])
    tried.append(tuple(action + 1.0), reward)


def decide(buffer: RankReplayBuffer) -> None:
    """Store an outcome, draw the next action near the best one, and sample the batches of the updates.

    :param buffer: replay buffer
    """
    buffer.add(OBSERVATION, OBSERVATION, np.zeros((1, len(CENTRE))), np.array([0.5]), np.ones(1), [{}])
    buffer.draw_near_best(ELITE_STD, PRESET["elite_draws"])
    for _ in range(PRESET["gradient_steps"]):
        buffer.sample(PRESET["batch_size"])


def milliseconds(action: Callable[[], Any], rounds: int) -> float:
    """Median time, in ms of processor time.

    :param action: action to time
    :param rounds: number of times
    """
    times = []
    for _ in range(rounds):
        start = time.process_time()
        action()
        times.append(1000.0 * (time.process_time() - start))
    return median(times)
