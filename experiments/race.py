"""The race of all algorithms: what each would recommend along the way, on seeds that no training sees."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from statistics import mean, stdev

import tyro

from experiments.record import Row
from experiments.trainings import TrainingExperiment, identity
from sarah.episode.workers import Workers
from sarah.reports.judging import evaluations_of
from sarah.reports.race import race
from sarah.reports.race_entry import Entry, entries_of
from sarah.reports.rankings import rankings
from sarah.runs.config import ALGORITHMS, TrainingConfig
from sarah.runs.run_folder import RunFolder


@dataclass(frozen=True)
class Race(TrainingExperiment):
    """Trainings by every algorithm in MuJoCo, a training for each worker at a time.

    :param task: name of the task
    :param budget: number of episodes of a training
    :param first_seed: seed of the first training of each algorithm; no setting was chosen on these
    :param seeds: number of trainings of each algorithm
    :param algorithms: names of the algorithms
    :param evaluations: number of unseen episodes that judge a final recommendation; by default that of sarah-compare
    :param evaluations_along: number of these that judge one along the way; by default that of sarah-compare
    """

    task: tyro.conf.Suppress[str]
    budget: int
    first_seed: int
    seeds: int = 20
    algorithms: tuple[str, ...] = ALGORITHMS
    evaluations: int | None = None
    evaluations_along: int | None = None

    def rows(self) -> Iterator[Row]:
        """A row for each algorithm, the quickest first."""
        episode = self.episode(self.task, "mujoco")
        base = TrainingConfig(self.task, episodes=self.budget, slots=1, episode=episode)
        seeds = range(self.first_seed, self.first_seed + self.seeds)
        folder = self.runs / f"race-{self.task}-{identity(base)}"
        folder.mkdir(parents=True, exist_ok=True)
        evaluations = evaluations_of(base.task, self.evaluations, self.evaluations_along)
        entries = entries_of(self.algorithms, seeds, base, evaluations, folder)
        with Workers(self.workers) as workers:
            table = rankings(race(entries, workers), reference="naf")
        for ranking in table.rows:
            row = table.columns(ranking)
            if self.task == "balance":
                own = [entry for entry in entries if entry.config.algo == ranking.algo]
                row |= while_learning([score_while_learning(entry) for entry in own])
            yield row


def while_learning(scores: Sequence[float]) -> Row:
    """Columns of the score that robots had while they learned, with its standard error over the trainings.

    :param scores: mean score of the episodes that each training simulated
    """
    error = stdev(scores) / math.sqrt(len(scores)) if len(scores) > 1 else None
    return {"score_while_learning": mean(scores), "score_while_learning_error": error}


def score_while_learning(entry: Entry) -> float:
    """Mean score of the episodes that a training simulated.

    :param entry: a training of the race that is complete
    """
    return mean(float(row["score"]) for row in RunFolder(entry.folder).episodes())
