"""The race of all algorithms: what each would recommend along the way, on seeds that no training sees."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from statistics import mean, median

import tyro

from experiments.record import Row
from experiments.trainings import OfTrainings, identity
from sarah.episode.workers import Workers
from sarah.reports.race import Entry, entries_of, race
from sarah.reports.rankings import rankings
from sarah.runs.config import ALGORITHMS, TrainingConfig
from sarah.runs.run_folder import RunFolder


@dataclass(frozen=True)
class Race(OfTrainings):
    """Trainings by every algorithm in MuJoCo, a training for each worker at a time.

    :param task: name of the task
    :param budget: number of episodes of a training
    :param evaluations: number of unseen seeds that a recommendation is evaluated on
    :param first_seed: seed of the first training of each algorithm; no setting was chosen on these
    :param seeds: number of trainings of each algorithm
    :param algorithms: names of the algorithms
    """

    task: tyro.conf.Suppress[str]
    budget: int
    evaluations: int
    first_seed: int
    seeds: int = 20
    algorithms: tuple[str, ...] = ALGORITHMS

    def rows(self) -> Iterator[Row]:
        """A row for each algorithm, the quickest first."""
        episode = self.episode(self.task, "mujoco")
        base = TrainingConfig(self.task, episodes=self.budget, slots=1, episode=episode)
        seeds = range(self.first_seed, self.first_seed + self.seeds)
        folder = self.runs / f"race-{self.task}-{identity(base)}"
        folder.mkdir(parents=True, exist_ok=True)
        entries = entries_of(self.algorithms, seeds, base, self.evaluations, folder)
        with Workers(self.workers) as workers:
            curves = race(entries, workers)
        for ranking in rankings(curves):
            row = {"algorithm": ranking.algo, "runs": ranking.runs}
            for share, episodes in ranking.episodes.items():
                row[f"episodes_to_{100 * share:.0f}"] = episodes
                row[f"reached_{100 * share:.0f}"] = ranking.reached[share]
            row |= zip(("final_score", "final_score_low", "final_score_high"), ranking.final, strict=True)
            row["wall_time_s"] = round(ranking.seconds)
            if self.task == "balance":
                own = [entry for entry in entries if entry.config.algo == ranking.algo]
                row["score_while_learning"] = median(map(score_while_learning, own))
            yield row


def score_while_learning(entry: Entry) -> float:
    """Mean score of the episodes that a training simulated.

    :param entry: a training of the race that is complete
    """
    return mean(float(row["score"]) for row in RunFolder(entry.folder).episodes())
