"""How good a parameter set is: many episodes on fixed seeds, and what they have in common."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from statistics import mean, median, pstdev
from typing import Any

from sarah.episode.result import METRICS, EpisodeResult
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.workers import Executor, Workers
from sarah.errors import ConfigurationError, unknown_name

STATISTICS: dict[str, Callable[[Sequence[float]], float]] = {
    "mean": mean,
    "median": median,
    "std": pstdev,
    "min": min,
    "max": max,
}
"""How a metric of several episodes becomes one number."""
SMALLEST_SENSOR_SHARE = 0.9
"""Share of SHIFT and of LIFT phases that sensors end, below which a gait is a clock."""
SMALLEST_CLEARANCE = 0.010
"""Sole clearance in m below which a gait is a shuffle."""
LARGEST_ACCELERATION_RATIO = 1.5
"""Ratio of the torso's acceleration above 20 Hz to the baseline's beyond which a controller chatters."""


@dataclass(frozen=True)
class Evaluation:
    """Episodes of one parameter set, and what they have in common.

    :param results: results of at least one episode
    """

    results: tuple[EpisodeResult, ...]

    def statistic(self, metric: str, name: str) -> float:
        """One number for a metric of all episodes.

        :param metric: name of the metric, one of :data:`~sarah.episode.result.METRICS`
        :param name: name of the statistic, one of :data:`STATISTICS`
        :raises ConfigurationError: if there is no such metric
        """
        if metric not in METRICS:
            raise ConfigurationError(unknown_name("metric", metric, METRICS))
        return STATISTICS[name]([getattr(result, metric) for result in self.results])

    def mean(self, metric: str) -> float:
        """Mean of a metric.

        :param metric: name of the metric
        """
        return self.statistic(metric, "mean")

    def median(self, metric: str) -> float:
        """Median of a metric.

        :param metric: name of the metric
        """
        return self.statistic(metric, "median")

    @property
    def episodes(self) -> int:
        """Number of episodes."""
        return len(self.results)

    @property
    def survivors(self) -> int:
        """Number of episodes that ran to their time limit."""
        return sum(result.survived for result in self.results)

    @property
    def survival_rate(self) -> float:
        """Share of the episodes that ran to their time limit."""
        return mean(result.survived for result in self.results)

    @property
    def diverged(self) -> int:
        """Number of episodes that ended because the simulation returned no numbers."""
        return sum(result.termination == "diverged" for result in self.results)

    @property
    def is_gait(self) -> bool:
        """Whether the robot steps by its sensors and lifts its feet, and does not shuffle to a clock."""
        shares = (self.mean("shifts_by_sensors"), self.mean("lifts_by_sensors"))
        return min(shares) >= SMALLEST_SENSOR_SHARE and self.mean("sole_clearance") >= SMALLEST_CLEARANCE

    def chatters(self, baseline: Evaluation) -> bool:
        """Whether the hips shake the torso at frequencies that no real actuator follows.

        :param baseline: the same episodes with V1 to V4 at zero; if those fell too early to tell, there is no verdict
        """
        still = baseline.median("vibration")
        return self.median("vibration") > LARGEST_ACCELERATION_RATIO**2 * still > 0.0

    def summary(self) -> dict[str, Any]:
        """Every statistic of every metric, as files and ``--json`` have them."""
        statistics = {
            f"{metric}_{name}": self.statistic(metric, name)
            for metric in METRICS
            for name in METRICS[metric].statistics
        }
        return {
            "episodes": self.episodes,
            "survival_rate": self.survival_rate,
            "diverged": self.diverged,
            **statistics,
        }


def evaluate(
    task: str,
    parameters: tuple[float, ...],
    config: EpisodeConfig,
    seeds: Iterable[int],
    workers: Executor | None = None,
) -> Evaluation:
    """Simulate parameters on some seeds.

    :param task: name of the task
    :param parameters: values of its parameters
    :param config: settings of the episodes
    :param seeds: seeds of the episodes; those below 2^31 are in no training
    :param workers: who simulates; by default this process does
    """
    specs = [EpisodeSpec(parameters, seed, task, config) for seed in seeds]
    return Evaluation(tuple((workers or Workers()).simulate_all(specs)))
