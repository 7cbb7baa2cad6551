"""How many unseen episodes judge a recommendation.

All trainings of a race meet the same episodes, whose seeds begin at 0, so that the luck of an episode is shared. The
first few of the episodes that judge final recommendations also judge those along the way.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sarah.episode.tasks import Task
from sarah.errors import check_whole

MOST_EVALUATIONS = 1000


@dataclass(frozen=True)
class Evaluations:
    """Numbers of unseen episodes that judge a recommendation.

    :param final: number for a final recommendation
    :param along: number for one along the way, which meets the first of the same episodes
    """

    final: int
    along: int

    def __post_init__(self) -> None:
        """Refuse numbers that are out of range."""
        check_whole("evaluations", self.final, 1, MOST_EVALUATIONS)
        check_whole("evaluations-along", self.along, 1, self.final)


PUSHED = Evaluations(200, 25)
"""Numbers for tasks with a push, which decides most of an episode's score."""
UNPUSHED = Evaluations(20, 5)
"""Numbers for other tasks: the robots and sensors that seeds draw hardly change the score of good parameters."""


def evaluations_of(task: Task[Any], final: int | None = None, along: int | None = None) -> Evaluations:
    """Numbers of judging episodes for a task.

    :param task: task whose recommendations are judged
    :param final: number for a final recommendation; by default that of tasks with or without a push
    :param along: number for one along the way; by default that of such tasks, and at most ``final``
    :raises ConfigurationError: if a number is out of range
    """
    usual = PUSHED if task.has_push else UNPUSHED
    final = usual.final if final is None else final
    return Evaluations(final, min(usual.along, final) if along is None else along)
