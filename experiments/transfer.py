"""What was learned in one physics engine, in the other: trainings in both, judged on the same seeds and pushes."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass

import tyro

from experiments.engines import ENGINES
from experiments.record import Row
from experiments.maker import TrainingExperiment
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BalanceConfig
from sarah.episode.workers import Workers
from sarah.reports.transfer import transfer
from sarah.runs.config import TrainingConfig


@dataclass(frozen=True)
class TransferBetweenEngines(TrainingExperiment):
    """Trainings by NAF in each engine, evaluated in both.

    :param task: name of the task
    :param episodes: number of episodes in each engine
    :param budget: number of episodes of a training
    :param seeds: number of trainings in each engine
    :param newtons: force of the pushes that judge, in N
    """

    task: tyro.conf.Suppress[str]
    episodes: int
    budget: int
    seeds: int = 10
    newtons: float = 100.0

    def rows(self) -> Iterator[Row]:
        """A row for each training."""
        with Workers(self.workers) as workers:
            for engine in ENGINES:
                for seed in range(self.seeds):
                    config = self.episode(self.task, engine)
                    training = TrainingConfig(self.task, episodes=self.budget, seed=seed, episode=config)
                    yield self._row(training, workers)

    def _row(self, training: TrainingConfig, workers: Workers) -> Row:
        config = training.episode
        if isinstance(config, BalanceConfig):
            push = dataclasses.replace(config.push, newtons=(self.newtons, self.newtons))
            config = dataclasses.replace(config, push=push)
        parameters = self.trained(training, workers).parameters()
        learned = EpisodeSpec(parameters, 0, self.task, config)
        (found,) = transfer([(f"naf seed {training.seed}", learned)], range(self.episodes), workers)
        row: dict[str, object] = {"run": found.name, "task": self.task, "learned_in": config.engine}
        for engine, evaluation in found.evaluations.items():
            row[f"{engine}_score"] = evaluation.mean("score")
            row[f"{engine}_survival"] = evaluation.survival_rate
            row[f"{engine}_steps_per_second"] = evaluation.mean("steps_per_second")
            row[f"{engine}_vibration_m2_s4"] = evaluation.median("vibration")
        return {**row, "kept": found.kept}
