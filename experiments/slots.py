"""How busy workers are: episodes in flight consumed in order, against rounds of episodes that wait for the slowest.

A simulation of the schedule, over the lengths of the episodes of a training, in which the learner takes no time.
"""

from __future__ import annotations

import heapq
import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from experiments.record import Row
from experiments.maker import TrainingExperiment
from sarah.episode.workers import Workers
from sarah.runs.config import TrainingConfig

WORKERS = (2, 8, 64, 1000)
SLOTS_PER_WORKER = (1.0, 1.5, 2.0, 3.0, 4.0, 8.0)


@dataclass(frozen=True)
class SlotsSchedule(TrainingExperiment):
    """Share of the time that workers simulate, by their number and the number of slots for each of them.

    :param seed: seed of the First Training whose episodes are scheduled
    :param budget: number of episodes of that training
    :param episodes_per_worker: number of scheduled episodes for each worker
    """

    seed: int = 1
    budget: int = 100
    episodes_per_worker: int = 200

    def rows(self) -> Iterator[Row]:
        """A row for each number of workers, schedule and number of slots."""
        training = TrainingConfig("stepping", episodes=self.budget, seed=self.seed, episode=self.episode("stepping"))
        with Workers(self.workers) as workers:
            measured = [float(row["duration"]) for row in self.trained(training, workers).episodes()]
        generator = random.Random(0)
        for count in WORKERS:
            lengths = generator.choices(measured, k=self.episodes_per_worker * count)
            for schedule, busy_share in (("in order", busy_in_order), ("in rounds", busy_in_rounds)):
                for ratio in SLOTS_PER_WORKER:
                    yield {
                        "workers": count,
                        "schedule": schedule,
                        "slots_per_worker": f"{ratio:g}",
                        "busy_share": busy_share(lengths, count, round(ratio * count)),
                    }


def busy_in_order(lengths: Sequence[float], workers: int, slots: int) -> float:
    """Share of the time that workers simulate, if an episode is handed in once the one ``slots`` before is consumed.

    :param lengths: durations of the episodes
    :param workers: number of workers
    :param slots: number of episodes in flight
    """
    free = [0.0] * workers
    consumed: list[float] = []
    for index, length in enumerate(lengths):
        handed_in = consumed[index - slots] if index >= slots else 0.0
        begin = max(heapq.heappop(free), handed_in)
        heapq.heappush(free, begin + length)
        consumed.append(max(begin + length, consumed[-1] if consumed else 0.0))
    return sum(lengths) / (workers * consumed[-1])


def busy_in_rounds(lengths: Sequence[float], workers: int, slots: int) -> float:
    """The same, if ``slots`` episodes begin together once all of those before are over.

    :param lengths: durations of the episodes
    :param workers: number of workers
    :param slots: number of episodes in flight
    """
    elapsed = 0.0
    for first in range(0, len(lengths), slots):
        free = [0.0] * workers
        for length in lengths[first : first + slots]:
            heapq.heappush(free, heapq.heappop(free) + length)
        elapsed += max(free)
    return sum(lengths) / (workers * elapsed)
