"""The Second Trainings that several results are about, NAF with many seeds in each engine, and the pushes of the judge.

The judge pushes by 125 N from everywhere, and by 115 N from within 30 degrees of front or back, twice as often the
former. All sets of V1 to V4 meet the same pushes. Pushes of other seeds, of the same kind, choose among sets: those
that judge have chosen nothing.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

from experiments import record
from experiments.maker import RowByRowExperiment
from experiments.judge import Asked, Condition, Judge
from experiments.record import Row, cell
from experiments.maker import TrainingExperiment
from experiments.trainings import kept
from sarah.control.parameters import BALANCE_PARAMETERS, Parameters
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.push import Push
from sarah.episode.tasks import BalanceConfig
from sarah.episode.workers import Executor
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.engines import Engine

BALANCE_NAMES = [parameter.name for parameter in BALANCE_PARAMETERS]
SHIPPED: Parameters = PARAMETER_SETS["balance"].spec.parameters
"""V1 to V4 that the package ships."""
PUSHED_AT = (2.0, 3.0)
"""Range of the time at which pushes begin, in s."""
JUDGING_SEED, CHOOSING_SEED, OTHER_SEED, TESTING_SEED = 20_000, 30_000, 40_000, 50_000
"""First seeds of pushes that judge, of those that choose, of all other conditions, and of pushes that test a choice."""
SEEDS_OF_A_KIND = 1000
"""Number of seeds that are left for each kind of push."""


class Training(NamedTuple):
    """What a training learned.

    :param name: name of the training
    :param recommended: values of V1 to V4 that the training recommends
    :param mu: values of V1 to V4 that the network itself says, without exploration
    """

    name: str
    recommended: Parameters
    mu: Parameters


@dataclass(frozen=True)
class SecondTrainingExperiment(TrainingExperiment):
    """Options of an experiment that takes what Second Trainings by NAF have learned.

    :param engines: physics engines, in the order in which they are asked
    :param first_seed: seed of the first training; no setting was chosen on these
    :param seeds: number of trainings in each engine
    :param budget: number of episodes of a training
    """

    engines: tuple[Engine, ...] = ("mujoco", "pybullet")
    first_seed: int = 300
    seeds: int = 20
    budget: int = 300

    @property
    def judge(self) -> Judge:
        """Who keeps the outcomes of all sets."""
        return Judge(self.runs / "judged")

    def balance(self, engine: Engine, **changes: Any) -> BalanceConfig:
        """Settings of the trainings' episodes, with changes.

        :param engine: physics engine
        :param changes: other values, by name
        """
        config = self.episode("balance", engine)
        assert isinstance(config, BalanceConfig)
        return dataclasses.replace(config, **changes)

    def pushes(self, engine: Engine, first_seed: int, episodes: int) -> Asked:
        """Hard pushes: two thirds by 125 N from everywhere, the others sagittal, by 115 N.

        :param engine: physics engine
        :param first_seed: seed of the first push
        :param episodes: number of pushes
        """
        kinds = (("125 N", 125.0, 0.0, 2 * episodes // 3), ("sagittal 115 N", 115.0, 1.0, episodes - 2 * episodes // 3))
        return [
            (self.pushed(name, engine, newtons, first_seed + index * SEEDS_OF_A_KIND, sagittal_share=share), count)
            for index, (name, newtons, share, count) in enumerate(kinds)
        ]

    def pushed(
        self, name: str, engine: Engine, newtons: float, first_seed: int, sagittal_share: float = 0.0, **changes: Any
    ) -> Condition:
        """A condition with pushes.

        :param name: name of the condition
        :param engine: physics engine
        :param newtons: force of the pushes, in N
        :param first_seed: seed of the first push
        :param sagittal_share: share of the pushes that come from front or back
        :param changes: other settings of the episodes, by name
        """
        push = Push((newtons, newtons), at_seconds=PUSHED_AT, sagittal_share=sagittal_share)
        return Condition(name, self.balance(engine, push=push, **changes), first_seed)

    def trainings(self, engine: Engine, workers: Executor) -> Iterator[Training]:
        """All trainings of an engine, run or resumed unless they are there: one for each worker at a time.

        :param engine: physics engine
        :param workers: who trains
        """
        seeds = range(self.first_seed, self.first_seed + self.seeds)
        jobs = [workers.submit(self.training, engine, seed) for seed in seeds]
        return (job.result() for job in jobs)

    def training(self, engine: Engine, seed: int) -> Training:
        """What a training learned: as the result ``balance_trainings`` says, or else by running it.

        :param engine: physics engine
        :param seed: seed of the training
        """
        key = self.key(engine, seed)
        row = next((row for row in known_trainings() if all(row[name] == cell(key[name]) for name in key)), None)
        if row is None:
            row = {name: cell(value) for name, value in self.learned(engine, seed).items()}
        recommended = tuple(float(row[name]) for name in BALANCE_NAMES)
        return Training(f"naf seed {seed}", recommended, tuple(float(row[f"mu_{name}"]) for name in BALANCE_NAMES))

    def key(self, engine: Engine, seed: int) -> Row:
        """Columns that tell a training from all others.

        :param engine: physics engine
        :param seed: seed of the training
        """
        limit = self.balance(engine).time_limit
        return {"engine": engine, "seed": seed, "episodes": self.budget, "time_limit_s": limit}

    def learned(self, engine: Engine, seed: int) -> Row:
        """Columns of what a training learns, which is run or resumed in this process unless it is there.

        :param engine: physics engine
        :param seed: seed of the training
        """
        config = TrainingConfig("balance", episodes=self.budget, seed=seed, slots=1, episode=self.balance(engine))
        run = self.trained(config)
        mu = kept(run.path / "mu.json", network_says, run)
        return {
            **dict(zip(BALANCE_NAMES, run.parameters(), strict=True)),
            **{f"mu_{name}": value for name, value in zip(BALANCE_NAMES, mu, strict=True)},
        }


@dataclass(frozen=True)
class BalanceTrainings(SecondTrainingExperiment, RowByRowExperiment):
    """What each Second Training learns. Other experiments take it from this result and do not train again."""

    def keys(self) -> list[Row]:
        """Engine and seed of each training, and its size."""
        seeds = range(self.first_seed, self.first_seed + self.seeds)
        return [self.key(engine, seed) for engine in self.engines for seed in seeds]

    def row(self, engine: Engine, seed: int, *size: float) -> Row:
        """What a training learns.

        :param engine: physics engine
        :param seed: seed of the training
        :param size: its size, which all trainings share
        """
        return self.learned(engine, seed)


def known_trainings() -> list[dict[str, str]]:
    """Rows of the result ``balance_trainings``, as far as they are of today's project."""
    if (name := "balance_trainings") not in record.names():
        return []
    return [*record.read(name).rows]


def network_says(run: RunFolder) -> Parameters:
    """V1 to V4 that the network of a finished training says for the robot as designed, without exploration.

    :param run: run folder of the training
    """
    from sarah.training.learners import AGENTS, chosen_parameters, nominal_observation

    config = run.config()
    algorithm, _ = AGENTS[type(config.agent)]  # type: ignore[index]  # NAF's settings are a learner's
    return chosen_parameters(algorithm.load(run.model_path), nominal_observation(config), config.task)
