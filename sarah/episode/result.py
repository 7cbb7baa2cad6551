"""What came out of an episode, and the one table of the metrics that judge it."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from sarah.episode.trace import Trace
from sarah.errors import SimulationError


@dataclass(frozen=True)
class Metric:
    """A number that an episode ends with.

    :param name: name of the field or property of :class:`EpisodeResult`
    :param unit: SI unit; empty for a number without one
    :param meaning: what it measures, as a noun phrase
    :param statistics: how the episodes of an evaluation are summarised: names of :data:`STATISTICS`
    :param group: group of learning curves that it is shown in; empty for none
    """

    name: str
    unit: str
    meaning: str
    statistics: tuple[str, ...] = ()
    group: str = ""


def _metric(unit: str, meaning: str, *statistics: str, group: str = "") -> Any:
    return field(metadata={"unit": unit, "meaning": meaning, "statistics": statistics, "group": group})


@dataclass(frozen=True)
class EpisodeResult:
    """What came out of an episode. Every number is a metric, which :data:`METRICS` explains.

    :param termination: how it ended: one of :data:`~sarah.episode.ending.TERMINATIONS`
    :param final_position: position of the torso's centre at the end, x and y relative to the start, z over the floor,
        in m
    :param trace: what happened in every control tick, on request
    """

    termination: str
    final_position: tuple[float, float, float]
    score: float = _metric(
        "",
        "return over its ceiling; 1 is standing height, start position and three steps per second all along",
        "mean",
        "median",
        "std",
        "min",
        group="episode",
    )
    episode_return: float = _metric("m³ s", "equation 2 integrated over the time that the pattern generator ran")
    steps_per_second: float = _metric("1/s", "mean over that time", "mean", "median", "std", group="episode")
    steps: int = _metric("", "number of completed steps")
    duration: float = _metric("s", "simulated time, the first second of standing included", group="episode")
    shifts_by_sensors: float = _metric("", "share of the SHIFT phases that sensors ended", "mean", group="gait")
    lifts_by_sensors: float = _metric("", "share of the LIFT phases that sensors ended", "mean", group="gait")
    sole_clearance: float = _metric(
        "m", "median over the steps of the swing foot's largest height over the floor", "mean", group="gait"
    )
    vibration: float = _metric(
        "m²/s⁴", "mean square of the torso's acceleration above 20 Hz: chatter", "median", group="actuators"
    )
    actuator_power: float = _metric(
        "W", "mean mechanical power of the six actuators together", "mean", group="actuators"
    )
    peak_hip_rate: float = _metric("rad/s", "fastest hip motion", "max")
    peak_leg_speed: float = _metric("m/s", "fastest change of a leg's length", "max")
    trace: Trace | None = field(default=None, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Refuse numbers that would poison whoever learns from them."""
        for name, value in self.fields().items():
            if not isinstance(value, str) and not math.isfinite(
                math.hypot(*value) if isinstance(value, tuple) else value
            ):
                raise SimulationError(f"{name} of an episode must be finite, not {value!r}")

    def fields(self) -> dict[str, Any]:
        """Every field but the trace, by name."""
        return {field.name: getattr(self, field.name) for field in dataclasses.fields(self) if field.name != "trace"}

    def columns(self) -> dict[str, Any]:
        """What ``episodes.csv`` holds of it, by column."""
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
    **{
        field.name: Metric(field.name, **field.metadata)
        for field in dataclasses.fields(EpisodeResult)
        if field.metadata
    },
    "drift": Metric(
        "drift",
        "m",
        "horizontal distance of the torso from its start at the end",
        ("mean", "median", "std", "max"),
    ),
}
"""Every metric by its name."""
