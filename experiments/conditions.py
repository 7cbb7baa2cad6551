"""What the shipped parameters do on slopes, with sensors mounted askew or biased, and under pushes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple, get_args

from experiments.maker import ParallelExperiment, survival
from experiments.record import Row
from sarah.episode.episode import Episode
from sarah.episode.evaluation import Evaluation
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.push import Push
from sarah.episode.result import EpisodeResult
from sarah.episode.robot_settings import conditions_of
from sarah.episode.spec import FIRST_EVALUATION_SEED
from sarah.episode.tasks import BALANCE, BalanceConfig, Task
from sarah.episode.workers import Workers
from sarah.simulation.engines import Engine
from sarah.simulation.physics import PHYSICS
from sarah.simulation.terrain import Terrain

LEARNED = PARAMETER_SETS["balance"].spec
HIPS = {"learned": LEARNED.parameters, "V = 0": (0.0,) * 4}
"""Values of V1 to V4, by name."""
SIGNS = ((1, 1), (1, -1), (-1, -1), (-1, 1))
"""Signs of a bias about x and y, in turn."""
LATERAL, SAGITTAL = (0.0, 180.0), (90.0, 270.0)


class Situation(NamedTuple):
    """What a robot meets. Directions are spread evenly over the episodes, unless they are given.

    :param name: name of the situation
    :param slope_degrees: slope of the ground, in degrees
    :param imu_tilt_degrees: angle by which the inertial measurement unit is mounted askew; by default each seed's own
    :param angular_rate_bias: error of the gyroscope about x and about y, in rad/s; by default each seed's own
    :param newtons: force of the push, in N
    :param push_degrees: directions of the pushes, in turn, in degrees
    """

    name: str
    slope_degrees: float = 0.0
    imu_tilt_degrees: float | None = None
    angular_rate_bias: float | None = None
    newtons: float = 0.0
    push_degrees: tuple[float, ...] = ()


FLAT = Situation("flat")
UNPUSHED = (
    FLAT,
    Situation("IMU 2° askew", imu_tilt_degrees=2.0),
    Situation("gyroscope 0.05 rad/s off", angular_rate_bias=0.05),
    *(Situation(f"slope of {degrees:.0f}°", slope_degrees=degrees) for degrees in (4.0, 6.0, 8.0)),
)
PUSHED = (
    Situation("100 N", newtons=100.0),
    Situation("125 N", newtons=125.0),
    Situation("100 N lateral", newtons=100.0, push_degrees=LATERAL),
    Situation("125 N lateral", newtons=125.0, push_degrees=LATERAL),
    Situation("115 N sagittal", newtons=115.0, push_degrees=SAGITTAL),
    Situation("100 N sagittal, slope of 4°", slope_degrees=4.0, newtons=100.0, push_degrees=SAGITTAL),
)


def simulate(
    situation: Situation, hips: str, index: int, count: int, config: BalanceConfig, task: Task[BalanceConfig] = BALANCE
) -> EpisodeResult:
    """Simulate one of the episodes of a situation.

    :param situation: what the robot meets
    :param hips: name of V1 to V4
    :param index: index of the episode, from 0
    :param count: number of episodes
    :param config: settings of the episodes, without push and slope
    :param task: task, which says how an episode ends
    """
    seed, direction = FIRST_EVALUATION_SEED + index, 360.0 * index / count
    degrees = situation.push_degrees[index % len(situation.push_degrees)] if situation.push_degrees else direction
    push = Push((situation.newtons,) * 2, (degrees, degrees), at_seconds=(2.0, 3.0))
    terrain = Terrain((situation.slope_degrees,) * 2, (direction, direction))
    config = replace(config, push=push, terrain=terrain)
    conditions = conditions_of(config, seed)
    sensors = conditions.sensors
    if situation.imu_tilt_degrees is not None:
        tilt, axis = math.radians(situation.imu_tilt_degrees), math.radians(direction)
        sensors = replace(sensors, imu_tilt=(tilt * math.cos(axis), tilt * math.sin(axis)))
    if situation.angular_rate_bias is not None:
        x, y = (sign * situation.angular_rate_bias for sign in SIGNS[index % len(SIGNS)])
        sensors = replace(sensors, angular_rate_bias=(x, y, sensors.angular_rate_bias[2]))
    with Episode(config, seed, task, conditions=replace(conditions, sensors=sensors)) as episode:
        episode.stand()
        return episode.run(HIPS[hips])


@dataclass(frozen=True)
class Conditions(ParallelExperiment):
    """The shipped parameters, and under pushes also V = 0, in both engines and at the reference physics.

    :param episodes: number of episodes of a row
    :param reference_episodes: number of episodes of a row at PyBullet's reference physics; with 0 there is no such row
    :param time_limit: time limit without a push, in s
    :param pushed_seconds: time limit with a push, which comes at 2 to 3 s, in s
    """

    episodes: int = 200
    reference_episodes: int = 12
    time_limit: float = 12.0
    pushed_seconds: float = 8.0

    def rows(self) -> Iterator[Row]:
        """A row for each engine, physics, situation and values of V1 to V4."""
        cases = [(situation, "learned") for situation in UNPUSHED]
        cases += [(situation, hips) for situation in PUSHED for hips in HIPS]
        judges: list[tuple[Engine, str, int]] = [(engine, "standard", self.episodes) for engine in get_args(Engine)]
        if self.reference_episodes:
            judges.append(("pybullet", "reference", self.reference_episodes))
        with Workers(self.workers) as workers:
            for engine, physics, count in judges:
                flat_score = math.nan
                for situation, hips in cases:
                    limit = self.pushed_seconds if situation.newtons else self.time_limit
                    config = BALANCE.config_of(
                        LEARNED.config, physics=PHYSICS[physics], engine=engine, time_limit=limit
                    )
                    jobs = [workers.submit(simulate, situation, hips, index, count, config) for index in range(count)]
                    found = Evaluation(tuple(job.result() for job in jobs))
                    score = found.mean("score")
                    if situation is FLAT:
                        flat_score = score
                    yield {
                        "engine": engine,
                        "physics": physics,
                        "situation": situation.name,
                        "push_n": f"{situation.newtons:g}",
                        "hips": hips,
                        **survival(found),
                        "score": score,
                        "worst_score": found.statistic("score", "min"),
                        "kept": None if situation.newtons else score / flat_score,
                        "steps_per_second": found.mean("steps_per_second"),
                        "shifts_by_sensors": found.mean("shifts_by_sensors"),
                        "sole_clearance_mm": 1000.0 * found.mean("sole_clearance"),
                        "vibration_m2_s4": found.median("vibration"),
                        "final_distance_cm": 100.0 * found.median("drift"),
                    }
