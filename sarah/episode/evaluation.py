"""How good a parameter set is: many episodes on fixed seeds, and what they have in common."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from statistics import mean, median, pstdev

from sarah.episode.result import EpisodeResult

SMALLEST_EVENT_SHARE = 0.9
"""Share of SHIFT and of LIFT phases that sensors end, below which a gait is a clock."""
SMALLEST_CLEARANCE = 0.010
"""Sole clearance in m below which a gait is a shuffle."""

LARGEST_ACCELERATION_RATIO = 1.5
"""How much more the torso may accelerate above 20 Hz than with V1 to V4 at zero, before that counts as chatter."""


@dataclass(frozen=True)
class Evaluation:
    """What a number of episodes have in common.

    :param episodes: how many
    :param score_mean: of :attr:`~sarah.episode.result.EpisodeResult.score`; ``_median``, ``_std``, ``_min`` likewise
    :param steps_per_second_mean: in 1/s; ``_median``, ``_std`` likewise
    :param drift_mean: of the torso's horizontal distance from its start at the end, in m; ``_median``, ``_std``,
        ``_max`` likewise
    :param survival_rate: share of the episodes that ran to their time limit
    :param diverged: how many ended because the simulation no longer returned numbers
    :param event_driven_shift_mean: share of the SHIFT phases that sensors ended
    :param event_driven_lift_mean: the same of the LIFT phases
    :param sole_clearance_mean: in m
    :param vibration_median: of the torso's acceleration power above 20 Hz, in m^2/s^4
    :param actuator_power_mean: of the six actuators together, in W
    :param peak_hip_rate_max: in rad/s
    :param peak_leg_speed_max: in m/s
    """

    episodes: int
    score_mean: float
    score_median: float
    score_std: float
    score_min: float
    steps_per_second_mean: float
    steps_per_second_median: float
    steps_per_second_std: float
    drift_mean: float
    drift_median: float
    drift_std: float
    drift_max: float
    survival_rate: float
    diverged: int
    event_driven_shift_mean: float
    event_driven_lift_mean: float
    sole_clearance_mean: float
    vibration_median: float
    actuator_power_mean: float
    peak_hip_rate_max: float
    peak_leg_speed_max: float

    @property
    def is_gait(self) -> bool:
        """:func:`is_gait` of the means."""
        return is_gait(self.event_driven_shift_mean, self.event_driven_lift_mean, self.sole_clearance_mean)

    def chatters(self, without: Evaluation) -> bool:
        """Whether the hips shake the torso at frequencies that no real actuator follows.

        :param without: the same episodes with V1 to V4 at zero; if those fell too early to tell, there is no verdict
        """
        return self.vibration_median > LARGEST_ACCELERATION_RATIO**2 * without.vibration_median > 0.0


def is_gait(event_driven_shift: float, event_driven_lift: float, sole_clearance: float) -> bool:
    """Whether the robot steps by its sensors and lifts its feet, and does not shuffle to a clock.

    :param event_driven_shift: share of the SHIFT phases that sensors ended
    :param event_driven_lift: the same of the LIFT phases
    :param sole_clearance: in m
    """
    shares = (event_driven_shift, event_driven_lift)
    return min(shares) >= SMALLEST_EVENT_SHARE and sole_clearance >= SMALLEST_CLEARANCE


def summarise(results: Iterable[EpisodeResult]) -> Evaluation:
    """Summarise episodes.

    :param results: of at least one episode
    """
    episodes = list(results)
    scores = [result.score for result in episodes]
    frequencies = [result.steps_per_second for result in episodes]
    drifts = [result.drift for result in episodes]
    return Evaluation(
        episodes=len(episodes),
        score_mean=mean(scores),
        score_median=median(scores),
        score_std=pstdev(scores),
        score_min=min(scores),
        steps_per_second_mean=mean(frequencies),
        steps_per_second_median=median(frequencies),
        steps_per_second_std=pstdev(frequencies),
        drift_mean=mean(drifts),
        drift_median=median(drifts),
        drift_std=pstdev(drifts),
        drift_max=max(drifts),
        survival_rate=mean(result.survived for result in episodes),
        diverged=sum(result.termination == "diverged" for result in episodes),
        event_driven_shift_mean=mean(result.event_driven_shift for result in episodes),
        event_driven_lift_mean=mean(result.event_driven_lift for result in episodes),
        sole_clearance_mean=mean(result.sole_clearance for result in episodes),
        vibration_median=median(result.vibration for result in episodes),
        actuator_power_mean=mean(result.actuator_power for result in episodes),
        peak_hip_rate_max=max(result.peak_hip_rate for result in episodes),
        peak_leg_speed_max=max(result.peak_leg_speed for result in episodes),
    )
