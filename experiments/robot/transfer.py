"""Does what is learned in one engine work in the other?

Trainings by NAF in both engines, judged in both on the same seeds and pushes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from pandas import DataFrame

from experiments.experiment import product
from experiments.record import Row
from experiments.robot.engines import COLUMNS, in_both
from experiments.shapes import groups
from experiments.tables import share_of, shown, span, table
from experiments.trainings import TrainingExperiment
from sarah.reports.transfer import ENGINES
from sarah.runs.config import TrainingConfig
from sarah.simulation.engines import Engine

BUDGETS = {"stepping": 100, "balance": 300}
"""Number of a training's episodes by task."""
EPISODES = {"stepping": 5, "balance": 20}
"""Number of the episodes that judge in each engine, by task."""


@dataclass(frozen=True)
class Transfer(TrainingExperiment):
    """Trainings by NAF in each engine, judged in both.

    :param seeds: number of trainings of each task in each engine
    :param budget: number of a training's episodes; by default 100, and 300 with pushes
    """

    seeds: int = 10
    budget: int | None = None

    def cases(self) -> list[Row]:
        """Each training."""
        runs = [f"naf seed {seed}" for seed in range(self.seeds)]
        return product(task=BUDGETS, learned_in=ENGINES, run=runs)

    def rows(self, task: str, learned_in: Engine, run: str) -> Iterator[Row]:
        """What the parameters of a training do in both engines."""
        config, seed = self.episode(task, learned_in), int(run.split()[-1])
        training = TrainingConfig(task, episodes=self.budget or BUDGETS[task], seed=seed, episode=config)
        yield in_both(task, self.trained(training).parameters(), EPISODES[task], config.time_limit)


FULL = Transfer()
QUICK = Transfer(time_limit=1.1, budget=2, seeds=1)


def compared(rows: DataFrame) -> DataFrame:
    """Rows with what is kept: the score in the other engine over that in the engine of the training."""
    ratio = rows.mujoco_score / rows.pybullet_score
    return rows.assign(kept=ratio.where(rows.learned_in == "pybullet", 1.0 / ratio))


def answer(rows: DataFrame) -> str:
    """How much is kept."""
    kept = {task: group.kept for task, group in groups(compared(rows), "task").items()}
    survive = (rows[["pybullet_survival", "mujoco_survival"]] == 1.0).all(axis=1).sum()
    return (
        f"Yes, without retraining. In the other engine Second Trainings keep {span(kept['balance'], '.0%')} of their "
        f"score, and First Trainings {span(kept['stepping'], '.0%')}, {shown(kept['stepping'].median(), '.0%')} in the "
        f"median. With the parameters of {share_of(survive, len(rows), 'trainings')} the robot survives every episode "
        "in both."
    )


def trainings(rows: DataFrame) -> str:
    """Scores, steps and what is kept."""
    found = compared(rows).groupby(["task", "learned_in"], sort=False)
    kept = {"kept": found.kept.median(), "kept_low": found.kept.min(), "kept_high": found.kept.max()}
    caption = (
        f"Medians of {FULL.seeds} trainings by NAF, each judged in both engines on the same episodes: "
        f"{EPISODES['stepping']} of 30 s after a First Training, and {EPISODES['balance']} pushes of 100 N at 1 to 4 s "
        "after a Second; what is kept with its range."
    )
    medians = found[[column for column in COLUMNS if "survival" not in column]].median().assign(**kept).reset_index()
    return table(medians, list(medians), caption)
