"""The parameters that the package ships: P1 to P5 as they are, V1 to V4 as the shipping rule chooses them.

``make results NAME=shipped_parameters`` writes the package's own file too, sarah/episode/parameter_sets.json, from the
rows. A set that stays keeps its origin: the command and the commit that first shipped it.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from experiments import record
from experiments.balance_trainings import BALANCE_NAMES
from experiments.engines import ENGINES
from experiments.record import Row
from experiments.shipping_rule import Shipping
from experiments.trainings import EPISODES
from sarah.control.parameters import STEPPING_PARAMETERS
from sarah.episode.evaluation import evaluate
from sarah.episode.push import Push, PushedConfig
from sarah.episode.shipped import FILE, shipped
from sarah.episode.spec import FIRST_EVALUATION_SEED
from sarah.episode.tasks import BalanceConfig
from sarah.episode.tasks.balance import TRAINED_STEPPING
from sarah.episode.workers import Workers
from sarah.files import replace_text
from sarah.reports.robustness import PUSHED_BETWEEN, SECONDS_AFTER

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
STEPPING_NAMES = [parameter.name for parameter in STEPPING_PARAMETERS]


@dataclass(frozen=True)
class ShippedParameters(Shipping):
    """The shipped P1 to P5, the V1 to V4 that the rule chooses, and how well both do.

    :param episodes: number of unseen seeds of each set, engine and condition
    """

    episodes: int = 100

    def rows(self) -> Iterator[Row]:
        """A row for each set, engine and condition."""
        with Workers(self.workers) as workers:
            yield from self.evaluated("stepping", (), workers)
            chosen = self.choice(self.judged(workers))
            yield from self.evaluated("balance", chosen.parameters, workers)

    def evaluated(self, task: str, balance: tuple[float, ...], workers: Workers) -> Iterator[Row]:
        """A row for each engine and condition.

        :param task: name of the task, which is that of the set too
        :param balance: values of V1 to V4; none for the task ``stepping``
        :param workers: who simulates
        """
        names = [*STEPPING_NAMES, *BALANCE_NAMES]
        values = dict(zip(names, (*TRAINED_STEPPING, *balance, *[None] * len(BALANCE_NAMES)), strict=False))
        seeds = range(FIRST_EVALUATION_SEED, FIRST_EVALUATION_SEED + self.episodes)
        for engine in ENGINES:
            for condition, (newtons, sagittal_share) in CONDITIONS.items():
                push = Push((newtons, newtons), at_seconds=PUSHED_BETWEEN, sagittal_share=sagittal_share)
                limit = self.time_limit or PUSHED_BETWEEN[1] + push.duration + SECONDS_AFTER
                shared: dict[str, Any] = {"engine": engine, "time_limit": limit, "push": push}
                config = BalanceConfig(**shared) if balance else PushedConfig(**shared)
                found = evaluate(task, balance or TRAINED_STEPPING, config, seeds, workers)
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


def ship(result: record.Result, path: Path = FILE) -> None:
    """Write the package's file of learned parameters.

    :param result: the result ``shipped_parameters``
    :param path: the file
    """
    text = json.dumps(sets_of(result), indent=2, ensure_ascii=False)
    replace_text(path, re.sub(r"\[[^\[\]]*\]", lambda numbers: " ".join(numbers[0].split()), text) + "\n")


def sets_of(result: record.Result) -> dict[str, Any]:
    """Content of the package's file.

    :param result: the result ``shipped_parameters``
    """
    sets: dict[str, Any] = {}
    for row in result.rows:
        name = row["set"]
        chosen = _chosen(row)
        whole = sets.setdefault(name, {"task": name, **chosen, "origin": _origin(name, chosen, result), "figures": {}})
        of_engine = whole["figures"].setdefault(row["engine"], {})
        figures = {column: float(row[column]) for column in FIGURES}
        of_engine[row["condition"]] = {"episodes": int(row["episodes"]), **figures}
    return sets


def _origin(name: str, chosen: Mapping[str, Any], result: record.Result) -> Any:
    """Where a set comes from: what the file says already, if the set stays."""
    before = shipped()[name]
    if all(before[key] == value for key, value in chosen.items()):
        return before["origin"]
    known = dict(word.split(maxsplit=1) for word in result.versions.split(", "))
    versions = {name: known[name] for name in VERSIONS}
    return {"command": result.command, "commit": result.commit, "date": result.date, "versions": versions}


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
