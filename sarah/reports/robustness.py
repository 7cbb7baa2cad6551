"""The force of a push that the robot survives: survival by force and direction, for several controllers.

All controllers meet the same pushes on the same seeds, in random directions at random times. A push is lateral if it
points within 45 degrees of the robot's right or left, and sagittal otherwise.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

from sarah.episode.evaluation import Evaluation
from sarah.episode.push import Push, draw_push
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.episode.workers import Workers
from sarah.robot.scale import Scale

FORCES = (25.0, 50.0, 75.0, 100.0, 125.0, 150.0)
"""Forces of the pushes for the default robot, in N."""
PUSHED_BETWEEN = (2.0, 3.0)
"""Range of the simulated times at which the pushes begin, in s: 1 to 2 s after the pattern generator's start."""
SECONDS_AFTER = 6.85
"""Time after the latest push that the robot must stay up, in s: episodes take 10 s with the default push of 0.15 s."""
DIRECTIONS = ("all", "lateral", "sagittal")
CONFIDENCE = 0.95


@dataclass(frozen=True)
class PushedEpisode:
    """One episode and its push.

    :param newtons: force of the push, in N
    :param radians: direction of the push, in rad: 0 to the right, pi/2 forward
    :param result: result of the episode
    """

    newtons: float
    radians: float
    result: EpisodeResult

    @property
    def direction(self) -> str:
        """Group of the push's direction: ``"lateral"`` or ``"sagittal"``."""
        return "lateral" if abs(math.cos(self.radians)) > abs(math.sin(self.radians)) else "sagittal"


def forces_for(scale: Scale) -> tuple[float, ...]:
    """Forces of the pushes for a robot, in N.

    :param scale: size of the robot
    """
    return tuple(rounded(newtons * scale.factor("N")) for newtons in FORCES)


def rounded(value: float) -> float:
    """A number of three digits.

    :param value: number to round
    """
    return float(f"{value:.3g}")


def push_many(
    controllers: Sequence[tuple[float, ...]],
    config: BalanceConfig,
    workers: Workers,
    forces: Sequence[float] = FORCES,
    episodes: int = 100,
    first_seed: int = 0,
) -> list[list[PushedEpisode]]:
    """Simulate the same pushes of several controllers.

    :param controllers: values of V1 to V4 of each controller
    :param config: settings of the episodes; time limit, force, time and sagittal share of the push are replaced
    :param workers: workers that simulate the episodes
    :param forces: forces of the pushes, in N
    :param episodes: number of episodes for each force
    :param first_seed: first seed; each force has the same seeds, and so the same directions and times
    :return: the episodes of each controller
    """
    settings = {newtons: pushed_settings(config, newtons) for newtons in forces}
    pushes = [(newtons, first_seed + index) for newtons in forces for index in range(episodes)]
    results = workers.simulate_all(
        [EpisodeSpec(v, seed, BALANCE, settings[newtons]) for v in controllers for newtons, seed in pushes]
    )
    pushed = []
    for (newtons, seed), result in zip(pushes * len(controllers), results, strict=True):
        x, y, _ = draw_push(settings[newtons].push, seed).force
        pushed.append(PushedEpisode(newtons, math.atan2(y, x), result))
    return [pushed[index * len(pushes) : (index + 1) * len(pushes)] for index in range(len(controllers))]


def pushed_settings(config: BalanceConfig, newtons: float) -> BalanceConfig:
    """Settings of the episodes with pushes of one force.

    :param config: settings of which the time limit, and force, time and sagittal share of the push are replaced
    :param newtons: force of the pushes, in N
    """
    push = push_of_table(config.push, newtons)
    limit = PUSHED_BETWEEN[1] + push.duration + SECONDS_AFTER
    return dataclasses.replace(config, push=push, time_limit=limit)


def push_of_table(push: Push, newtons: float) -> Push:
    """Pushes of one force, at the time of all tables.

    :param push: pushes whose directions and duration stay
    :param newtons: force, in N
    """
    return dataclasses.replace(push, newtons=(newtons, newtons), at_seconds=PUSHED_BETWEEN, sagittal_share=0.0)


def robustness_table(episodes: Sequence[PushedEpisode]) -> dict[tuple[float, str], Evaluation]:
    """Evaluations of pushed episodes by force in N and group of directions, one of :data:`DIRECTIONS`.

    :param episodes: episodes of one controller
    """
    table = {}
    for newtons, direction in product(sorted({episode.newtons for episode in episodes}), DIRECTIONS):
        group = [e.result for e in episodes if e.newtons == newtons and direction in ("all", e.direction)]
        if group:
            table[newtons, direction] = Evaluation(tuple(group))
    return table


def wilson_interval(successes: int, trials: int) -> tuple[float, float]:
    """Wilson's 95 % interval of a probability (Wilson 1927), which stays within 0 and 1 and is never empty.

    :param successes: number of successes
    :param trials: number of trials
    """
    from scipy.stats import binomtest  # takes a second to import

    interval = binomtest(successes, trials).proportion_ci(CONFIDENCE, "wilson")
    return interval.low, interval.high
