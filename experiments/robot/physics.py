"""How fine must the physics be?

Scores of good parameters at several settings of the physics, each on the same seeds, with noise and delay and without.
Differences are from the finest setting.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from statistics import mean, stdev

from pandas import DataFrame

from experiments.experiment import Experiment, product
from experiments.record import Row
from experiments.tables import shown, table, turned_table
from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.evaluation import evaluate
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.push import Push
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.simulation.engines import Engine
from sarah.simulation.physics import PyBulletPhysics
from sarah.simulation.randomisation import Randomisation

STANDARD = PyBulletPhysics()
FINEST = "reference"
SETTINGS: dict[str, tuple[Engine, PyBulletPhysics]] = {
    FINEST: ("pybullet", PyBulletPhysics(1000, 100, added_plate_inertia=0.0)),
    "500 Hz x 30": ("pybullet", PyBulletPhysics(500, 30, added_plate_inertia=0.0)),
    "no added inertia": ("pybullet", replace(STANDARD, added_plate_inertia=0.0)),
    "standard": ("pybullet", STANDARD),
    "mujoco": ("mujoco", STANDARD),
}
"""Engine and physics by name: the finest, a coarser one, the standard without and with its added inertia, MuJoCo's."""
SENSORS = {f"{1000 * delay:g} ms": Randomisation(delay_seconds=delay) for delay in (0.0, 0.010, 0.020)}
SENSORS["as designed"] = Randomisation(enabled=False)
LOCKED, MOVING = (0.0, 0.0, 0.0, 0.0), (1.0, 0.0, 1.0, 0.0)
SHIPPED = PARAMETER_SETS["balance"].spec
SHIPPED_STEPPING = BALANCE.config_of(SHIPPED.config).stepping
LOW_P1 = (0.02, 0.05, 0.55, 1.8, 1.3)
"""P1 to P5 that NAF learned in one training, with a P1 near zero."""
GOOD = {
    "paper, V = 0": (PAPER_STEPPING, LOCKED),
    "shipped, V = 0": (SHIPPED_STEPPING, LOCKED),
    "low P1, V = 0": (LOW_P1, LOCKED),
    "paper, V1 = V3 = 1": (PAPER_STEPPING, MOVING),
    "shipped": (SHIPPED_STEPPING, SHIPPED.parameters),
    "low P1, V1 = V3 = 1": (LOW_P1, MOVING),
}
"""P1 to P5 and V1 to V4 that score well, by name."""
CONDITION = ["parameters", "control_rate_hz", "sensors"]
CLOSE, FAR = 0.03, 0.05
"""Differences up to which a score counts as close, and from which it counts as far off."""


@dataclass(frozen=True)
class Physics(Experiment):
    """Parameter sets at each setting of the physics, without a push."""

    seeds: int = 8  # number of episodes of each set at each setting, at least 2
    sets: int = len(GOOD)
    time_limit: float = 10.0  # time limit of an episode, in s

    def cases(self) -> list[Row]:
        """Each set in each condition."""
        return product(parameters=list(GOOD)[: self.sets], control_rate_hz=(100, 200), sensors=SENSORS)

    def rows(self, parameters: str, control_rate_hz: int, sensors: str) -> Iterator[Row]:
        """A row for each setting of the physics, the finest first."""
        stepping, balance = GOOD[parameters]
        finest: list[float] = []
        for setting, (engine, physics) in SETTINGS.items():
            config = BalanceConfig(
                physics.at_control_rate(control_rate_hz),
                engine,
                randomisation=SENSORS[sensors],
                time_limit=self.time_limit,
                stepping=stepping,
                push=Push(newtons=(0.0, 0.0)),
            )
            seeds = self.seeds if config.randomisation.enabled else 1  # as designed, all episodes are the same
            found = evaluate(BALANCE, balance, config, range(seeds))
            scores = [result.score for result in found.results]
            finest = finest or scores
            differences = [one - other for one, other in zip(scores, finest, strict=True)]
            error = stdev(differences) / seeds**0.5 / mean(finest) if seeds > 1 and setting != FINEST else None
            yield {
                "setting": setting,
                "score": mean(scores),
                "difference_error": error,
                "steps_per_second": found.mean("steps_per_second"),
                "shifts_timed_out": 1.0 - found.mean("shifts_by_sensors"),
            }


FULL = Physics()
QUICK = Physics(seeds=2, sets=1, time_limit=1.2)


def beside_finest(rows: DataFrame) -> DataFrame:
    """Rows of the coarser settings, with the finest setting's score and steps beside them."""
    finest = rows[rows.setting == FINEST].rename(columns=lambda name: name if name in CONDITION else f"finest_{name}")
    both = rows[rows.setting != FINEST].merge(finest, on=CONDITION)
    return both.assign(difference=both.score / both.finest_score - 1.0)


def answer(rows: DataFrame) -> str:
    """How close the standard physics is, and MuJoCo."""
    off = beside_finest(rows).pivot(index=CONDITION, columns="setting", values="difference").abs()
    close, worst = (off < CLOSE).sum(), off.max().map(lambda value: shown(value, ".0%"))
    share = close.standard / len(off)
    verdict = "fine enough" if share == 1.0 else "fine enough, with exceptions" if share > 0.75 else "too coarse"
    return (
        f"The standard physics is {verdict}. In {close.standard} of {len(off)} combinations of good "
        f"parameters, control rate and sensors its score is within {shown(CLOSE, '.0%')} of the finest setting's. "
        f"MuJoCo's is in {close.mujoco}. At worst the standard physics is off by {worst.standard}, and MuJoCo by "
        f"{worst.mujoco}."
    )


def differences(rows: DataFrame) -> str:
    """How far each coarser setting is from the finest."""
    both = beside_finest(rows)
    both = both.assign(finest=both.finest_score.map("{:.3f}".format))
    caption = (
        f"Mean score at the finest setting, and relative differences at the others: {FULL.seeds} episodes of "
        f"{FULL.time_limit:.0f} s without a push. The standard error of a difference is "
        f"{shown(both.difference_error.median(), '.1%')} in the median."
    )
    return turned_table(both, [*CONDITION, "finest"], "setting", "difference", caption)


def far_off(rows: DataFrame) -> str:
    """The conditions with large differences, and how the robot steps there."""
    both = beside_finest(rows)
    columns = ["difference", "difference_error", "finest_steps_per_second", "steps_per_second", "shifts_timed_out"]
    caption = (
        f"Where the score differs by more than {shown(FAR, '.0%')} from that at the finest setting, without a push: "
        f"the difference with its standard error, the steps per second at both settings, and the share of SHIFTs that "
        f"timed out."
    )
    far = both[both.difference.abs() > FAR]
    formats = {"difference_error": ".1%", "timed_out": ".0%"}
    return table(far, [*CONDITION, "setting", *columns], caption, **formats)
