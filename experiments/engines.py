"""How far the two physics engines agree: good parameters, poor ones, and V1 to V4 under pushes, on the same seeds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import get_args

from experiments.maker import ParallelExperiment, settings_of
from experiments.record import Row
from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.evaluation import evaluate
from sarah.episode.tasks.balance import TRAINED_STEPPING
from sarah.episode.workers import Workers
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
ENGINES: tuple[Engine, ...] = get_args(Engine)


@dataclass(frozen=True)
class Engines(ParallelExperiment):
    """Parameter sets in both physics engines, on the same seeds and with the same pushes.

    :param seeds: number of episodes of each set in each engine
    :param time_limit: time limit of an episode, in s
    :param newtons: force of the pushes, in N
    """

    seeds: int = 20
    time_limit: float = 30.0
    newtons: float = 100.0

    def rows(self) -> Iterator[Row]:
        """A row for each parameter set."""
        with Workers(self.workers) as workers:
            for task, parameters in ((task, parameters) for task, sets in SETS.items() for parameters in sets):
                row: dict[str, object] = {
                    "task": task,
                    "parameters": ", ".join(f"{value:g}" for value in parameters),
                    "episodes": self.seeds,
                }
                scores = []
                for engine in ENGINES:
                    config = settings_of(task, (self.newtons,) * 2, engine=engine, time_limit=self.time_limit)
                    evaluation = evaluate(task, parameters, config, range(self.seeds), workers)
                    scores.append(evaluation.mean("score"))
                    row[f"{engine}_score"] = scores[-1]
                    row[f"{engine}_steps_per_second"] = evaluation.mean("steps_per_second")
                    row[f"{engine}_survived"] = evaluation.survivors
                yield {**row, "difference": scores[1] / scores[0] - 1.0}
