"""How hard a push the robot comes back from: one Second Training beside V = 0, by force and direction."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from experiments.record import Row
from experiments.trainings import TrainingExperiment
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.episode.workers import Workers
from sarah.reports.robustness import FORCES, push_many, robustness_table, wilson_interval
from sarah.runs.config import TrainingConfig


@dataclass(frozen=True)
class Robustness(TrainingExperiment):
    """Pushes of several forces, the same for a Second Training by NAF and for V = 0.

    :param seed: seed of the training
    :param budget: number of episodes of the training
    :param episodes: number of pushes of each force
    :param forces: forces of the pushes, in N
    """

    seed: int = 3
    budget: int = 300
    episodes: int = 40
    forces: tuple[float, ...] = FORCES

    def rows(self) -> Iterator[Row]:
        """A row for each controller, force and group of directions."""
        config = self.episode("balance")
        assert BALANCE.neutral is not None and isinstance(config, BalanceConfig)
        training = TrainingConfig("balance", episodes=self.budget, seed=self.seed, episode=config)
        with Workers(self.workers) as workers:
            learned = self.trained(training, workers).parameters()
            controllers = {
                "V = 0": BALANCE.neutral,
                f"V = ({', '.join(f'{value:.2f}' for value in learned)})": learned,
            }
            for controller, parameters in controllers.items():
                (pushed,) = push_many([parameters], config, workers, self.forces, self.episodes)
                for (newtons, direction), found in robustness_table(pushed).items():
                    low, high = wilson_interval(found.survivors, found.episodes)
                    yield {
                        "controller": controller,
                        "push_n": f"{newtons:g}",
                        "direction": direction,
                        "episodes": found.episodes,
                        "survival": found.survival_rate,
                        "survival_low": low,
                        "survival_high": high,
                        "score": found.median("score"),
                        "drift_cm": 100.0 * found.median("drift"),
                        "vibration_m2_s4": found.median("vibration"),
                    }
