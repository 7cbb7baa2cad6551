"""Which parameters does the package ship, and how well do they do?

P1 to P5 as they are, and the V1 to V4 that the result ``shipping`` has chosen. ``python -m
experiments.robot.shipped_parameters`` writes the package's own file from the rows, sarah/episode/parameter_sets.json. A
set that stays keeps its origin: the command and the commit that first shipped it.
"""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args

from pandas import DataFrame

from experiments import record
from experiments.experiment import Experiment, product
from experiments.record import Row
from experiments.robot.balance_trainings import NAMES as BALANCE_NAMES
from experiments.robot.conditions import SETTINGS, TIME_LIMIT
from experiments.robot.shipping import CHOSEN
from experiments.tables import shown, survived_pushes, table
from sarah.control.parameters import STEPPING_PARAMETERS
from sarah.episode.evaluation import evaluate
from sarah.episode.push import Push, PushedConfig
from sarah.episode.shipped import FILE, shipped
from sarah.episode.spec import FIRST_EVALUATION_SEED
from sarah.episode.tasks import BalanceConfig
from sarah.episode.tasks.balance import TRAINED_STEPPING
from sarah.files import replace_text
from sarah.reports.robustness import PUSHED_BETWEEN
from sarah.simulation.engines import Engine

CONDITIONS = {
    "no push": (0.0, 0.0),
    "100 N": (100.0, 0.0),
    "sagittal 115 N": (115.0, 1.0),
    "125 N": (125.0, 0.0),
}
"""Force in N, and share of sagittal pushes, by the condition that parameters are evaluated in."""
METRICS = ("survival", "score", "steps_per_second")
"""Columns that the package's file keeps beside the number of episodes."""
STEPPING_NAMES = [parameter.name for parameter in STEPPING_PARAMETERS]


@dataclass(frozen=True)
class ShippedParameters(Experiment):
    """The shipped P1 to P5 with locked hips and with the V1 to V4 that the rule chooses."""

    episodes: int = 100  # number of unseen seeds of each set, engine and condition

    def cases(self) -> list[Row]:
        """Set, engine and condition."""
        return product(set=("stepping", "balance"), engine=get_args(Engine), condition=CONDITIONS)

    def rows(self, set: str, engine: Engine, condition: str) -> Iterator[Row]:
        """The values of a set, and how well it does."""
        newtons, sagittal_share = CONDITIONS[condition]
        push = Push((newtons, newtons), at_seconds=PUSHED_BETWEEN, sagittal_share=sagittal_share)
        shared: dict[str, Any] = {"engine": engine, "time_limit": TIME_LIMIT, "push": push}
        balance = chosen() if set == "balance" else {}
        parameters = tuple(balance.values()) or TRAINED_STEPPING
        config = BalanceConfig(**shared) if balance else PushedConfig(**shared)
        first = FIRST_EVALUATION_SEED
        found = evaluate(set, parameters, config, range(first, first + self.episodes))
        yield {
            **dict(zip(STEPPING_NAMES, TRAINED_STEPPING, strict=True)),
            **(balance or dict.fromkeys(BALANCE_NAMES)),
            "episodes": found.episodes,
            "survival": found.survival_rate,
            "score": found.mean("score"),
            "steps_per_second": found.mean("steps_per_second"),
        }


def chosen() -> dict[str, float]:
    """V1 to V4 that the rule chooses; those that ship already as long as it has not."""
    if "shipping" not in record.names():
        return {name: float(shipped()["balance"]["parameters"][name]) for name in BALANCE_NAMES}
    row = next(row for row in record.read("shipping").rows if row["verdict"] == CHOSEN)
    return {name: float(row[name]) for name in BALANCE_NAMES}


FULL = ShippedParameters()
QUICK = ShippedParameters(episodes=1)


def ship(result: record.Result, path: Path = FILE) -> None:
    """Write the package's file of learned parameters from the result ``shipped_parameters``."""
    text = json.dumps(_sets_of(result), indent=2, ensure_ascii=False)
    replace_text(path, re.sub(r"\[[^\[\]]*\]", lambda numbers: " ".join(numbers[0].split()), text) + "\n")


def _sets_of(result: record.Result) -> dict[str, Any]:
    """Content of the package's file: what it says already, with the values and figures of the rows."""
    sets = copy.deepcopy(shipped())
    versions = dict(word.split(maxsplit=1) for word in result.versions.split(", "))
    origin = {"command": result.command, "commit": result.commit, "date": result.date, "versions": versions}
    for row in result.rows:
        whole = sets[row["set"]]
        parameters = {name: float(row[name]) for name in whole["parameters"]}
        if parameters != whole["parameters"]:
            whole |= {"parameters": parameters, "origin": origin}
        figures = {column: float(row[column]) for column in METRICS}
        whole["figures"][row["engine"]][row["condition"]] = {"episodes": int(row["episodes"]), **figures}
    return sets


def answer(rows: DataFrame) -> str:
    """How many pushes the robot survives, in PyBullet."""
    survival = rows[rows.engine == "pybullet"].set_index(["set", "condition"]).survival
    (soft, hard), (locked_soft, locked_hard) = (
        [survival[name, condition] for condition in ("100 N", "125 N")] for name in ("balance", "stepping")
    )
    return (
        f"In PyBullet the robot survives {survived_pushes([soft], 100.0)} with the shipped parameters, and "
        f"{shown(locked_soft, '.0%')} with locked hips. Of pushes of 125 N it survives {shown(hard, '.0%')}, and "
        f"{shown(locked_hard, '.0%')} with locked hips. Pushes come from all directions."
    )


def values(rows: DataFrame) -> str:
    """The values of both sets."""
    names = [*STEPPING_NAMES, *BALANCE_NAMES]
    sets = rows.drop_duplicates("set").set_index("set")[names].T.rename_axis("parameter").reset_index()
    caption = "The values. The hips of the set stepping are locked."
    return table(sets, ["parameter", "stepping", "balance"], caption, stepping=".2f", balance=".2f")


def survived(rows: DataFrame) -> str:
    """How well both sets do."""
    caption = (
        f"Means of {FULL.episodes} episodes of each set, engine and condition. Sagittal pushes come from within 30"
        f" degrees of front or back, the others from all directions. {SETTINGS}"
    )
    return table(rows, ["set", "engine", "condition", *METRICS], caption)


if __name__ == "__main__":
    ship(record.read("shipped_parameters"))
