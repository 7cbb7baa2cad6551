"""What does each dimension of the robot do for its stability?

Robots that differ from the default in one dimension, or in one constant of the controller.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from statistics import mean
from typing import Any

from pandas import DataFrame

from experiments.experiment import Experiment, product
from experiments.record import Row
from experiments.robot.conditions import TIME_LIMIT
from experiments.shapes import groups
from experiments.tables import shown, table
from sarah.control.constants import ControllerConstants
from sarah.episode.episode import simulate
from sarah.episode.push import Push
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.reports.robustness import PUSHED_BETWEEN

HIPS = {"locked": (0.0, 0.0, 0.0, 0.0), "V1 = V3 = 1": (1.0, 0.0, 1.0, 0.0)}
LATERAL, SAGITTAL = (0.0, 180.0), (90.0, 270.0)
"""Directions of the pushes, which come from both sides in turn, in degrees."""
NEWTONS = 100.0
ROBOTS: dict[str, dict[str, Any]] = {
    "defaults": {},
    **{f"hips ±{x:.2f} m": {"dimensions": {"hip_offset": x}} for x in (0.10, 0.11, 0.12, 0.14)},
    **{
        f"sole ±{x:.3f} m long": {"dimensions": {"forefoot_contact": x, "hindfoot_contact": x}}
        for x in (0.115, 0.125, 0.135, 0.15)
    },
    **{f"sole ±{x:.3f} m wide": {"dimensions": {"sole_half_width": x}} for x in (0.045, 0.055)},
    **{
        f"shift extension {1000 * x:.0f} mm": {"controller": ControllerConstants(shift_extension=x)}
        for x in (0.004, 0.006, 0.010)
    },
    **{f"lift {1000 * x:.0f} mm": {"controller": ControllerConstants(lift_retraction=x)} for x in (0.02, 0.025, 0.035)},
}
"""Settings that differ from the defaults, by the name of the robot."""


@dataclass(frozen=True)
class RobotDimensions(Experiment):
    """Stepping without a push, and survival of 100 N, with one dimension away from the defaults."""

    pushes: int = 20  # number of pushes in each pair of directions
    unpushed: int = 2  # number of episodes without a push
    time_limit: float = 15.0  # time limit of these, in s
    pushed_seconds: float = TIME_LIMIT  # time limit with a push, in s

    def cases(self) -> list[Row]:
        """Each robot with locked hips and with hips that move."""
        return product(hips=HIPS, robot=ROBOTS)

    def rows(self, hips: str, robot: str) -> Iterator[Row]:
        """How a robot steps, and which pushes it survives."""

        def episode(seed: int, push: Push, limit: float) -> EpisodeResult:
            config = BalanceConfig(engine="pybullet", push=push, time_limit=limit, **ROBOTS[robot])
            return simulate(EpisodeSpec(HIPS[hips], seed, BALANCE, config))

        def survival(degrees: tuple[float, float]) -> float:
            pushes = [Push((NEWTONS, NEWTONS), (angle, angle), at_seconds=PUSHED_BETWEEN) for angle in degrees]
            return mean(episode(seed, pushes[seed % 2], self.pushed_seconds).survived for seed in range(self.pushes))

        free = [episode(seed, Push(newtons=(0.0, 0.0)), self.time_limit) for seed in range(self.unpushed)]
        yield {
            "score": mean(result.score for result in free),
            "steps_per_second": mean(result.steps_per_second for result in free),
            "lateral_survival": survival(LATERAL),
            "sagittal_survival": survival(SAGITTAL),
        }


FULL = RobotDimensions()
QUICK = RobotDimensions(time_limit=1.1, pushed_seconds=1.1, pushes=1, unpushed=1)


def answer(rows: DataFrame) -> str:
    """What the length of the soles and the distance of the hips decide."""
    cells = rows.set_index(["hips", "robot"])
    sole = [cells.sagittal_survival["locked", f"sole ±{length} m long"] for length in ("0.115", "0.150")]
    hips = [cells.lateral_survival["V1 = V3 = 1", f"hips ±{offset} m"] for offset in ("0.10", "0.12")]
    short, long, narrow, wide = (shown(survival, ".0%") for survival in (*sole, *hips))
    return (
        f"Of pushes from front and back the robot survives {short} with locked hips and the shortest soles tried, and "
        f"{long} with the longest. Of pushes from the sides it survives {narrow} with V1 = V3 = 1 and hips at ±0.10 m, "
        f"and {wide} at ±0.12 m."
    )


def robots(rows: DataFrame) -> str:
    """Score, steps and survival."""
    caption = (
        f"Robots with {{}} and the shipped P1 to P5 in PyBullet. Score and steps are means of {FULL.unpushed} episodes "
        f"without a push. Survival is of {FULL.pushes} pushes of {NEWTONS:.0f} N of each kind, at "
        f"{PUSHED_BETWEEN[0]:g} to {PUSHED_BETWEEN[1]:g} s. A robot that reaches "
        f"{FULL.pushed_seconds:g} s counts as having survived."
    )
    captions = {hips: caption.format("locked hips" if hips == "locked" else hips) for hips in HIPS}
    told = groups(rows, "hips").items()
    columns = ["robot", "score", "steps_per_second", "lateral_survival", "sagittal_survival"]
    return "\n\n".join(table(group, columns, captions[str(hips)], score=".2f") for hips, group in told)
