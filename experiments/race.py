"""The race of all algorithms: what each would recommend along the way, on seeds that no training sees.

All trainings together take most of a day. So the course of each is kept in a file beside the results, and not run again
with the same settings, physics, controller and robot. Whoever changes a learner or the recommendation deletes these
files.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import mean, stdev
from typing import Any

import tyro

from experiments.record import Row
from experiments.maker import TrainingExperiment
from experiments.trainings import identity, kept, short_hash
from sarah.episode.workers import Workers
from sarah.reports.judging import evaluations_of
from sarah.reports.race import run_entry
from sarah.reports.race_entry import Entry, RaceCurve, entries_of, read_curve
from sarah.reports.rankings import rankings
from sarah.runs.config import ALGORITHMS, TrainingConfig
from sarah.runs.run_folder import RunFolder

DIGITS = 5
"""Decimals of the scores that are kept."""


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
    :param courses: folder that keeps the courses of the trainings
    """

    task: tyro.conf.Suppress[str]
    budget: int
    first_seed: int
    seeds: int = 20
    algorithms: tuple[str, ...] = ALGORITHMS
    evaluations: int | None = None
    evaluations_along: int | None = None
    courses: Path = Path("results/race")

    def rows(self) -> Iterator[Row]:
        """A row for each algorithm, the quickest first."""
        base = TrainingConfig(self.task, episodes=self.budget, slots=1, episode=self.episode(self.task, "mujoco"))
        seeds = range(self.first_seed, self.first_seed + self.seeds)
        evaluations = evaluations_of(base.task, self.evaluations, self.evaluations_along)
        entries = entries_of(
            self.algorithms, seeds, base, evaluations, self.runs / f"race-{self.task}-{identity(base)}"
        )
        with Workers(self.workers) as workers:
            jobs = [workers.submit(kept, self._file(entry), course_of, entry) for entry in entries]
            courses = [job.result() for job in jobs]
        table = rankings([RaceCurve(**course["curve"]) for course in courses], reference="naf")
        for ranking in table.rows:
            row = table.columns(ranking)
            if self.task == "balance":
                own = [course for course in courses if course["curve"]["algo"] == ranking.algo]
                row |= while_learning([course["score_while_learning"] for course in own])
            yield row

    def _file(self, entry: Entry) -> Path:
        """File of a training's course, whose name tells its settings and what it was made with."""
        settings = short_hash([repr(entry.config), repr(entry.evaluations)])
        return self.courses / f"{self.task}-{entry.folder.name}-{settings}.json"


def course_of(entry: Entry) -> dict[str, Any]:
    """What a race knows of a training, which is run, or resumed, and judged in this process unless it is there.

    :param entry: a training of the race
    """
    run_entry(entry)
    curve = read_curve(entry)
    scores = {name: [round(score, DIGITS) for score in getattr(curve, name)] for name in ("scores", "final")}
    return {"curve": vars(curve) | scores, "score_while_learning": score_while_learning(entry)}


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
