"""What each dimension of the robot does for its stability: one at a time away from the defaults."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from statistics import mean

from experiments.maker import ParallelExperiment
from experiments.record import Row
from sarah.control.constants import ControllerConstants
from sarah.episode.push import Push
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.episode.workers import Workers

CONTROLLERS = ((0.0, 0.0, 0.0, 0.0), (1.0, 0.0, 1.0, 0.0))
DIRECTIONS = {"lateral": (0.0, 180.0), "sagittal": (90.0, 270.0)}
"""Directions of the pushes, which come from both sides in turn, in degrees."""
NEWTONS = 100.0


@dataclass(frozen=True)
class Robot:
    """A robot to try.

    :param name: name of the robot
    :param dimensions: dimensions that differ from the defaults
    :param constants: constants of its controller
    """

    name: str
    dimensions: Mapping[str, float] = field(default_factory=dict)
    constants: ControllerConstants = ControllerConstants()


def sole(length: float) -> dict[str, float]:
    """Dimensions of a sole that reaches as far forward as back.

    :param length: distance from the ankle to either end, in m
    """
    return {"forefoot_contact": length, "hindfoot_contact": length}


ROBOTS = (
    Robot("defaults"),
    *(Robot(f"hips ±{offset:.2f} m", {"hip_offset": offset}) for offset in (0.10, 0.11, 0.12, 0.14)),
    *(Robot(f"sole ±{length:.3f} m long", sole(length)) for length in (0.115, 0.125, 0.135, 0.15)),
    *(Robot(f"sole ±{width:.3f} m wide", {"sole_half_width": width}) for width in (0.045, 0.055)),
    *(
        Robot(f"shift extension {1000 * length:.0f} mm", constants=ControllerConstants(shift_extension=length))
        for length in (0.004, 0.006, 0.010)
    ),
    *(
        Robot(f"lift {1000 * length:.0f} mm", constants=ControllerConstants(lift_retraction=length))
        for length in (0.020, 0.025, 0.035)
    ),
)


@dataclass(frozen=True)
class RobotDimensions(ParallelExperiment):
    """Stepping without a push, and survival of 100 N, with one dimension away from the defaults.

    :param pushes: number of pushes in each pair of directions
    :param unpushed: number of episodes without a push
    :param time_limit: time limit of these, in s
    :param pushed_seconds: time limit with a push, in s: it comes at 2 to 3 s, and who is up 2.5 s later has survived
    """

    pushes: int = 20
    unpushed: int = 2
    time_limit: float = 15.0
    pushed_seconds: float = 5.65

    def rows(self) -> Iterator[Row]:
        """A row for each robot and controller."""
        with Workers(self.workers) as workers:
            for robot in ROBOTS:
                for controller in CONTROLLERS:
                    yield self._row(robot, controller, workers)

    def _row(self, robot: Robot, controller: tuple[float, ...], workers: Workers) -> Row:
        def spec(seed: int, push: Push, limit: float) -> EpisodeSpec:
            config = BalanceConfig(
                engine="pybullet", dimensions=robot.dimensions, controller=robot.constants, push=push, time_limit=limit
            )
            return EpisodeSpec(controller, seed, BALANCE.name, config)

        still = Push(newtons=(0.0, 0.0))
        specs = [spec(seed, still, self.time_limit) for seed in range(self.unpushed)]
        for degrees in DIRECTIONS.values():
            for seed in range(self.pushes):
                push = Push((NEWTONS, NEWTONS), (degrees[seed % 2],) * 2, at_seconds=(2.0, 3.0))
                specs.append(spec(seed, push, self.pushed_seconds))
        results = list(workers.simulate_all(specs))
        free, pushed = results[: self.unpushed], results[self.unpushed :]
        survived = [result.survived for result in pushed]
        return {
            "robot": robot.name,
            "V": f"({', '.join(f'{value:g}' for value in controller)})",
            "score": mean(result.score for result in free),
            "steps_per_second": mean(result.steps_per_second for result in free),
            "lateral_survival": mean(survived[: self.pushes]),
            "sagittal_survival": mean(survived[self.pushes :]),
        }
