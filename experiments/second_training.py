"""The Second Training over many seeds: what was learned, under three kinds of pushes, and stepping without one.

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
from sarah.episode.spec import FIRST_EVALUATION_SEED
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.episode.workers import Workers
from sarah.runs.config import TrainingConfig
from sarah.simulation.physics import PHYSICS

PUSHES = {
    "push_100_survival": Push((100.0, 100.0), at_seconds=(2.0, 3.0)),
    "push_125_survival": Push((125.0, 125.0), at_seconds=(2.0, 3.0)),
    "sagittal_115_survival": Push((115.0, 115.0), at_seconds=(2.0, 3.0), sagittal_share=1.0),
}
"""Pushes that judge, by the column of their survivors: from all directions, and from within 30 degrees of front or
back."""
PUSHED_SECONDS, FREE_SECONDS = 8.0, 12.0
"""Time limits with a push and without, in s."""


@dataclass(frozen=True)
class SecondTraining(OfTrainings):
    """Second Trainings by NAF, judged beside V = 0.

    :param seeds: number of trainings
    :param budget: number of episodes of a training
    :param pushes: number of pushes of each kind
    :param reference_pushes: number of those of 125 N that are simulated at the reference physics too
    :param unpushed: number of episodes without a push
    """

    seeds: int = 10
    budget: int = 300
    pushes: int = 100
    reference_pushes: int = 12
    unpushed: int = 10

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
        def judged(push: Push, episodes: int, seconds: float, physics: str = "standard") -> Evaluation:
            limit = self.time_limit or seconds
            judge = dataclasses.replace(config, push=push, time_limit=limit, physics=PHYSICS[physics])
            seeds = range(FIRST_EVALUATION_SEED, FIRST_EVALUATION_SEED + episodes)
            return evaluate(BALANCE, parameters, judge, seeds, workers)

        pushed = {column: judged(push, self.pushes, PUSHED_SECONDS) for column, push in PUSHES.items()}
        hard = pushed["push_125_survival"]
        reference = judged(PUSHES["push_125_survival"], self.reference_pushes, PUSHED_SECONDS, "reference")
        same_pushes = Evaluation(hard.results[: self.reference_pushes])
        stepping = judged(Push((0.0, 0.0)), self.unpushed, FREE_SECONDS)
        return {
            "run": run,
            **{parameter.name: value for parameter, value in zip(BALANCE_PARAMETERS, parameters, strict=True)},
            **{column: found.survival_rate for column, found in pushed.items()},
            "score": hard.mean("score"),
            "unpushed_score": stepping.mean("score"),
            "unpushed_steps_per_second": stepping.mean("steps_per_second"),
            "unpushed_sole_clearance_mm": 1000.0 * stepping.mean("sole_clearance"),
            "vibration_m2_s4": hard.median("vibration"),
            "unpushed_vibration_m2_s4": stepping.median("vibration"),
            "reference_survival": reference.survival_rate,
            "kept": reference.mean("score") / same_pushes.mean("score"),
        }
