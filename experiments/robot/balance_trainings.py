"""Which V1 to V4 does each Second Training recommend, and which does its network say?

Second Trainings by NAF with many seeds in each engine. Other experiments take what they learned from this result. They
judge sets of V1 to V4 by hard pushes, the same for all sets. Pushes of other seeds, of the same kind, choose among
sets: those that judge have chosen nothing.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from pandas import DataFrame

from experiments import record
from experiments.experiment import product
from experiments.judge import Condition, Judge
from experiments.record import Row, cell
from experiments.tables import table
from experiments.trainings import TrainingExperiment
from sarah.control.parameters import BALANCE_PARAMETERS, Parameters
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.push import NO_PUSH, Push
from sarah.episode.tasks import BALANCE
from sarah.files import replace_text
from sarah.reports.robustness import PUSHED_BETWEEN
from sarah.runs.run_folder import RunFolder
from sarah.simulation.engines import Engine

NAMES = [parameter.name for parameter in BALANCE_PARAMETERS]
MU_NAMES = [f"mu_{name}" for name in NAMES]
SHIPPED: Parameters = PARAMETER_SETS["balance"].spec.parameters
"""V1 to V4 that the package ships."""
PUSH_100, PUSH_125, SAGITTAL_115 = (
    Push((newtons, newtons), at_seconds=PUSHED_BETWEEN, sagittal_share=share)
    for newtons, share in ((100.0, 0.0), (125.0, 0.0), (115.0, 1.0))
)
JUDGING_SEED, CHOOSING_SEED, OTHER_SEED, TESTING_SEED = 20_000, 30_000, 40_000, 50_000
"""First seeds of pushes that judge, that choose, of other conditions, and that test a choice; 1000 for each kind."""


@dataclass(frozen=True)
class SecondTrainingExperiment(TrainingExperiment):
    """Options of an experiment that takes what Second Trainings by NAF have learned."""

    engines: tuple[Engine, ...] = ("mujoco", "pybullet")
    first_seed: int = 460  # seed of the first training; no setting was chosen on these
    seeds: int = 20  # number of trainings in each engine
    budget: int = 300  # number of episodes of a training

    @property
    def training_seeds(self) -> range:
        """Seeds of the trainings."""
        return range(self.first_seed, self.first_seed + self.seeds)

    @property
    def judge(self) -> Judge:
        """Who keeps the outcomes of all sets."""
        return Judge(self.runs / "judged")

    def condition(
        self, name: str, engine: Engine, first_seed: int, episodes: int, push: Push = NO_PUSH, **changes: Any
    ) -> Condition:
        """Episodes like those of the trainings, with a push and other changes of the settings."""
        config = BALANCE.config_of(self.episode("balance", engine), push=push, **changes)
        return Condition(name, config, first_seed, episodes)

    def pushes(self, engine: Engine, first_seed: int, episodes: int) -> list[Condition]:
        """Hard pushes: two thirds by 125 N from everywhere, the others by 115 N, within 30 degrees of front or back."""
        anywhere = 2 * episodes // 3
        return [
            self.condition("125 N", engine, first_seed, anywhere, PUSH_125),
            self.condition("sagittal 115 N", engine, first_seed + 1000, episodes - anywhere, SAGITTAL_115),
        ]

    def trainings(self, engine: Engine) -> dict[str, tuple[Parameters, Parameters]]:
        """V1 to V4 that each training of an engine recommends, and those that its network says, by its name.

        Trainings that the result ``balance_trainings`` lacks are run in this process.
        """
        known = {int(row["seed"]): row for row in self.rows_of("balance_trainings", engine)}
        found = {}
        for seed in self.training_seeds:
            row = known.get(seed) or self.learned(engine, seed)
            recommended, mu = (tuple(float(row[name]) for name in names) for names in (NAMES, MU_NAMES))
            found[f"naf seed {seed}"] = recommended, mu
        return found

    def rows_of(self, name: str, engine: Engine) -> list[Mapping[str, str]]:
        """Rows that another result has of an engine; none if this experiment has other sizes than the results.

        :param name: name of the result
        """
        in_full = (self.budget, self.time_limit) == (SecondTrainingExperiment.budget, None)
        rows = record.read(name).rows if in_full and name in record.names() else ()
        return [row for row in rows if row["engine"] == engine]

    def learned(self, engine: Engine, seed: int) -> dict[str, str]:
        """Columns of what a training learns, which is run or resumed in this process unless it is there."""
        episode = self.episode("balance", engine)
        run = self.trained(self.training("balance", episode, self.budget, seed=seed, slots=1))
        values = [*run.parameters(), *_network_says(run)]
        return {name: cell(float(value)) for name, value in zip([*NAMES, *MU_NAMES], values, strict=True)}


def _network_says(run: RunFolder) -> Parameters:
    """V1 to V4 that the network of a finished training says for the robot as designed, without exploration."""
    file = run.path / "mu.json"
    if not file.exists():
        from sarah.training.learners import AGENTS, chosen_parameters, nominal_observation

        config = run.config()
        algorithm, _ = AGENTS[type(config.agent)]  # type: ignore[index]  # NAF's settings are a learner's
        mu = chosen_parameters(algorithm.load(run.model_path), nominal_observation(config), config.task)
        replace_text(file, json.dumps(mu))
    return tuple(json.loads(file.read_text(encoding="utf-8")))


@dataclass(frozen=True)
class BalanceTrainings(SecondTrainingExperiment):
    """What each Second Training learns."""

    def cases(self) -> list[Row]:
        """Engine and seed of each training."""
        return product(engine=self.engines, seed=self.training_seeds)

    def rows(self, engine: Engine, seed: int) -> Iterator[Row]:
        """What a training learns."""
        yield self.learned(engine, seed)


FULL = BalanceTrainings()
QUICK = BalanceTrainings(time_limit=2.0, budget=5, engines=("mujoco",), seeds=1)


def settled(rows: DataFrame) -> str:
    """Where V1 to V4 settle."""
    of_engines, names = rows.groupby("engine", sort=False), {"min": "lowest", "max": "highest"}
    found = of_engines[NAMES].agg(["min", "median", "max"]).stack(0, future_stack=True)
    assert isinstance(found, DataFrame)
    found = found.rename(columns=names)
    found["median_of_mu"] = of_engines[MU_NAMES].median().to_numpy().ravel()
    found = found.rename_axis(["engine", "parameter"]).reset_index()
    caption = f"What {FULL.seeds} trainings in each engine recommend, and what their networks say (mu)."
    return table(found, list(found.columns), caption, **dict.fromkeys(found.columns[2:], ".2f"))
