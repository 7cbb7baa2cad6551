"""Both trainings, as the commands do them, for robots like the default one that are much smaller or larger."""

from __future__ import annotations

import dataclasses
import itertools
from dataclasses import dataclass
from typing import Any

from experiments.maker import RowByRowExperiment, survival
from experiments.record import Row
from experiments.maker import TrainingExperiment
from sarah.episode.evaluation import Evaluation, evaluate
from sarah.episode.push import Push
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.robot.dimensions import dimensions_alike
from sarah.robot.scale import MASS
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.engines import Engine
from sarah.simulation.physics import named_physics

GRAVITY = 9.81
UNSEEN_SEED, PUSHED_SEED = 10_000, 20_000
"""First seeds of the episodes that judge, without pushes and with them."""


@dataclass(frozen=True)
class Robot:
    """A robot that is like the default one.

    :param mass: mass of the robot, in kg
    :param leg_length: length of thigh and shank, in m
    :param step_frequency: rewarded frequency of its steps, in 1/s
    """

    mass: float
    leg_length: float
    step_frequency: float

    @property
    def name(self) -> str:
        """Mass and length of the legs, for people."""
        return f"{self.mass:g} kg, legs of {self.leg_length:g} m"

    @property
    def dimensions(self) -> dict[str, float]:
        """All its dimensions but those that follow from its size."""
        legs = sum(dimensions_alike(1.0, 1.0)[name] for name in ("thigh_length", "shank_length"))
        return dimensions_alike(self.leg_length / legs, self.mass / MASS)


@dataclass(frozen=True)
class OtherSizes(TrainingExperiment, RowByRowExperiment):
    """First and Second Trainings by NAF, judged without pushes and with some by a third of the weight.

    :param robots: the robots, each with a step frequency near its natural one
    :param engines: physics engines
    :param first_seed: seed of the first training; no setting was chosen on these
    :param seeds: number of trainings of each robot in each engine
    :param budgets: number of episodes of a First and of a Second Training
    :param episodes: number of episodes of each kind that judge
    """

    robots: tuple[Robot, ...] = (Robot(4.0, 0.2, 5.4), Robot(60.0, 0.8, 2.7))
    engines: tuple[Engine, ...] = ("mujoco", "pybullet")
    first_seed: int = 11
    seeds: int = 2
    budgets: tuple[int, int] = (100, 300)
    episodes: int = 20

    def keys(self) -> list[Row]:
        """Seed, engine and robot of each row."""
        seeds = range(self.first_seed, self.first_seed + self.seeds)
        names = [robot.name for robot in self.robots]
        asked = itertools.product(seeds, self.engines, names)
        return [{"seed": seed, "engine": engine, "robot": name} for seed, engine, name in asked]

    def row(self, seed: int, engine: Engine, name: str) -> Row:
        """How a robot does after both trainings.

        :param seed: seed of both trainings
        :param engine: physics engine
        :param name: name of the robot
        """
        robot = next(robot for robot in self.robots if robot.name == name)
        stepping = self.episode("stepping", engine).for_robot(robot.dimensions)
        stepping = dataclasses.replace(stepping, step_frequency=robot.step_frequency)
        first, second = self.budgets
        stepped = self.trained(TrainingConfig("stepping", episodes=first, seed=seed, episode=stepping))
        usual = self.episode("balance", engine).for_robot(robot.dimensions)
        assert isinstance(usual, BalanceConfig)
        balance = BALANCE.config_of(
            stepping, stepping=stepped.parameters(), push=usual.push, time_limit=usual.time_limit
        )
        pushed = self.trained(TrainingConfig("balance", episodes=second, seed=seed, episode=balance))
        return self._judged(robot, stepped, pushed)

    def _judged(self, robot: Robot, stepped: RunFolder, pushed: RunFolder) -> Row:
        unpushed = self._evaluated(stepped, UNSEEN_SEED)
        config = stepped.config().episode
        reference = named_physics("reference", config.scale, config.physics.control_rate)
        at_reference = self._evaluated(stepped, UNSEEN_SEED, physics=reference)
        push = pushed.config().episode.push
        assert isinstance(push, Push)
        newtons = robot.mass * GRAVITY / 3.0
        third = dataclasses.replace(push, newtons=(newtons, newtons), sagittal_share=0.0)
        under_pushes = self._evaluated(pushed, PUSHED_SEED, push=third)
        return {
            "score": unpushed.mean("score"),
            "reference_score": at_reference.mean("score"),
            "steps_per_second": unpushed.mean("steps_per_second"),
            "push_newtons": newtons,
            "push_seconds": push.duration,
            **survival(under_pushes),
            "pushed_score": under_pushes.mean("score"),
        }

    def _evaluated(self, run: RunFolder, first_seed: int, **changes: Any) -> Evaluation:
        config = run.config()
        episode = dataclasses.replace(config.episode, **changes)
        return evaluate(config.task, run.parameters(), episode, range(first_seed, first_seed + self.episodes))
