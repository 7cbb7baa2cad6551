"""How hard a push the robot comes back from: survival by force and direction, against the same pushes without V1 to V4.

Both controllers meet the same pushes on the same seeds, in random directions at random times. A push is lateral if it
points within 45 degrees of the robot's right or left, and sagittal otherwise.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median

from sarah.episode.push import draw_push
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.episode.workers import Workers

FORCES = (25.0, 50.0, 75.0, 100.0, 125.0, 150.0)
"""Of the pushes, in N."""
PUSHED_BETWEEN = (2.0, 4.0)
"""When the pushes begin, in s: one to three seconds after the pattern generator's start."""
SECONDS_AFTER = 10.0
"""How long after the latest push the robot must stay up."""
DIRECTIONS = ("all", "lateral", "sagittal")
SECTORS = (16, 8, 4)
"""How many directions survival may be shown by."""
CONFIDENCE_QUANTILE = 1.96
"""Of the normal distribution, for intervals of 95 %."""


@dataclass(frozen=True)
class PushedEpisode:
    """One episode with its push.

    :param newtons: of the push
    :param radians: its direction: 0 to the right, pi/2 forward
    :param result: what came of it
    """

    newtons: float
    radians: float
    result: EpisodeResult

    @property
    def direction(self) -> str:
        """``"lateral"`` or ``"sagittal"``."""
        return "lateral" if abs(math.cos(self.radians)) > abs(math.sin(self.radians)) else "sagittal"


@dataclass(frozen=True)
class Robustness:
    """What pushes of one force in one group of directions did.

    :param newtons: of the pushes
    :param direction: one of :data:`DIRECTIONS`
    :param episodes: how many
    :param survival: share that stayed up, and the ends of its 95 % interval
    :param score_median: of the episodes' scores
    :param drift_median: of the horizontal distance from the start at the end, in m
    :param vibration_median: of the torso's acceleration power above 20 Hz, in m^2/s^4
    """

    newtons: float
    direction: str
    episodes: int
    survival: float
    survival_low: float
    survival_high: float
    score_median: float
    drift_median: float
    vibration_median: float


def push_many(
    controllers: Sequence[tuple[float, ...]],
    config: BalanceConfig,
    workers: Workers,
    forces: Sequence[float] = FORCES,
    episodes: int = 100,
    first_seed: int = 0,
) -> list[list[PushedEpisode]]:
    """Push several controllers by the same pushes.

    :param controllers: V1 to V4 of each
    :param config: settings of the episodes; time limit, and force and time of the push, are replaced
    :param workers: that simulate them
    :param forces: in N
    :param episodes: of each force
    :param first_seed: of the episodes; each force meets the same seeds, and so the same directions and times
    :return: the episodes of each controller
    """
    settings: dict[float, BalanceConfig] = {}
    for newtons in forces:
        push = dataclasses.replace(config.push, newtons=(newtons, newtons), at_seconds=PUSHED_BETWEEN)
        limit = PUSHED_BETWEEN[1] + push.duration + SECONDS_AFTER
        settings[newtons] = dataclasses.replace(config, push=push, time_limit=limit)
    pushes = [(newtons, first_seed + index) for newtons in forces for index in range(episodes)]
    results = workers.simulate_all(
        [EpisodeSpec(v, seed, BALANCE.name, settings[newtons]) for v in controllers for newtons, seed in pushes]
    )
    pushed = []
    for (newtons, seed), result in zip(pushes * len(controllers), results, strict=True):
        x, y, _ = draw_push(settings[newtons].push, seed).force
        pushed.append(PushedEpisode(newtons, math.atan2(y, x), result))
    return [pushed[index * len(pushes) : (index + 1) * len(pushes)] for index in range(len(controllers))]


def robustness_table(episodes: Sequence[PushedEpisode]) -> list[Robustness]:
    """Summarise pushed episodes by force and direction.

    :param episodes: of one controller
    """
    rows = []
    for newtons in sorted({episode.newtons for episode in episodes}):
        for direction in DIRECTIONS:
            group = [e.result for e in episodes if e.newtons == newtons and direction in ("all", e.direction)]
            if group:
                rows.append(_summary(newtons, direction, group))
    return rows


def _summary(newtons: float, direction: str, group: Sequence[EpisodeResult]) -> Robustness:
    survived = sum(result.survived for result in group)
    return Robustness(
        newtons,
        direction,
        len(group),
        survived / len(group),
        *wilson_interval(survived, len(group)),
        median(result.score for result in group),
        median(result.drift for result in group),
        median(result.vibration for result in group),
    )


def wilson_interval(successes: int, trials: int) -> tuple[float, float]:
    """Wilson's 95 % interval of a probability (Wilson 1927); it stays within 0 and 1 and is not empty at either end.

    :param successes: how many
    :param trials: of how many
    """
    z2 = CONFIDENCE_QUANTILE**2
    share = successes / trials
    centre = share + z2 / (2 * trials)
    half = CONFIDENCE_QUANTILE * math.sqrt(share * (1 - share) / trials + z2 / (4 * trials**2))
    return (max(0.0, (centre - half) / (1 + z2 / trials)), min(1.0, (centre + half) / (1 + z2 / trials)))


def survival_by_direction(episodes: Sequence[PushedEpisode], sectors: int) -> dict[float, list[float | None]]:
    """Share of survivors by force and sector of direction.

    :param episodes: of one controller
    :param sectors: how many, the first of them centred on a push to the right, then counter-clockwise
    :return: by force in N; ``None`` where no push pointed
    """
    table: dict[float, list[float | None]] = {}
    for newtons in sorted({episode.newtons for episode in episodes}):
        counts = [[0, 0] for _ in range(sectors)]
        for episode in episodes:
            if episode.newtons == newtons:
                sector = round(episode.radians / (2 * math.pi) * sectors) % sectors
                counts[sector][0] += episode.result.survived
                counts[sector][1] += 1
        table[newtons] = [survived / total if total else None for survived, total in counts]
    return table


def finest_sectors(episodes: Sequence[PushedEpisode]) -> int:
    """The largest of :data:`SECTORS` of which none is without pushes; if there is none such, the smallest.

    :param episodes: of one controller
    """
    without_gaps = (n for n in SECTORS if all(None not in row for row in survival_by_direction(episodes, n).values()))
    return next(without_gaps, SECTORS[-1])
