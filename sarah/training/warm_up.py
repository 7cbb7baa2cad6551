"""The warm-up of a training: its first episodes, whose parameters are drawn at random and not learned.

Learners, records and figures take the number from here. The module imports nothing slow.
"""

from __future__ import annotations

import math
from typing import Any

from sarah.episode.tasks import Task
from sarah.runs.agent_settings import WARM_UP
from sarah.runs.config import TrainingConfig

WITHOUT_WARM_UP = ("cma-es", "random")
"""Algorithms without a warm-up: CMA-ES draws from its own distribution at once, and random search never learns."""


def begins_at_centre(task: Task[Any]) -> bool:
    """Whether the first action of every algorithm is the centre of the box: few uniform draws come near V = 0.

    :param task: task whose parameters are learned; it is so if its neutral parameters are that centre
    """
    return task.neutral is not None and all(
        math.isclose(neutral, (parameter.low + parameter.high) / 2.0, abs_tol=1e-9 * (parameter.high - parameter.low))
        for neutral, parameter in zip(task.neutral, task.parameters, strict=True)
    )


def warm_up(config: TrainingConfig) -> int:
    """Number of episodes before an algorithm uses what it knows: at least twice as many as are in flight.

    :param config: settings of the training
    """
    if config.algo in WITHOUT_WARM_UP:
        return 0
    return max(getattr(config.agent, "learning_starts", WARM_UP), 2 * config.slots)


def warm_up_episodes(config: TrainingConfig) -> int:
    """Number of a training's episodes that its warm-up takes: no more than come before the trials.

    :param config: settings of the training
    """
    learned_from = sum(stage.stage_episodes - stage.trial_episodes for stage in config.by_stage())
    return min(warm_up(config), learned_from)


def describe_warm_up(config: TrainingConfig) -> str:
    """Words for a training's warm-up, such as "8 of the 100 episodes were random".

    :param config: settings of the training
    """
    count = warm_up_episodes(config)
    if count == 0:
        return "none: every episode was random" if config.algo == "random" else "none"
    if count >= config.episodes:
        return f"all {config.episodes} episodes: to learn takes more than {warm_up(config)}"
    if not begins_at_centre(config.task):
        return f"{count} of the {config.episodes} episodes were random"
    near_best = " or around the best so far" if getattr(config.agent, "elite_share", 0.0) > 0.0 else ""
    return f"{count} of the {config.episodes} episodes: the first neutral, the others random{near_best}"
