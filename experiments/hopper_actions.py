"""NAF and DDPG on Hopper with other actions, and NAF with wider noise."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from experiments.maker import ParallelExperiment
from experiments.held_actions import TASK
from experiments.record import Row
from experiments.several_actions import SeveralActions
from sarah.errors import ConfigurationError, unknown_name


class Change(NamedTuple):
    """What is changed of actions.

    :param action_repeat: number of steps for which an action is held
    :param action_scale: factor of actions, which are cut at their bounds
    :param algorithms: names of the algorithms
    """

    action_repeat: int = 1
    action_scale: float = 1.0
    algorithms: tuple[str, ...] = ("naf", "ddpg")


CHANGES = {
    "as they are": Change(algorithms=("naf", "ddpg", "naf, noise of 0.9")),
    "held for four steps": Change(action_repeat=4),
    "three times as large": Change(action_scale=3.0, algorithms=("naf",)),
}


@dataclass(frozen=True)
class HopperActions(ParallelExperiment):
    """NAF and DDPG on Hopper, by what is changed of their actions.

    :param actions: names of changes
    :param steps: number of steps of a training, whether actions are held or not
    :param seeds: number of trainings of each algorithm
    :param evaluations: number of evaluations along a training, the last at its end
    :param episodes: number of episodes of an evaluation
    :param courses: folder that keeps the courses of the trainings; one that is there is not run again
    """

    actions: tuple[str, ...] = tuple(CHANGES)
    steps: int = SeveralActions.steps
    seeds: int = SeveralActions.seeds
    evaluations: int = SeveralActions.evaluations
    episodes: int = SeveralActions.episodes
    courses: Path = SeveralActions.courses

    def rows(self) -> Iterator[Row]:
        """A row for each change of actions, algorithm and evaluation."""
        for name in self.actions:
            if name not in CHANGES:
                raise ConfigurationError(unknown_name("actions", name, CHANGES))
            change = CHANGES[name]
            trainings = SeveralActions(
                workers=self.workers,
                tasks=(TASK,),
                algorithms=change.algorithms,
                steps=self.steps,
                seeds=self.seeds,
                evaluations=self.evaluations,
                episodes=self.episodes,
                action_repeat=change.action_repeat,
                action_scale=change.action_scale,
                courses=self.courses,
            )
            for row in trainings.rows():
                yield {"actions": name, **row}
