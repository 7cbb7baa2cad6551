"""Which survival of hard pushes can be believed: does it depend on the engine, and on how fine the physics is?"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import get_args

import numpy as np
from pandas import DataFrame

from experiments.experiment import Experiment, product, survival
from experiments.record import Row
from experiments.robot.conditions import CONTROLLERS, SETTINGS, TIME_LIMIT, pushed
from experiments.shapes import groups
from experiments.tables import shown, span, table
from sarah.episode.evaluation import evaluate
from sarah.episode.spec import FIRST_EVALUATION_SEED
from sarah.episode.tasks import BALANCE
from sarah.simulation.engines import Engine
from sarah.simulation.physics import PHYSICS

SURVIVED, LOST = "s", "l"
"""What stands for a push in the column of all outcomes."""


@dataclass(frozen=True)
class HardPushes(Experiment):
    """The same pushes from anywhere in both engines, each at the standard and at the reference physics."""

    pushes: int = 200  # number of pushes of a case
    time_limit: float = TIME_LIMIT  # time limit of an episode, in s

    def cases(self) -> list[Row]:
        """Each force, V, engine and physics."""
        physics = ("standard", "reference")
        return product(push_n=(125.0, 100.0), controller=CONTROLLERS, engine=get_args(Engine), physics=physics)

    def rows(self, push_n: float, controller: str, engine: Engine, physics: str) -> Iterator[Row]:
        """How many pushes the robot survives, and which."""
        config = pushed(push_n, engine=engine, physics=PHYSICS[physics], time_limit=self.time_limit)
        seeds = range(FIRST_EVALUATION_SEED, FIRST_EVALUATION_SEED + self.pushes)
        found = evaluate(BALANCE, CONTROLLERS[controller], config, seeds)
        outcomes = "".join(SURVIVED if result.survived else LOST for result in found.results)
        yield {**survival(found), "outcomes": outcomes}


FULL = HardPushes()
QUICK = HardPushes(pushes=1, time_limit=1.1)


def difference(ones: str, others: str) -> Row:
    """Columns of the difference of two survivals with its 95 % interval.

    Pushes with the same outcome in both say nothing about it. Half a push is added to each of the four pairs of
    outcomes, so that the interval is never empty (Agresti and Min 2005).
    """
    pairs = list(zip(ones, others, strict=True))
    gained, lost, count = pairs.count((SURVIVED, LOST)), pairs.count((LOST, SURVIVED)), len(pairs)
    middle = (gained - lost) / (count + 2)
    error = math.sqrt((gained + lost + 1) / (count + 2) - middle**2) / math.sqrt(count + 2)
    low, high = middle - 1.96 * error, middle + 1.96 * error
    return {"difference": (gained - lost) / count, "difference_low": low, "difference_high": high}


def _differences(rows: DataFrame) -> DataFrame:
    """Differences between the physics of each engine, and between the engines at each physics."""
    pybullet, mujoco = get_args(Engine)
    compared = [((engine, "standard"), (engine, "reference")) for engine in (pybullet, mujoco)]
    compared += [((pybullet, physics), (mujoco, physics)) for physics in ("standard", "reference")]
    found = []
    for keys, group in groups(rows, "push_n", "controller").items():
        outcomes = group.set_index(["engine", "physics"]).outcomes
        for ones, others in compared:
            names = dict(zip(("push_n", "controller"), keys, strict=True))
            names |= {"survival_in": " ".join(ones), "minus_that_in": " ".join(others)}
            found.append({**names, **difference(outcomes[ones], outcomes[others])})
    return DataFrame(found)


def _agree_better(rows: DataFrame) -> bool:
    """Whether the engines agree better at the reference physics, by more than chance: push by push, to 95 %."""

    def apart(physics: str) -> np.ndarray:
        """Lead of the engine in which more pushes are survived."""
        ones, others = (np.array(list(cell)) == SURVIVED for cell in rows[rows.physics == physics].outcomes)
        lead = ones.astype(float) - others
        return lead * np.sign(lead.mean())

    closer = apart("standard") - apart("reference")
    return bool(closer.mean() > 1.96 * closer.std(ddof=1) / math.sqrt(len(closer)))


def answer(rows: DataFrame) -> str:
    """How far the engines are apart at each physics, and which figures to believe."""
    hard = (rows.push_n == 125.0) & (rows.controller == "shipped V")
    locked = rows[(rows.push_n == 125.0) & (rows.controller == "V = 0") & (rows.physics == "reference")].survival
    survived = {physics: group.survival for physics, group in groups(rows[hard], "physics").items()}
    standard, reference = ([shown(share, ".0%") for share in shares] for shares in survived.values())
    verdict = (
        "The engines agree better there, so believe these figures, to within the difference between the engines."
        if _agree_better(rows[hard])
        else "It cannot be told that the engines agree better there, so all that is known is the range from the lowest "
        "to the highest of these figures."
    )
    return (
        f"With the shipped V the robot survives {standard[0]} of pushes of 125 N in PyBullet and {standard[1]} in "
        f"MuJoCo, both at the standard physics. At the reference physics it survives {reference[0]} and "
        f"{reference[1]}, and {span(locked, '.0%')} with locked hips. {verdict}"
    )


def survivals(rows: DataFrame) -> str:
    """Survival in each engine at each physics."""
    columns = ["push_n", "controller", "engine", "physics", "episodes", "survival", "survival_low", "survival_high"]
    caption = f"Survival of the same pushes from all directions, with its 95 % interval (Wilson). {SETTINGS}"
    return table(rows, columns, caption, survival=".1%")


def pairs(rows: DataFrame) -> str:
    """The differences between these survivals."""
    caption = "Differences between these survivals in percentage points, push by push, with their 95 % intervals."
    compared = _differences(rows)
    return table(compared, list(compared.columns), caption)
