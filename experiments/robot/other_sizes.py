"""Do robots of other sizes learn by the same commands?"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from pandas import DataFrame

from experiments.experiment import product, survival
from experiments.record import Row
from experiments.tables import span, table
from experiments.trainings import TrainingExperiment
from sarah.episode.evaluation import Evaluation, evaluate
from sarah.episode.push import PushedConfig
from sarah.episode.tasks import BALANCE
from sarah.robot.dimensions import dimensions_alike
from sarah.robot.scale import MASS
from sarah.runs.run_folder import RunFolder
from sarah.simulation.engines import Engine
from sarah.simulation.physics import named_physics

GRAVITY = 9.81
FIRST_SEED = 11
"""Seed of the first training of each robot; no setting was chosen on these."""
UNSEEN_SEED, PUSHED_SEED = 10_000, 20_000
"""First seeds of the episodes that judge, without pushes and with them."""
ROBOTS = {"4 kg, legs of 0.2 m": (4.0, 0.2, 5.4), "60 kg, legs of 0.8 m": (60.0, 0.8, 2.7)}
"""Mass, in kg, length of thigh and shank, in m, and rewarded frequency of steps, near the natural one, in 1/s."""
LEGS = sum(dimensions_alike(1.0, 1.0)[name] for name in ("thigh_length", "shank_length"))
"""Length of the default robot's thigh and shank, in m."""


@dataclass(frozen=True)
class OtherSizes(TrainingExperiment):
    """First and Second Trainings by NAF, judged without pushes and with some by a third of the weight."""

    seeds: int = 2  # number of trainings of each robot in each engine
    budgets: tuple[int, int] = (100, 300)  # number of episodes of a First and of a Second Training
    episodes: int = 20  # number of episodes of each kind that judge

    def cases(self) -> list[Row]:
        """Each seed, engine and robot."""
        return product(seed=range(FIRST_SEED, FIRST_SEED + self.seeds), engine=("mujoco", "pybullet"), robot=ROBOTS)

    def rows(self, seed: int, engine: Engine, robot: str) -> Iterator[Row]:
        """How a robot does after both trainings."""
        (mass, leg_length, step_frequency), (first, second) = ROBOTS[robot], self.budgets
        dimensions = dimensions_alike(leg_length / LEGS, mass / MASS)
        usual = self.episode("stepping", engine).for_robot(dimensions)
        stepping = dataclasses.replace(usual, step_frequency=step_frequency)
        stepped = self.trained(self.training("stepping", stepping, first, seed=seed))
        trained_with = self.episode("balance", engine).for_robot(dimensions)
        assert isinstance(trained_with, PushedConfig)
        push = trained_with.push
        balance = BALANCE.config_of(
            stepping, stepping=stepped.parameters(), push=push, time_limit=trained_with.time_limit
        )
        pushed = self.trained(self.training("balance", balance, second, seed=seed))
        unpushed = self._judged(stepped, UNSEEN_SEED)
        reference = named_physics("reference", stepping.scale, stepping.physics.control_rate)
        newtons = mass * GRAVITY / 3.0
        third = dataclasses.replace(push, newtons=(newtons, newtons), sagittal_share=0.0)
        under_pushes = self._judged(pushed, PUSHED_SEED, push=third)
        yield {
            "score": unpushed.mean("score"),
            "reference_score": self._judged(stepped, UNSEEN_SEED, physics=reference).mean("score"),
            "steps_per_second": unpushed.mean("steps_per_second"),
            "push_n": newtons,
            **survival(under_pushes),
            "pushed_score": under_pushes.mean("score"),
        }

    def _judged(self, run: RunFolder, first_seed: int, **changes: Any) -> Evaluation:
        config = run.config()
        episode = dataclasses.replace(config.episode, **changes)
        return evaluate(config.task, run.parameters(), episode, range(first_seed, first_seed + self.episodes))


FULL = OtherSizes()
QUICK = OtherSizes(time_limit=2.0, seeds=1, budgets=(5, 5), episodes=1)


def answer(rows: DataFrame) -> str:
    """Whether both robots learn."""
    verdict = "Yes" if rows.survival.min() >= 0.9 else "In part"
    share = "all" if rows.survival.min() == 1.0 else f"{span(rows.survival, '.0%')} of"
    return (
        f"{verdict}. A robot of 4 kg with legs of 0.2 m and one of 60 kg with legs of 0.8 m learn to step, and to come "
        f"back after pushes, in both engines. Their scores are {span(rows.score, '.2f')}. After each Second Training "
        f"they survive {share} {FULL.episodes} pushes by a third of their weight."
    )


def stepping(rows: DataFrame) -> str:
    """What First Trainings end with."""
    columns = ["robot", "engine", "seed", "score", "reference_score", "steps_per_second"]
    return table(rows, columns, f"First Trainings by NAF, on {FULL.episodes} unseen seeds without a push.")


def pushes(rows: DataFrame) -> str:
    """What Second Trainings end with."""
    columns = ["robot", "engine", "seed", "push_n", "survival", "survival_low", "survival_high", "pushed_score"]
    caption = f"Second Trainings, on {FULL.episodes} unseen pushes: survival with its 95 % interval, and score."
    return table(rows, columns, caption)
