"""The plan of a training: what follows from its settings before its first episode.

Learners, records, figures and summaries take it from here. The module imports nothing slow.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sarah.runs.agent_settings import WARM_UP
from sarah.runs.config import TrainingConfig
from sarah.training.search import Start

EPISODES_PER_TRIAL = 5
"""Number of episodes in which a training tries what it would recommend."""
BUDGET_PER_TRIAL = 25
"""Number of episodes of a stage for each trial."""
MOST_TRIALS = 2
"""Largest number of sets that are tried. Of the valid ones the best expected is recommended."""
WITHOUT_WARM_UP = ("cma-es", "random")
"""Algorithms without a warm-up: CMA-ES draws from its own distribution at once, and random search never learns."""
CENTRED = 2e-9
"""Largest distance from the centre of the box, in actions scaled to [-1, 1], of what counts as the centre."""


class Seeds(NamedTuple):
    """Seeds of a training's random streams, each below 2^31. Each stream has one, so that none repeats another's draws.

    :param algorithm: seed of an agent's weights and warm-up, or of all that an optimiser draws
    :param exploration: seed of an agent's exploration after the warm-up, and of its minibatches
    :param episodes: seed of the seeds of the episodes that are learned from
    :param trials: seed of the seeds of the episodes that try the recommendation at the end
    """

    algorithm: int
    exploration: int
    episodes: int
    trials: int


def seeds_of(seed: int) -> Seeds:
    """Seeds of a training's random streams. Trainings of neighbouring seeds have none in common.

    :param seed: seed of the training
    """
    source = np.random.SeedSequence(seed)
    return Seeds(*(int(stream.generate_state(1)[0]) // 2 for stream in (source, *source.spawn(3))))


@dataclass(frozen=True)
class Stage:
    """A part of a training, which learns and then tries what it recommends: all of it, or up to an extension.

    :param begin: number of episodes before it
    :param end: number of episodes at its end, the budget then
    """

    begin: int
    end: int

    @property
    def episodes(self) -> int:
        """Number of its episodes."""
        return self.end - self.begin

    @property
    def trials(self) -> int:
        """Number of times that it tries what is recommended, at its end."""
        return min(MOST_TRIALS, self.episodes // BUDGET_PER_TRIAL)

    @property
    def trial_episodes(self) -> int:
        """Number of episodes of the trials."""
        return self.trials * EPISODES_PER_TRIAL

    @property
    def learning(self) -> int:
        """Number of episodes that it learns from: those before the trials."""
        return self.episodes - self.trial_episodes


@dataclass(frozen=True)
class Plan:
    """The plan of a training.

    :param config: settings that it follows from
    :param seeds: seeds of its random streams
    :param stages: parts of the training, of which each but the first is an extension
    :param start: how the algorithm begins: with the neutral parameters if they are the centre of the box, because few
        random draws come near V = 0, and with a warm-up of random parameters; without neutral ones it is a Latin
        hypercube
    """

    config: TrainingConfig
    seeds: Seeds
    stages: tuple[Stage, ...]
    start: Start

    @property
    def warm_up_episodes(self) -> int:
        """Number of episodes that the warm-up takes: no more than are learned from."""
        return min(self.start.warm_up, sum(stage.learning for stage in self.stages))

    def warm_up_words(self) -> str:
        """Words for the warm-up, such as "8 of the 100 episodes were random"."""
        count, config = self.warm_up_episodes, self.config
        if count == 0:
            return "none: every episode was random" if config.algo == "random" else "none"
        if count >= config.episodes:
            return f"all {config.episodes} episodes: to learn takes more than {self.start.warm_up}"
        if self.start.first is None:
            return f"{count} of the {config.episodes} episodes were random"
        near_best = " or around the best so far" if getattr(config.agent, "elite_share", 0.0) > 0.0 else ""
        return f"{count} of the {config.episodes} episodes: the first neutral, the others random{near_best}"


def plan_of(config: TrainingConfig) -> Plan:
    """Plan a training.

    :param config: settings of the training
    """
    task, ends = config.task, config.stages
    is_centre = task.neutral is not None and all(abs(place) <= CENTRED for place in task.box.scaled(task.neutral))
    # Twice as many as are in flight, at least: half of the warm-up has outcomes when it ends.
    usual = max(getattr(config.agent, "learning_starts", WARM_UP), 2 * config.slots)
    warm_up = 0 if config.algo in WITHOUT_WARM_UP else usual
    stages = tuple(Stage(begin, end) for begin, end in zip((0, *ends), ends, strict=False))
    start = Start(task.neutral if is_centre else None, warm_up, config.slots)
    return Plan(config, seeds_of(config.seed), stages, start)
