"""NAF and DDPG on Hopper with actions of one step, and held for several: whether it is their length that keeps NAF."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from experiments.experiment import OnWorkers
from experiments.record import Row
from experiments.several_actions import SeveralActions


@dataclass(frozen=True)
class LongerActions(OnWorkers):
    """NAF and DDPG on a task, by the number of steps for which each action is held.

    :param task: name of the task
    :param action_repeats: numbers of steps for which an action is held
    :param steps: number of steps of a training, whether actions are held or not
    :param seeds: number of trainings of each algorithm
    :param evaluations: number of evaluations along a training, the last at its end
    :param episodes: number of episodes of an evaluation
    :param courses: folder that keeps the courses of the trainings; one that is there is not run again
    """

    task: str = "Hopper-v5"
    action_repeats: tuple[int, ...] = (1, 4)
    steps: int = SeveralActions.steps
    seeds: int = SeveralActions.seeds
    evaluations: int = SeveralActions.evaluations
    episodes: int = SeveralActions.episodes
    courses: Path = SeveralActions.courses

    def rows(self) -> Iterator[Row]:
        """A row for each length of actions, algorithm and evaluation."""
        for action_repeat in self.action_repeats:
            trainings = SeveralActions(
                workers=self.workers,
                tasks=(self.task,),
                algorithms=("naf", "ddpg"),
                steps=self.steps,
                seeds=self.seeds,
                evaluations=self.evaluations,
                episodes=self.episodes,
                action_repeat=action_repeat,
                courses=self.courses,
            )
            for row in trainings.rows():
                yield {"action_repeat": action_repeat, **row}
