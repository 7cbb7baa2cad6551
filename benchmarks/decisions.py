"""How long does a training think between two episodes?

By how many episodes there have been, on one thread. The replay buffer is that of local NAF, which holds the newest
10,000. All disturbances of the episodes matter for their returns: it takes longest to take out the part of so many.
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
from pandas import DataFrame

from benchmarks.timing import Timing
from experiments.record import Row
from experiments.tables import table
from sarah.agents import PRESETS, SmoothedReplayBuffer
from sarah.agents.smoothed_buffer import ADDITIONS_PER_CHOICE
from sarah.episode.spec import EpisodeSpec
from sarah.episode.task_answers import disturbances_of
from sarah.episode.tasks import STEPPING
from sarah.process import apart
from sarah.training.recommendation import Tried
from sarah.training.recorder import EPISODES_PER_RECOMMENDATION

OBSERVATION = np.zeros((1, 16), np.float32)
ELITE_STD = 0.2
CENTRE = (1.0,) * len(STEPPING.parameters)
DISTURBANCES = disturbances_of(EpisodeSpec(CENTRE, seed=0)) or ()
PRESET: dict[str, Any] = PRESETS["one-step"]


@dataclass(frozen=True)
class Decisions(Timing):
    """Time of a decision of local NAF, and of a recommendation. Updates are not among it: they always take as long.

    :param episodes: numbers of episodes before
    :param rounds: number of decisions that are timed
    """

    depends_on = ("agents", "sarah/training")
    episodes: tuple[int, ...] = (1000, 10_000, 100_000)
    rounds: int = 51

    def cases(self) -> list[Row]:
        """The numbers of episodes."""
        return [{"episodes": count} for count in self.episodes]

    def rows(self, episodes: int) -> Iterator[Row]:
        """Times after some episodes.

        :param episodes: number of episodes
        """
        with apart():  # on one thread, as in a training
            yield self._times(episodes)

    def _times(self, episodes: int) -> Row:
        generator = np.random.default_rng(0)
        actions = generator.uniform(-1, 1, (episodes, len(CENTRE)))
        disturbances = generator.random((episodes, len(DISTURBANCES)))
        rewards = generator.random(episodes) + disturbances.sum(axis=1)
        spaces_of_episodes = spaces.Box(-1, 1, (16,)), spaces.Box(-1, 1, (len(CENTRE),))
        buffer = SmoothedReplayBuffer(PRESET["buffer_size"], *spaces_of_episodes, "cpu")
        tried = Tried(STEPPING)
        for action, reward, own in zip(actions, rewards, disturbances, strict=True):
            remember(action, reward, own, buffer, tried)
        note = milliseconds(partial(tried.append, CENTRE, 0.5, DISTURBANCES), self.rounds)
        recommend = milliseconds(partial(tried.best, CENTRE), self.rounds)
        return {
            "action_milliseconds": milliseconds(partial(decide, buffer), self.rounds) / ADDITIONS_PER_CHOICE,
            "recommendation_milliseconds": note + recommend / EPISODES_PER_RECOMMENDATION,
        }


def remember(
    action: np.ndarray, reward: float, disturbances: np.ndarray, buffer: SmoothedReplayBuffer, tried: Tried
) -> None:
    """Keep an episode as a training does.

    :param action: its action
    :param reward: its return, and its merit
    :param disturbances: its disturbances
    :param buffer: replay buffer
    :param tried: episodes so far
    """
    info = {"disturbances": disturbances}
    buffer.add(OBSERVATION, OBSERVATION, action[None], np.array([reward]), np.ones(1), [info])
    tried.append(tuple(action + 1.0), reward, disturbances.tolist())


def decide(buffer: SmoothedReplayBuffer) -> None:
    """Store outcomes, and for each draw the next action near the best one, and sample the batches of the updates.

    With so many the buffer chooses the length and the noise of its Gaussian process once.

    :param buffer: replay buffer
    """
    info = {"disturbances": DISTURBANCES}
    for _ in range(ADDITIONS_PER_CHOICE):
        buffer.add(OBSERVATION, OBSERVATION, np.zeros((1, len(CENTRE))), np.array([0.5]), np.ones(1), [info])
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


FULL = Decisions()
QUICK = Decisions(episodes=(10,), rounds=1)


def times(rows: DataFrame) -> str:
    """Time of a decision and of a recommendation."""
    shown = rows.rename(columns=lambda column: column.replace("_milliseconds", " (ms)"))
    caption = (
        "Processor time between two episodes, without the updates: to choose an action, and to note an episode and "
        "recommend parameters."
    )
    return table(shown, ["episodes", "action (ms)", "recommendation (ms)"], caption, **{"(ms)": ".1f"})
