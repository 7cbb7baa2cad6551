"""How does the robot do where it was never trained: on slopes, bumps and ice, with faulty sensors, and under pushes?

The shipped V1 to V4 beside locked hips (V = 0), in both engines at their standard physics.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, get_args

from matplotlib.figure import Figure
from pandas import DataFrame, Series

from experiments.experiment import Experiment, product, survival
from experiments.record import Row
from experiments.shapes import line_panels
from experiments.tables import span, survived_pushes, table, turned_table
from sarah.episode.episode import Episode
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.push import Push
from sarah.episode.robot_settings import conditions_of
from sarah.episode.spec import FIRST_EVALUATION_SEED
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.reports.robustness import PUSHED_BETWEEN, SECONDS_AFTER, PushedEpisode, robustness_table
from sarah.simulation.engines import Engine
from sarah.simulation.randomisation import SensorConditions
from sarah.simulation.terrain import Terrain

TIME_LIMIT = PUSHED_BETWEEN[1] + Push.duration + SECONDS_AFTER
"""Time limit of the episodes, in s: a robot that reaches it has survived."""
SHIPPED = PARAMETER_SETS["balance"].spec
CONTROLLERS: Mapping[str, tuple[float, ...]] = {"shipped V": SHIPPED.parameters, "V = 0": (0.0,) * 4}
"""Values of V1 to V4 by name. P1 to P5 are the shipped ones in either case."""
SETTINGS = (
    f"P1 to P5 are the shipped ones. Pushes last {Push.duration:g} s and begin at {PUSHED_BETWEEN[0]:g} to "
    f"{PUSHED_BETWEEN[1]:g} s. A robot that reaches {TIME_LIMIT:g} s counts as having survived."
)
"""Last sentences of the caption of a table with pushes."""
LEVEL = "level"
NEWTONS = 100.0
"""Force of the pushes that come in every situation, in N."""
FORCES = (50.0, 75.0, NEWTONS, 125.0, 150.0)
"""Forces of the pushes on level ground, in N."""


def pushed(newtons: float, **changes: Any) -> BalanceConfig:
    """Settings of episodes with pushes of a force in N from anywhere, or without any, and other changes."""
    push = Push((newtons, newtons), at_seconds=PUSHED_BETWEEN)
    return BALANCE.config_of(SHIPPED.config, **{"time_limit": TIME_LIMIT, **changes}, push=push)


def askew(drawn: SensorConditions) -> SensorConditions:
    """Sensors whose inertial measurement unit is mounted 2° askew, about the axis that the seed draws."""
    x, y = drawn.imu_tilt
    factor = math.radians(2.0) / math.hypot(x, y)
    return replace(drawn, imu_tilt=(factor * x, factor * y))


def biased(drawn: SensorConditions) -> SensorConditions:
    """Sensors whose gyroscope is 0.05 rad/s off about each axis, with the signs that the seed draws."""
    x, y, z = (math.copysign(0.05, error) for error in drawn.angular_rate_bias)
    return replace(drawn, angular_rate_bias=(x, y, z))


def _friction(left: float, right: float) -> Terrain:
    return Terrain(friction_left=(left, left), friction_right=(right, right))


class Situation(NamedTuple):
    """What a robot meets."""

    terrain: Terrain = Terrain()  # the ground
    sensors: Callable[[SensorConditions], SensorConditions] = lambda drawn: drawn  # of those that the seed draws


SITUATIONS = {
    LEVEL: Situation(),
    "IMU 2° askew": Situation(sensors=askew),
    "gyroscope 0.05 rad/s off": Situation(sensors=biased),
    **{f"slope of {degrees}°": Situation(Terrain(slope_degrees=(degrees, degrees))) for degrees in (4, 8)},
    **{f"bumps of {mm} mm": Situation(Terrain(roughness=(mm / 1000, mm / 1000))) for mm in (10, 20)},
    "friction 0.25": Situation(_friction(0.25, 0.25)),
    "friction 0.15": Situation(_friction(0.15, 0.15)),
    "ice under the left foot": Situation(_friction(0.15, 0.9)),
}
"""Situations by name. All else varies from seed to seed as in trainings."""


def _simulated(situation: Situation, config: BalanceConfig, v: tuple[float, ...], seed: int) -> PushedEpisode:
    """An episode, and the direction of its push."""
    drawn = conditions_of(config, seed)
    conditions = replace(drawn, sensors=situation.sensors(drawn.sensors))
    with Episode(config, seed, BALANCE, conditions=conditions) as episode:
        assert episode.push is not None
        x, y, _ = episode.push.force
        episode.stand()
        return PushedEpisode(config.push.newtons[0], math.atan2(y, x), episode.run(v))


@dataclass(frozen=True)
class Conditions(Experiment):
    """The shipped parameters and V = 0 in each situation, without a push and with one from anywhere."""

    episodes: int = 100  # number of episodes of a case
    time_limit: float = TIME_LIMIT  # time limit of an episode, in s

    def cases(self) -> list[Row]:
        """Each engine, situation, push and V: every force on level ground, and one elsewhere."""
        cases = product(engine=get_args(Engine), situation=SITUATIONS, push_n=(0.0, *FORCES), controller=CONTROLLERS)
        return [case for case in cases if case["situation"] == LEVEL or case["push_n"] in (0.0, NEWTONS)]

    def rows(self, engine: Engine, situation: str, push_n: float, controller: str) -> Iterator[Row]:
        """A row for all pushes, and one for each group of directions."""
        met, v = SITUATIONS[situation], CONTROLLERS[controller]
        config = pushed(push_n, engine=engine, terrain=met.terrain, time_limit=self.time_limit)
        seeds = range(FIRST_EVALUATION_SEED, FIRST_EVALUATION_SEED + self.episodes)
        episodes = [_simulated(met, config, v, seed) for seed in seeds]
        for (_, direction), found in robustness_table(episodes).items():
            if push_n or direction == "all":
                yield {
                    "direction": direction,
                    **survival(found),
                    "score": found.mean("score"),
                    "steps_per_second": found.mean("steps_per_second"),
                    "shifts_by_sensors": found.mean("shifts_by_sensors"),
                    "sole_clearance_mm": 1000.0 * found.mean("sole_clearance"),
                    "final_distance_cm": 100.0 * found.median("drift"),
                }


FULL = Conditions()
QUICK = Conditions(episodes=1, time_limit=1.1)


def answer(rows: DataFrame) -> str:
    """What the robot survives, with the shipped V and with its hips locked."""

    def survived(controller: str, newtons: float, situation: str = LEVEL) -> Series[float]:
        return _everywhere(rows, newtons).query("controller == @controller and situation == @situation").survival

    ours, locked = CONTROLLERS
    score = _everywhere(rows, 0.0).query("controller == @ours").set_index("situation").score
    kept = score["slope of 8°"] / score[LEVEL].to_numpy()
    return (
        f"On level ground the robot survives {survived_pushes(survived(ours, NEWTONS), NEWTONS)} with the shipped V1 "
        f"to V4, and {span(survived(locked, NEWTONS), '.0%')} with its hips locked (V = 0). Of pushes of 125 N it "
        f"survives {span(survived(ours, 125.0), '.0%')}, and {span(survived(locked, 125.0), '.0%')} with locked hips. "
        "A range spans the two engines.\n\n"
        f"On bumps of 10 mm it survives {survived_pushes(survived(ours, NEWTONS, 'bumps of 10 mm'), NEWTONS)}. On a "
        f"slope of 8° it keeps {span(kept, '.0%')} of its score. With ice under one foot "
        f"{span(survived(ours, 0.0, 'ice under the left foot'), '.0%')} of the robots stay in place, even without a "
        "push."
    )


def figure_pushes(rows: DataFrame) -> Figure:
    """Survival by force on level ground, a panel for each group of directions."""
    level = _on_level_ground(rows)
    named = level.assign(line=level.engine + ", " + level.controller)
    return line_panels(named, "direction", "push_n", "survival", "line", sharey=True)


def _everywhere(rows: DataFrame, newtons: float) -> DataFrame:
    return rows[(rows.push_n == newtons) & (rows.direction == "all")]


def _on_level_ground(rows: DataFrame) -> DataFrame:
    return rows[(rows.situation == LEVEL) & (rows.push_n > 0.0)]


def _compared(rows: DataFrame, kept: Sequence[str], column: str, what: str) -> str:
    """A table of one column by engine and V."""
    caption = f"{what}, at the standard physics. {SETTINGS}"
    return turned_table(rows, kept, ("engine", "controller"), column, caption, ".1%" if column == "survival" else "")


def forces(rows: DataFrame) -> str:
    """Survival by force and direction."""
    level = _on_level_ground(rows)
    what = f"Survival of {level.episodes.max()} pushes of each force on level ground, by direction"
    return _compared(level, ("push_n", "direction"), "survival", what)


def distances(rows: DataFrame) -> str:
    """How far from its start the robot ends."""
    level = _on_level_ground(rows)
    what = f"Median distance from the start at the end, in cm, after {level.episodes.max()} pushes on level ground"
    return _compared(level[level.direction == "all"], ("push_n",), "final_distance_cm", what)


def situations(rows: DataFrame) -> str:
    """Survival in each situation."""
    found = _everywhere(rows, NEWTONS)
    what = f"Survival of {found.episodes.max()} pushes of {NEWTONS:.0f} N from all directions in each situation"
    return _compared(found, ("situation",), "survival", what)


def unpushed(rows: DataFrame) -> str:
    """How the robot steps in each situation without a push."""
    still = _everywhere(rows, 0.0)
    ours = still[still.controller == "shipped V"]
    caption = (
        f"How the robot steps without a push, with the shipped P1 to P5 and V1 to V4. Values are means of "
        f"{ours.episodes.max()} episodes of {TIME_LIMIT:.0f} s at the standard physics; the final distance is a median."
    )
    columns = ["survival", "score", "steps_per_second", "shifts_by_sensors", "sole_clearance_mm", "final_distance_cm"]
    return table(ours, ["engine", "situation", *columns], caption, survival=".1%")
