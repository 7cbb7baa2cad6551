"""How far do the two physics engines agree?

Good parameters and poor ones, and V1 to V4 under pushes of 100 N, on the same seeds.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from pandas import DataFrame

from experiments.experiment import Experiment
from experiments.record import Row
from experiments.shapes import groups
from experiments.tables import span, table
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
NEWTONS = 100.0
GOOD = 0.7
"""Score of a set that is worth using."""
COLUMNS = [f"{engine}_{column}" for column in ("score", "steps_per_second", "survival") for engine in ENGINES]


def settings(task: str, engine: Engine, time_limit: float) -> EpisodeConfig:
    """Settings of a task's episodes in an engine, with pushes of 100 N if the task has pushes."""
    push: dict[str, Any] = {"push": Push(newtons=(NEWTONS, NEWTONS))} if TASKS[task].has_push else {}
    return dataclasses.replace(TASKS[task].episode, engine=engine, time_limit=time_limit, **push)


def in_both(task: str, parameters: tuple[float, ...], episodes: int, time_limit: float) -> Row:
    """Means of the same episodes of a task in each engine."""
    found = {e: evaluate(task, parameters, settings(task, e, time_limit), range(episodes)) for e in ENGINES}
    return {
        **{f"{engine}_score": one.mean("score") for engine, one in found.items()},
        **{f"{engine}_steps_per_second": one.mean("steps_per_second") for engine, one in found.items()},
        **{f"{engine}_survival": one.survival_rate for engine, one in found.items()},
    }


@dataclass(frozen=True)
class Engines(Experiment):
    """Parameter sets in both physics engines, on the same seeds and with the same pushes.

    :param episodes: number of episodes of each set in each engine
    :param time_limit: time limit of an episode, in s
    """

    episodes: int = 20
    time_limit: float = 30.0

    def cases(self) -> list[Row]:
        """Each parameter set."""
        pairs = [(task, values) for task, sets in SETS.items() for values in sets]
        return [{"task": task, "parameters": ", ".join(f"{value:g}" for value in values)} for task, values in pairs]

    def rows(self, task: str, parameters: str) -> Iterator[Row]:
        """What a set does in both engines."""
        values = tuple(float(value) for value in parameters.split(", "))
        yield in_both(task, values, self.episodes, self.time_limit)


FULL = Engines()
QUICK = Engines(episodes=1, time_limit=2.0)


def compared(rows: DataFrame) -> DataFrame:
    """Rows with the difference of the scores: MuJoCo's over PyBullet's, minus 1."""
    return rows.assign(difference=rows.mujoco_score / rows.pybullet_score - 1.0)


def answer(rows: DataFrame) -> str:
    """How far the engines agree."""
    told = groups(compared(rows), "task")
    good = told["stepping"][told["stepping"].pybullet_score >= GOOD]
    return (
        f"Well, where the robot steps well: for the {len(good)} of {len(told['stepping'])} sets of P1 to P5 that score "
        f"at least {GOOD} in PyBullet, MuJoCo's score differs by {span(good.difference, '+.0%')}. Under pushes of "
        f"{NEWTONS:.0f} N chance decides more, and it differs by {span(told['balance'].difference, '+.0%')}."
    )


def sets(rows: DataFrame) -> str:
    """Scores, steps and survival in both engines."""
    captions = {
        "stepping": f"P1 to P5 in both engines, without a push: means of the same {FULL.episodes} episodes of 30 s.",
        "balance": f"V1 to V4 with the shipped P1 to P5, and as many pushes of {NEWTONS:.0f} N at 1 to 4 s.",
    }
    told = groups(compared(rows), "task").items()
    return "\n\n".join(
        table(group, ["parameters", *COLUMNS, "difference"], captions[str(task)]) for task, group in told
    )
