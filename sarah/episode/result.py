"""The result of an episode, and the one table of metrics that judge it."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from sarah.episode.gait import GaitMetrics
from sarah.episode.metric import Metric, metric
from sarah.episode.motion import MotionMetrics
from sarah.episode.trace import Trace
from sarah.errors import SimulationError


@dataclass(frozen=True)
class ScoreMetrics:
    """How an episode ended, and what it was worth.

    :param termination: way in which it ended, one of :data:`~sarah.episode.ending.TERMINATIONS`
    :param final_position: position of the torso's centre at the end, x and y relative to the start, z over the floor,
        in m
    """

    termination: str
    final_position: tuple[float, float, float]
    score: float = metric(
        "score",
        "",
        "return as a share of the best: standing height, start position and the rewarded step frequency all the time",
        *("mean", "median", "std", "min"),
        group="episode",
        shown=(1.0, 3, ""),
        paper="reported as reward, no scale",
    )
    episode_return: float = metric(
        "return", "m³ s", "equation 2 integrated over the time that the pattern generator ran", shown=(1.0, 3, "m³ s")
    )


@dataclass(frozen=True)
class EpisodeResult(MotionMetrics, GaitMetrics, ScoreMetrics):  # whose fields come from the last one on
    """The result of an episode. Every number is a metric, and :data:`METRICS` explains it.

    :param trace: record of every control tick, if it was asked for
    """

    trace: Trace | None = field(default=None, repr=False, compare=False)
    unknown: ClassVar[frozenset[str]] = frozenset()
    """Names of the metrics that it does not tell, whose values mean nothing."""

    def __post_init__(self) -> None:
        """Refuse numbers that are not finite, from which nobody could learn."""
        for name, value in self.fields().items():
            if not isinstance(value, str) and not math.isfinite(
                math.hypot(*value) if isinstance(value, tuple) else value
            ):
                raise SimulationError(f"{name} of an episode must be finite, not {value!r}")

    def fields(self) -> dict[str, Any]:
        """Values of all fields but the trace, by name."""
        return {field.name: getattr(self, field.name) for field in dataclasses.fields(self) if field.name != "trace"}

    def columns(self) -> dict[str, Any]:
        """Values of its row in ``episodes.csv``, by column."""
        values = self.fields()
        x, y, _ = values.pop("final_position")
        return {"return": values.pop("episode_return"), **values, "x": x, "y": y}

    @property
    def survived(self) -> bool:
        """Whether the episode ran to its time limit."""
        return self.termination == "time_limit"

    @property
    def drift(self) -> float:
        """Horizontal distance of the torso from its start at the end, in m."""
        return math.hypot(*self.final_position[:2])


METRICS: Mapping[str, Metric] = {
    **{field.name: field.metadata["metric"] for field in dataclasses.fields(EpisodeResult) if field.metadata},
    "drift": Metric(
        "drift",
        "m",
        "horizontal distance of the torso from its start at the end",
        ("median", "mean", "std", "max"),
        shown=(100.0, 1, "cm"),
        paper="below 25 cm, or the episode ends",
    ),
}
"""Metrics by the name of their field or property in :class:`EpisodeResult`."""
