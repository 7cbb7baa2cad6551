"""The parameters that the package ships: both trainings, rounded to two digits, and pushed in both engines.

``make results NAME=shipped_parameters`` writes the package's own file too, sarah/episode/parameter_sets.json, from the
rows. So do trainings of other seeds, with ``--seed 3 --out results``.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from experiments import record
from experiments.engines import ENGINES
from experiments.record import Row
from experiments.trainings import EPISODES, OfTrainings
from sarah.control.parameters import BALANCE_PARAMETERS, STEPPING_PARAMETERS
from sarah.episode.evaluation import evaluate
from sarah.episode.push import Push, PushedConfig
from sarah.episode.shipped import FILE
from sarah.episode.spec import FIRST_EVALUATION_SEED
from sarah.episode.tasks import BalanceConfig
from sarah.episode.workers import Workers
from sarah.reports.robustness import PUSHED_BETWEEN, SECONDS_AFTER
from sarah.runs.config import TrainingConfig

DIGITS = 2
"""Decimals of the shipped values."""
CONDITIONS = {
    "no push": (0.0, 0.0),
    "100 N": (100.0, 0.0),
    "sagittal 115 N": (115.0, 1.0),
    "125 N": (125.0, 0.0),
}
"""Force in N, and share of sagittal pushes, by the condition that parameters are evaluated in."""
FIGURES = ("survival", "score", "steps_per_second")
"""Columns that the package's file keeps, beside the number of episodes."""
VERSIONS = ("python", "sarah", "sarah-sources", "pybullet", "mujoco", "torch", "stable-baselines3")
"""Versions that the package's file keeps."""
STEPPING_NAMES, BALANCE_NAMES = (
    [parameter.name for parameter in parameters] for parameters in (STEPPING_PARAMETERS, BALANCE_PARAMETERS)
)


@dataclass(frozen=True)
class ShippedParameters(OfTrainings):
    """A First Training by NAF, a Second on what it learned, and how well both do.

    :param seed: seed of the First Training
    :param balance_seed: seed of the Second Training
    :param budget: number of episodes of the First Training
    :param balance_budget: number of episodes of the Second Training
    :param episodes: number of unseen seeds of each set, engine and condition
    """

    seed: int = 9
    balance_seed: int = 2
    budget: int = 100
    balance_budget: int = 300
    episodes: int = 100

    def rows(self) -> Iterator[Row]:
        """A row for each set, engine and condition."""
        with Workers(self.workers) as workers:
            free = self.episode("stepping")
            training = TrainingConfig("stepping", episodes=self.budget, seed=self.seed, episode=free)
            stepping = rounded(self.trained(training, workers).parameters())
            yield from self.evaluated("stepping", stepping, (), workers)
            pushed = dataclasses.replace(self.episode("balance"), stepping=stepping)
            training = TrainingConfig("balance", episodes=self.balance_budget, seed=self.balance_seed, episode=pushed)
            balance = rounded(self.trained(training, workers).parameters())
            yield from self.evaluated("balance", stepping, balance, workers)

    def evaluated(
        self, task: str, stepping: tuple[float, ...], balance: tuple[float, ...], workers: Workers
    ) -> Iterator[Row]:
        """A row for each engine and condition.

        :param task: name of the task, which is that of the set too
        :param stepping: values of P1 to P5
        :param balance: values of V1 to V4; none for the task ``stepping``
        :param workers: who simulates
        """
        names = [*STEPPING_NAMES, *BALANCE_NAMES]
        values = dict(zip(names, (*stepping, *balance, *[None] * len(BALANCE_NAMES)), strict=False))
        seeds = range(FIRST_EVALUATION_SEED, FIRST_EVALUATION_SEED + self.episodes)
        for engine in ENGINES:
            for condition, (newtons, sagittal_share) in CONDITIONS.items():
                push = Push((newtons, newtons), at_seconds=PUSHED_BETWEEN, sagittal_share=sagittal_share)
                limit = self.time_limit or PUSHED_BETWEEN[1] + push.duration + SECONDS_AFTER
                shared: dict[str, Any] = {"engine": engine, "time_limit": limit, "push": push}
                config = BalanceConfig(stepping=stepping, **shared) if balance else PushedConfig(**shared)
                found = evaluate(task, balance or stepping, config, seeds, workers)
                yield {
                    "set": task,
                    **values,
                    "engine": engine,
                    "condition": condition,
                    "episodes": found.episodes,
                    "survival": found.survival_rate,
                    "score": found.mean("score"),
                    "steps_per_second": found.mean("steps_per_second"),
                }


def rounded(parameters: tuple[float, ...]) -> tuple[float, ...]:
    """Values as they are shipped.

    :param parameters: values that a training learned
    """
    return tuple(round(value, DIGITS) for value in parameters)


def ship(result: record.Result, path: Path = FILE) -> None:
    """Write the package's file of learned parameters.

    :param result: the result ``shipped_parameters``
    :param path: the file
    """
    record.write_json(path, sets_of(result))


def sets_of(result: record.Result) -> dict[str, Any]:
    """Content of the package's file.

    :param result: the result ``shipped_parameters``
    """
    versions = {name: result.versions[name] for name in VERSIONS}
    origin = {"command": result.command, "commit": result.commit, "date": result.date, "versions": versions}
    sets: dict[str, Any] = {}
    for row in result.rows:
        name = row["set"]
        chosen = sets.setdefault(name, {"task": name, **_chosen(row), "origin": origin, "figures": {}})
        of_engine = chosen["figures"].setdefault(row["engine"], {})
        figures = {column: float(row[column]) for column in FIGURES}
        of_engine[row["condition"]] = {"episodes": int(row["episodes"]), **figures}
    return sets


def _chosen(row: Mapping[str, str]) -> dict[str, Any]:
    """Parameters and settings of a row's set."""
    stepping = {name: float(row[name]) for name in STEPPING_NAMES}
    if row["set"] == "stepping":
        return {"parameters": stepping, "settings": {}}
    config = EPISODES["balance"]
    assert isinstance(config, BalanceConfig)
    push = {"newtons": list(config.push.newtons), "sagittal_share": config.push.sagittal_share}
    settings = {"stepping": list(stepping.values()), "push": push}
    return {"parameters": {name: float(row[name]) for name in BALANCE_NAMES}, "settings": settings}
