"""The quality of parameters: many episodes on fixed seeds, and their statistics."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from statistics import mean, median, pstdev
from typing import Any

from sarah.episode.gait import LEAST_CLEARANCE
from sarah.episode.result import METRICS, EpisodeResult
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import Task, task_named
from sarah.episode.workers import Executor, executor_of
from sarah.errors import ConfigurationError, shortened, unknown_name

STATISTICS: dict[str, Callable[[Sequence[float]], float]] = {
    "mean": mean,
    "median": median,
    "std": pstdev,
    "min": min,
    "max": max,
}
"""Statistics that make one number of a metric's values in several episodes."""
SMALLEST_SENSOR_SHARE = 0.9
"""Share of SHIFT and of LIFT phases ended by sensors below which a gait follows the time-outs, as a clock."""
LARGEST_ACCELERATION_RATIO = 1.5
"""Ratio of the torso's acceleration from 20 to 50 Hz to that with neutral parameters, beyond which the hips chatter."""


@dataclass(frozen=True)
class Evaluation:
    """Episodes of the same parameters, and their statistics.

    :param results: results of the episodes, at least one
    :param least_clearance: sole clearance of a valid gait, in m
    """

    results: tuple[EpisodeResult, ...]
    least_clearance: float = LEAST_CLEARANCE

    def statistic(self, metric: str, name: str) -> float:
        """Statistic of a metric over all episodes.

        :param metric: name of the metric, one of :data:`~sarah.episode.result.METRICS`
        :param name: name of the statistic, one of :data:`STATISTICS`
        :raises ConfigurationError: if there is no such metric or statistic
        """
        if metric not in METRICS:
            raise ConfigurationError(unknown_name("metric", metric, METRICS))
        if name not in STATISTICS:
            raise ConfigurationError(unknown_name("statistic", name, STATISTICS))
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
        """Number of episodes that ended because the simulation diverged."""
        return sum(result.termination == "diverged" for result in self.results)

    @property
    def is_gait(self) -> bool:
        """Whether the gait is valid: sensors end its phases, and the soles clear the floor."""
        shares = (self.mean("shifts_by_sensors"), self.mean("lifts_by_sensors"))
        return min(shares) >= SMALLEST_SENSOR_SHARE and self.mean("sole_clearance") >= self.least_clearance

    def chatters(self, neutral: Evaluation) -> bool:
        """Whether the hips shake the torso at frequencies that no real actuator follows.

        :param neutral: same episodes with the task's neutral parameters, such as V1 to V4 at zero; if they ended too
            early to measure, the answer is no
        """
        still = neutral.median("vibration")
        return self.median("vibration") > LARGEST_ACCELERATION_RATIO**2 * still > 0.0

    def shortcomings(self, must_step: bool, neutral: Evaluation | None) -> list[str]:
        """Reasons in words not to recommend the parameters.

        :param must_step: whether the task wants a gait; otherwise every gait is valid
        :param neutral: episodes that chatter is judged against; without them nothing chatters
        """
        found = []
        if must_step and not self.is_gait:
            found.append("no valid gait: the robot steps to a clock, or does not lift its feet")
        if neutral is not None and self.chatters(neutral):
            found.append("the hips chatter: no real actuator could follow that")
        return found

    def summary(self) -> dict[str, Any]:
        """Statistics of all metrics by name, for files and for ``--json``."""
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


@dataclass(frozen=True)
class NotedEvaluation(Evaluation):
    """Episodes of which a file has no more than the summary.

    :param noted: summary of their evaluation, see :meth:`Evaluation.summary`
    """

    noted: Mapping[str, float] = field(kw_only=True)

    def statistic(self, metric: str, name: str) -> float:
        """Statistic of a metric.

        :raises KeyError: if summaries do not have it
        """
        return float(self.noted[f"{metric}_{name}"])

    def summary(self) -> dict[str, Any]:
        """The summary."""
        return dict(self.noted)

    @property
    def episodes(self) -> int:
        """Number of episodes."""
        return int(self.noted["episodes"])

    @property
    def survivors(self) -> int:
        """Number of episodes that ran to their time limit."""
        return round(self.survival_rate * self.episodes)

    @property
    def survival_rate(self) -> float:
        """Share of the episodes that ran to their time limit."""
        return self.noted["survival_rate"]

    @property
    def diverged(self) -> int:
        """Number of episodes that ended because the simulation diverged."""
        return int(self.noted["diverged"])


def evaluate(
    task: str | Task[Any],
    parameters: tuple[float, ...],
    config: EpisodeConfig,
    seeds: Iterable[int],
    workers: Executor | None = None,
    progress: Callable[[Iterable[EpisodeResult]], Iterable[EpisodeResult]] = iter,
) -> Evaluation:
    """Simulate the same parameters on several seeds.

    :param task: task, or the name of one of this package
    :param parameters: values of the task's parameters, in order
    :param config: settings of the episodes
    :param seeds: seeds of the episodes; no training uses those below 2^31
    :param workers: executor that simulates the episodes; by default this process does
    :param progress: function that passes the results on, and may show how many there are so far
    :raises ConfigurationError: for an unknown task, parameters out of their box, or no seeds
    """
    executor = executor_of(workers)
    if not isinstance(seeds, Iterable):
        raise ConfigurationError(f"seeds must be several whole numbers, such as range(10), not {shortened(seeds)}")
    specs = [EpisodeSpec(parameters, seed, task_named(task), config) for seed in seeds]
    if not specs:
        raise ConfigurationError("seeds must not be empty: an evaluation needs an episode")
    return Evaluation(tuple(progress(executor.simulate_all(specs))), config.least_clearance)
