"""What came out of an episode."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass, field
from typing import Any

from sarah.episode.trace import Trace
from sarah.errors import SimulationError


@dataclass(frozen=True)
class EpisodeResult:
    """What came out of an episode.

    :param score: the return over its ceiling: 1 is standing height, start position, three steps per second all along
    :param episode_return: equation 2 integrated over the time that the pattern generator ran
    :param steps_per_second: mean over that time
    :param steps: completed ones
    :param duration: simulated time, the first second of standing included, in s
    :param termination: how it ended: one of :data:`TERMINATIONS`
    :param final_position: of the torso's centre, x and y relative to the start, z over the floor, in m
    :param sole_clearance: median over the steps of the swing foot's largest height over the floor, in m
    :param event_driven_shift: share of the SHIFT phases ended by sensors, and not by the time-out
    :param event_driven_lift: the same of the LIFT phases
    :param vibration: mean square of the torso's acceleration above 20 Hz, in m^2/s^4; a robot that chatters shows here
    :param actuator_power: mean mechanical power of the six actuators together, in W
    :param peak_hip_rate: fastest hip motion, in rad/s
    :param peak_leg_speed: fastest change of a leg's length, in m/s
    :param trace: what happened in every control tick, on request
    """

    score: float
    episode_return: float
    steps_per_second: float
    steps: int
    duration: float
    termination: str
    final_position: tuple[float, float, float]
    sole_clearance: float
    event_driven_shift: float
    event_driven_lift: float
    vibration: float
    actuator_power: float
    peak_hip_rate: float
    peak_leg_speed: float
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

    @property
    def survived(self) -> bool:
        """Whether the episode ran to its time limit."""
        return self.termination == "time_limit"

    @property
    def drift(self) -> float:
        """Horizontal distance of the torso from its start at the end, in m."""
        return math.hypot(*self.final_position[:2])
