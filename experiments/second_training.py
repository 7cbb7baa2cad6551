"""The Second Training over many seeds: what was learned, pushed by 100 N, and stepping without a push.

Every controller meets the same pushes, and some of them at the reference physics too.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass

from experiments.record import Row
from experiments.trainings import OfTrainings
from sarah.control.parameters import BALANCE_PARAMETERS
from sarah.episode.evaluation import Evaluation, evaluate
from sarah.episode.push import Push
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.episode.workers import Workers
from sarah.reports.robustness import push_many, robustness_table
from sarah.runs.config import TrainingConfig
from sarah.simulation.physics import PHYSICS

NEWTONS = 100.0
"""Force of the pushes that judge, in N."""


@dataclass(frozen=True)
class SecondTraining(OfTrainings):
    """Second Trainings by NAF, judged beside V = 0.

    :param seeds: number of trainings
    :param budget: number of episodes of a training
    :param pushes: number of pushes of 100 N
    :param reference_pushes: number of them that are simulated at the reference physics too
    :param unpushed: number of episodes without a push
    """

    seeds: int = 10
    budget: int = 300
    pushes: int = 50
    reference_pushes: int = 12
    unpushed: int = 4

    def rows(self) -> Iterator[Row]:
        """A row for V = 0, and one for each training."""
        config = self.episode("balance")
        assert BALANCE.neutral is not None and isinstance(config, BalanceConfig)
        with Workers(self.workers) as workers:
            yield self._row("V = 0", BALANCE.neutral, config, workers)
            for seed in range(self.seeds):
                training = TrainingConfig("balance", episodes=self.budget, seed=seed, episode=config)
                learned = self.trained(training, workers).parameters()
                yield self._row(f"naf seed {seed}", learned, config, workers)

    def _row(self, run: str, parameters: tuple[float, ...], config: BalanceConfig, workers: Workers) -> Row:
        fine = dataclasses.replace(config, physics=PHYSICS["reference"])
        free = dataclasses.replace(config, push=Push(newtons=(0.0, 0.0)), time_limit=30.0)
        (pushed,) = push_many([parameters], config, workers, (NEWTONS,), self.pushes)
        (pushed_at_reference,) = push_many([parameters], fine, workers, (NEWTONS,), self.reference_pushes)
        survival = {row.direction: row.survival for row in robustness_table(pushed)}
        everywhere = Evaluation(tuple(push.result for push in pushed))
        same_pushes = Evaluation(everywhere.results[: self.reference_pushes])
        reference = Evaluation(tuple(push.result for push in pushed_at_reference))
        stepping = evaluate(BALANCE.name, parameters, free, range(self.unpushed), workers)
        return {
            "run": run,
            **{parameter.name: value for parameter, value in zip(BALANCE_PARAMETERS, parameters, strict=True)},
            "survival": survival["all"],
            "lateral_survival": survival.get("lateral"),
            "sagittal_survival": survival.get("sagittal"),
            "score": everywhere.mean("score"),
            "unpushed_score": stepping.mean("score"),
            "unpushed_steps_per_second": stepping.mean("steps_per_second"),
            "unpushed_sole_clearance_mm": 1000.0 * stepping.mean("sole_clearance"),
            "vibration_m2_s4": everywhere.median("vibration"),
            "unpushed_vibration_m2_s4": stepping.median("vibration"),
            "reference_survival": reference.survival_rate,
            "kept": reference.mean("score") / same_pushes.mean("score"),
        }
