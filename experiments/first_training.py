"""The First Training over many seeds: what was learned, on unseen seeds and at the reference physics."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass

from experiments.record import Row
from experiments.trainings import TrainingExperiment
from sarah.control.parameters import PAPER_STEPPING, STEPPING_PARAMETERS
from sarah.episode.evaluation import evaluate
from sarah.episode.settings import EpisodeConfig
from sarah.episode.workers import Workers
from sarah.runs.config import TrainingConfig
from sarah.simulation.physics import PHYSICS


@dataclass(frozen=True)
class FirstTraining(TrainingExperiment):
    """First Trainings by NAF, judged beside the paper's P1 to P5.

    :param seeds: number of trainings
    :param budget: number of episodes of a training
    :param episodes: number of unseen seeds at the standard physics
    :param reference_episodes: number of unseen seeds at the reference physics
    """

    seeds: int = 10
    budget: int = 100
    episodes: int = 12
    reference_episodes: int = 4

    def rows(self) -> Iterator[Row]:
        """A row for the paper's parameters, and one for each training."""
        with Workers(self.workers) as workers:
            config = self.episode("stepping")
            yield self._row("paper", PAPER_STEPPING, config, workers)
            for seed in range(self.seeds):
                training = TrainingConfig("stepping", episodes=self.budget, seed=seed, episode=config)
                learned = self.trained(training, workers).parameters()
                yield self._row(f"naf seed {seed}", learned, config, workers)

    def _row(self, run: str, parameters: tuple[float, ...], config: EpisodeConfig, workers: Workers) -> Row:
        at_reference = dataclasses.replace(config, physics=PHYSICS["reference"])
        found = evaluate("stepping", parameters, config, range(self.episodes), workers)
        reference = evaluate("stepping", parameters, at_reference, range(self.reference_episodes), workers)
        score, reference_score = found.median("score"), reference.median("score")
        return {
            "run": run,
            **{parameter.name: value for parameter, value in zip(STEPPING_PARAMETERS, parameters, strict=True)},
            "score": score,
            "steps_per_second": found.mean("steps_per_second"),
            "survival": found.survival_rate,
            "shifts_by_sensors": found.mean("shifts_by_sensors"),
            "lifts_by_sensors": found.mean("lifts_by_sensors"),
            "sole_clearance_mm": 1000.0 * found.mean("sole_clearance"),
            "reference_score": reference_score,
            "kept": reference_score / score if score else None,
        }
