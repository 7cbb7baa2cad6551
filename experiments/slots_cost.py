"""What more episodes in flight cost a training: the same budget, each action knowing less of the last outcomes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from statistics import mean, median

from experiments.record import Row
from experiments.maker import TrainingExperiment
from sarah.episode.evaluation import evaluate
from sarah.episode.workers import Workers
from sarah.runs.agent_settings import NAFSettings
from sarah.runs.config import TrainingConfig
from sarah.training.plan import plan_of

WARM_UP = NAFSettings().learning_starts
"""Number of episodes before NAF learns."""


@dataclass(frozen=True)
class SlotsCost(TrainingExperiment):
    """First Trainings by NAF in MuJoCo with several numbers of slots.

    :param slots: numbers of episodes in flight
    :param seeds: number of trainings with each
    :param budget: number of episodes of a training; below 25 there are no trials of its recommendation
    :param episodes: number of unseen seeds that judge
    """

    slots: tuple[int, ...] = (1, 4, 8, 32)
    seeds: int = 5
    budget: int = 100
    episodes: int = 10
    time_limit: float | None = 10.0

    def rows(self) -> Iterator[Row]:
        """A row for each number of slots."""
        config = self.episode("stepping", "mujoco")
        with Workers(self.workers) as workers:
            for slots in self.slots:
                learning, final = [], []
                for seed in range(self.seeds):
                    training = TrainingConfig("stepping", episodes=self.budget, seed=seed, slots=slots, episode=config)
                    run = self.trained(training, workers)
                    scores = [float(row["score"]) for row in run.episodes()]
                    learning.append(mean(scores[max(WARM_UP, 2 * slots) : plan_of(training).stages[0].learning]))
                    evaluation = evaluate("stepping", run.parameters(), config, range(self.episodes), workers)
                    final.append(evaluation.median("score"))
                yield {
                    "slots": slots,
                    "score_while_learning": median(learning),
                    "score": median(final),
                    "lowest_score": min(final),
                }
