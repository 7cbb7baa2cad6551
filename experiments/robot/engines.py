"""How far do the two physics engines agree, and does what is learned in one work in the other?

Good parameters and poor ones, V1 to V4 under pushes of 100 N, and trainings by NAF, all judged in both engines on the
same seeds and with the same pushes.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from pandas import DataFrame

from experiments.experiment import product
from experiments.record import Row
from experiments.shapes import groups
from experiments.tables import share_of, shown, span, table
from experiments.trainings import TrainingExperiment
from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.evaluation import evaluate
from sarah.episode.push import Push
from sarah.episode.settings import EpisodeConfig
from sarah.episode.tasks import TASKS
from sarah.episode.tasks.balance import TRAINED_STEPPING
from sarah.reports.transfer import ENGINES
from sarah.simulation.engines import Engine

SETS = {
    "stepping": (
        PAPER_STEPPING,
        TRAINED_STEPPING,
        (0.02, 0.05, 0.55, 1.8, 1.3),
        (0.15, 0.3, 0.25, 0.5, 0.5),
        (0.5, 0.8, 0.1, 1.0, 1.0),
        (0.8, 1.2, 0.1, 1.0, 1.0),
    ),
    "balance": ((0.0, 0.0, 0.0, 0.0), (1.06, -0.24, 0.21, -0.15), (1.8, 0.0, 1.0, 0.0)),
}
"""Sets that no training here has learned, by task."""
NEWTONS = 100.0
GOOD = 0.7
"""Score of a set that is worth using."""
BUDGETS = {"stepping": 100, "balance": 300}
"""Number of a training's episodes by task."""
EPISODES = {"stepping": 5, "balance": 20}
"""Number of the episodes that judge a training in each engine, by task."""
GAIT = [f"{engine}_{column}" for column in ("score", "steps_per_second") for engine in ENGINES]
SURVIVAL = [f"{engine}_survival" for engine in ENGINES]


def settings(task: str, engine: Engine, time_limit: float) -> EpisodeConfig:
    """Settings of a task's episodes in an engine, with pushes of 100 N if the task has pushes."""
    push: dict[str, Any] = {"push": Push(newtons=(NEWTONS, NEWTONS))} if TASKS[task].has_push else {}
    return dataclasses.replace(TASKS[task].episode, engine=engine, time_limit=time_limit, **push)


@dataclass(frozen=True)
class Engines(TrainingExperiment):
    """Parameter sets and trainings by NAF in each engine, judged in both."""

    episodes: int = 20  # number of episodes of each set in each engine
    seeds: int = 10  # number of trainings of each task in each engine
    budget: int | None = None  # number of a training's episodes; by default 100, and 300 with pushes

    def cases(self) -> list[Row]:
        """Each set, and each training."""
        sets = [
            {"task": task, "learned_in": None, "run": ", ".join(f"{value:g}" for value in values)}
            for task, of_task in SETS.items()
            for values in of_task
        ]
        return sets + product(task=BUDGETS, learned_in=ENGINES, run=[f"naf seed {seed}" for seed in range(self.seeds)])

    def rows(self, task: str, learned_in: Engine | None, run: str) -> Iterator[Row]:
        """What parameters do in both engines."""
        if learned_in is None:
            parameters = tuple(map(float, run.split(", ")))
            episodes, limit = self.episodes, self.time_limit or 30.0
        else:
            config, seed = self.episode(task, learned_in), int(run.split()[-1])
            training = self.training(task, config, self.budget or BUDGETS[task], seed=seed)
            parameters = self.trained(training).parameters()
            episodes, limit = EPISODES[task], config.time_limit
        found = [evaluate(task, parameters, settings(task, one, limit), range(episodes)) for one in ENGINES]
        gait = [one.mean(metric) for metric in ("score", "steps_per_second") for one in found]
        yield dict(zip(GAIT + SURVIVAL, gait + [one.survival_rate for one in found], strict=True))


FULL = Engines()
QUICK = Engines(time_limit=1.1, episodes=1, seeds=1, budget=2)


def of_sets(rows: DataFrame) -> dict[str, DataFrame]:
    """Rows of the sets by task, with the difference of the scores: MuJoCo's over PyBullet's, minus 1."""
    return groups(rows[rows.learned_in.isna()].assign(difference=rows.mujoco_score / rows.pybullet_score - 1.0), "task")


def of_trainings(rows: DataFrame) -> DataFrame:
    """Rows of the trainings with what is kept: the score in the other engine over that in the training's."""
    ratio = rows.mujoco_score / rows.pybullet_score
    return rows.assign(kept=ratio.where(rows.learned_in == "pybullet", 1.0 / ratio)).dropna(subset="learned_in")


def answer(rows: DataFrame) -> str:
    """How far the engines agree."""
    told = of_sets(rows)
    is_good = told["stepping"].pybullet_score >= GOOD
    good, others = (told["stepping"][chosen].difference for chosen in (is_good, ~is_good))
    return (
        f"With sets of P1 to P5 that score at least {GOOD} in PyBullet, MuJoCo's score differs by "
        f"{span(good, '+.0%')}. With worse ones it differs by {span(others, '+.0%')}. Under pushes of "
        f"{NEWTONS:.0f} N, where each fall counts, it differs by {span(told['balance'].difference, '+.0%')}."
    )


def sets(rows: DataFrame) -> str:
    """Scores, steps and survival of the sets in both engines."""
    captions = {
        "stepping": f"P1 to P5 in both engines, without a push: means of the same {FULL.episodes} episodes of 30 s.",
        "balance": f"V1 to V4 with the shipped P1 to P5, and as many pushes of {NEWTONS:.0f} N at 1 to 4 s.",
    }
    columns = ["parameters", *GAIT, *SURVIVAL, "difference"]
    told = {task: group.rename(columns={"run": "parameters"}) for task, group in of_sets(rows).items()}
    return "\n\n".join(table(group, columns, captions[task]) for task, group in told.items())


def transfer(rows: DataFrame) -> str:
    """How much of what is learned in one engine is kept in the other."""
    found = of_trainings(rows)
    kept = {task: group.kept for task, group in groups(found, "task").items()}
    survive = (found[SURVIVAL] == 1.0).all(axis=1).sum()
    return (
        f"In the other engine, without retraining, Second Trainings keep {span(kept['balance'], '.0%')} of their "
        f"score. First Trainings keep {span(kept['stepping'], '.0%')}; their median is "
        f"{shown(kept['stepping'].median(), '.0%')}. With the parameters of "
        f"{share_of(survive, len(found), 'trainings')} the robot survives every episode in both engines."
    )


def trainings(rows: DataFrame) -> str:
    """Scores, steps and what is kept of trainings."""
    found = of_trainings(rows).groupby(["task", "learned_in"], sort=False)
    kept = {"kept": found.kept.median(), "kept_low": found.kept.min(), "kept_high": found.kept.max()}
    caption = (
        f"Medians of {FULL.seeds} trainings by NAF, and the range of what they keep. Both engines judge each training "
        f"in the same episodes: a First Training in {EPISODES['stepping']} of 30 s, a Second under "
        f"{EPISODES['balance']} pushes of 100 N at 1 to 4 s."
    )
    medians = found[GAIT].median().assign(**kept).reset_index()
    return table(medians, list(medians.columns), caption)
