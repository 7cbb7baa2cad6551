"""The result of an episode, and the one table of metrics that judge it."""

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
    """A metric: a number that describes an episode.

    :param label: name on pages and in tables
    :param unit: SI unit; empty for a number without one
    :param meaning: quantity that it measures, as a noun phrase
    :param statistics: statistics of several episodes that are shown, the most telling one first; names of
        :data:`~sarah.episode.evaluation.STATISTICS`
    :param group: group of its learning curve; empty if it has none
    :param shown: display format: factor on the SI value, number of decimals, and unit after the factor
    :param paper: value or remark that the paper gives
    """

    label: str
    unit: str
    meaning: str
    statistics: tuple[str, ...] = ()
    group: str = ""
    shown: tuple[float, int, str] = (1.0, 2, "")
    paper: str = ""

    def text(self, value: float) -> str:
        """Text of a value with its unit, for people.

        :param value: value in the SI unit
        """
        factor, decimals, unit = self.shown
        return f"{factor * value:.{decimals}f} {unit}".rstrip()


def _metric(label: str, unit: str, meaning: str, *statistics: str, **others: Any) -> Any:
    return field(metadata={"metric": Metric(label, unit, meaning, statistics, **others)})


@dataclass(frozen=True)
class EpisodeResult:
    """The result of an episode. Every number is a metric, and :data:`METRICS` explains it.

    :param termination: way in which it ended, one of :data:`~sarah.episode.ending.TERMINATIONS`
    :param final_position: position of the torso's centre at the end, x and y relative to the start, z over the floor,
        in m
    :param trace: record of every control tick, if it was asked for
    """

    termination: str
    final_position: tuple[float, float, float]
    score: float = _metric(
        "score",
        "",
        "return over its ceiling; 1 is standing height, start position and the rewarded step frequency all along",
        *("median", "mean", "std", "min"),
        group="episode",
        shown=(1.0, 3, ""),
        paper="reported as reward, no scale",
    )
    episode_return: float = _metric(
        "return", "m³ s", "equation 2 integrated over the time that the pattern generator ran", shown=(1.0, 3, "m³ s")
    )
    steps_per_second: float = _metric(
        "steps per second",
        "1/s",
        "mean number of completed steps per second over that time",
        *("median", "mean", "std"),
        group="episode",
        paper="3 to 5, a human's",
    )
    steps: int = _metric("steps", "", "number of completed steps", shown=(1.0, 0, ""))
    duration: float = _metric(
        "duration", "s", "simulated time, the first second of standing included", group="robot", shown=(1.0, 1, "s")
    )
    shifts_by_sensors: float = _metric(
        "SHIFT by sensors",
        "",
        "share of the SHIFT phases that sensors ended",
        "mean",
        group="robot",
        shown=(100.0, 1, "%"),
    )
    lifts_by_sensors: float = _metric(
        "LIFT by sensors",
        "",
        "share of the LIFT phases that sensors ended",
        "mean",
        group="robot",
        shown=(100.0, 1, "%"),
    )
    sole_clearance: float = _metric(
        "sole clearance",
        "m",
        "median over the steps of the swing foot's largest height over the floor",
        "mean",
        group="robot",
        shown=(1000.0, 1, "mm"),
    )
    vibration: float = _metric(
        "vibration",
        "m²/s⁴",
        "mean square of the torso's acceleration from 20 to 50 Hz: chatter",
        "median",
        group="robot",
        shown=(1.0, 1, "m²/s⁴"),
    )
    actuator_power: float = _metric(
        "actuator power",
        "W",
        "mean mechanical power of the six actuators together",
        "mean",
        group="robot",
        shown=(1.0, 0, "W"),
    )
    peak_hip_rate: float = _metric("peak hip rate", "rad/s", "fastest hip motion", "max", shown=(1.0, 1, "rad/s"))
    peak_leg_speed: float = _metric(
        "peak leg speed", "m/s", "fastest change of a leg's length", "max", shown=(1.0, 2, "m/s")
    )
    trace: Trace | None = field(default=None, repr=False, compare=False)

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
