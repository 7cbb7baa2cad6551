"""Which algorithm learns in the fewest episodes?

What each would recommend along the way, in MuJoCo, is judged by episodes whose seeds no training sees.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from statistics import mean
from typing import Any

from pandas import DataFrame

from experiments.experiment import product
from experiments.record import Row
from experiments.tables import shown, so_far, span, table
from experiments.trainings import TrainingExperiment, identity
from sarah.reports.judging import evaluations_of
from sarah.reports.race import run_entry
from sarah.reports.race_entry import RaceCurve, entries_of, read_curve
from sarah.reports.rankings import rankings
from sarah.runs.config import ALGORITHMS
from sarah.runs.run_folder import RunFolder

TASKS = {"stepping": (60, 200, 5), "balance": (150, 500, 12)}
"""Number of episodes of a training, seed of the first one, and number of unseen episodes that judge a recommendation
along the way, by task."""


@dataclass(frozen=True)
class Race(TrainingExperiment):
    """Trainings by every algorithm."""

    seeds: int = 20  # number of trainings of each algorithm
    budget: int | None = None  # number of episodes of a training; by default 60 of the First, and 150 of the Second
    evaluations: int | None = None  # that judge a recommendation; by default as many as for sarah-compare

    def cases(self) -> list[Row]:
        """Each training."""
        seeds = {task: range(first, first + self.seeds) for task, (_, first, _) in TASKS.items()}
        return [case for task in TASKS for case in product(task=[task], seed=seeds[task], algorithm=ALGORITHMS)]

    def rows(self, task: str, seed: int, algorithm: str) -> Iterator[Row]:
        """How its recommendations do, along the way and in the end. Scores stand in one cell, for their number."""
        budget, _, along = TASKS[task]
        base = self.training(task, self.episode(task, "mujoco"), self.budget or budget, slots=1)
        evaluations = evaluations_of(base.task, self.evaluations, self.evaluations or along)
        folder = self.runs / f"race-{task}-{identity(base)}"
        (entry,) = entries_of([algorithm], [seed], base, evaluations, folder)
        run_entry(entry)
        episodes = RunFolder(entry.folder).episodes()
        yield columns(read_curve(entry), mean(float(row["score"]) for row in episodes))


def columns(curve: RaceCurve, score_while_learning: float) -> Row:
    """Columns of a training."""
    return {
        "score_while_learning": score_while_learning,
        "seconds": curve.seconds,
        "along": curve.along,
        "episodes": " ".join(map(str, curve.episodes)),
        "scores": " ".join(f"{score:.4f}" for score in curve.scores),
        "final": " ".join(f"{score:.4f}" for score in curve.final),
    }


FULL = Race()
QUICK = Race(time_limit=2.0, seeds=1, budget=5, evaluations=1)


def complete(rows: DataFrame, task: str) -> DataFrame:
    """Trainings of a task with the seeds on which all algorithms have been trained."""
    rows = rows[rows.task == task]
    return rows.groupby("seed").filter(lambda group: len(group) == len(ALGORITHMS))


def ranked(trainings: DataFrame) -> DataFrame:
    """A row for each algorithm, the quickest first."""
    found_rankings = rankings([curve_of(row) for row in trainings.to_dict("records")], reference="naf")
    found = DataFrame([found_rankings.columns(row) for row in found_rankings.rows])
    learning = trainings.groupby("algorithm").score_while_learning
    found["score_while_learning"] = found.algorithm.map(learning.mean())
    found["score_while_learning_error"] = found.algorithm.map(learning.sem())
    return found


def curve_of(row: Mapping[Any, Any]) -> RaceCurve:
    """Scores of a training's recommendations."""
    scores, final = (tuple(map(float, str(row[column]).split())) for column in ("scores", "final"))
    episodes = tuple(map(int, row["episodes"].split()))
    return RaceCurve(row["algorithm"], episodes, scores, final, row["along"], row["seconds"])


def answer(rows: DataFrame) -> str:
    """Final scores, and which algorithms NAF can be told from."""
    return f"{_compared(rows, 'stepping', 'First')}\n\n{_compared(rows, 'balance', 'Second')}"


def _compared(rows: DataFrame, task: str, training: str) -> str:
    trainings = complete(rows, task)
    if trainings.empty:
        return f"The race of the {training} Training is still to be made."
    algorithms = ranked(trainings)
    scores = algorithms.set_index("algorithm").final_score
    better, worse = algorithms.over_naf_low > 0.0, algorithms.over_naf_high < 0.0
    held = algorithms.set_index("algorithm").episodes_to_95
    others = held.drop("naf")
    finite = others[others < math.inf]
    return (
        f"In the {training} Training the final scores are {span(scores, '.2f')}, and NAF's is "
        f"{shown(scores['naf'], '.2f')}. Better than NAF by more than chance: {_names(algorithms[better])}. Worse: "
        f"{_names(algorithms[worse])}. NAF's median training holds 95 % of the best known score after "
        f"{shown(held['naf'], '.0f')} episodes, and those of the others after {span(finite, '.0f')}"
        f"{', or never' * (len(finite) < len(others))}."
    )


def _names(algorithms: DataFrame) -> str:
    return ", ".join(sorted(algorithms.algorithm)) or "none"


def _final(rows: DataFrame, task: str) -> str:
    """Final scores."""
    pairs = [f"{column}{end}" for column in ("over_naf", "final_at_95") for end in ("", "_low", "_high")]
    columns = ["algorithm", "final_score", "final_score_error", *pairs]
    what = (
        "mean final score with its standard error, its difference from NAF's and the number of trainings that end with "
        "95 % of the best known score, both with 95 % intervals"
    )
    return _table(rows, task, columns, what, over_naf=".3f")


def _way(rows: DataFrame, task: str) -> str:
    """The way there."""
    shares = [f"{column}_{share}" for share in (90, 95) for column in ("episodes_to", "held")]
    columns = ["algorithm", *shares, "score_while_learning", "score_while_learning_error", "wall_time_s"]
    what = (
        "median number of episodes until 90 and 95 % of the best known score are held, how many trainings hold them, "
        "score of the episodes tried, and time of a training"
    )
    return _table(rows, task, columns, what, learning=".2f", episodes_to_90=".0f", episodes_to_95=".0f")


def _table(rows: DataFrame, task: str, columns: list[str], what: str, **formats: str) -> str:
    """Columns of the algorithms; the caption says of which trainings."""
    trainings, (budget, first, _) = complete(rows, task), TASKS[task]
    if trainings.empty:
        return "*Still to be made.*"
    pushes = ", with pushes of 100 to 125 N, half of them from front and back" * (task == "balance")
    seeds = so_far(trainings.seed.nunique(), FULL.seeds)
    caption = f"Trainings of {budget} episodes in MuJoCo{pushes} (seeds from {first} on: {seeds}): {what}."
    return table(ranked(trainings), columns, caption, **formats)


final_stepping, final_balance = (partial(_final, task=task) for task in TASKS)
way_stepping, way_balance = (partial(_way, task=task) for task in TASKS)
