"""What each parameter does: one of P1 to P5 varied around a good set, or one of V1 to V4 under pushes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import tyro

from experiments.engines import ENGINES
from experiments.maker import ParallelExperiment, settings_of
from experiments.record import Row
from sarah.episode.evaluation import evaluate
from sarah.episode.tasks import TASKS
from sarah.episode.workers import Workers

CENTRES = {"stepping": (0.4, 1.0, 0.1, 1.0, 1.0), "balance": (1.0, 0.0, 0.0, 0.0)}
VALUES = {
    "stepping": (0.0, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0, 1.5, 2.0),
    "balance": (-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 2.0),
}
"""By task: the values of every parameter, while the others keep those of the centre."""


@dataclass(frozen=True)
class Landscape(ParallelExperiment):
    """One parameter at a time, in both engines: the median score, and survival if there are pushes.

    :param task: name of the task
    :param seeds: number of episodes of each parameter set in each engine
    :param time_limit: time limit of an episode, in s
    :param newtons: force of the pushes, in N
    :param points: number of values of each parameter
    """

    task: tyro.conf.Suppress[str]
    seeds: int
    time_limit: float
    newtons: float = 100.0
    points: int = 10

    def rows(self) -> Iterator[Row]:
        """A row for each parameter, engine and value."""
        centre, task = CENTRES[self.task], TASKS[self.task]
        with Workers(self.workers) as workers:
            for index, name in enumerate(task.parameter_names):
                for engine in ENGINES:
                    config = settings_of(self.task, (self.newtons,) * 2, engine=engine, time_limit=self.time_limit)
                    for value in VALUES[self.task][: self.points]:
                        parameters = (*centre[:index], value, *centre[index + 1 :])
                        evaluation = evaluate(self.task, parameters, config, range(self.seeds), workers)
                        score = evaluation.median("score")
                        row = {"parameter": name, "value": f"{value:g}", "engine": engine, "score": score}
                        yield {**row, "survival": evaluation.survival_rate} if task.has_push else row
