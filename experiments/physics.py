"""How fine must the physics be? Scores of parameter sets at several settings, each on the same seeds.

Scores come with their distance from the first setting's, which is the finest, and the standard error of that.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from statistics import mean, stdev

from experiments.experiment import OnWorkers, settings_of
from experiments.record import Row
from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks.balance import TRAINED_STEPPING
from sarah.episode.workers import Workers
from sarah.simulation.physics import PyBulletPhysics

SETTINGS = (
    PyBulletPhysics(1000, 100, added_plate_inertia=0.0),
    PyBulletPhysics(1000, 100),
    PyBulletPhysics(500, 30, added_plate_inertia=0.0),
    PyBulletPhysics(200, 40, added_plate_inertia=0.0),
    PyBulletPhysics(),
)
"""The finest, what its plates do with added inertia, coarser ones, and the standard."""
SETS = {
    "stepping": (
        PAPER_STEPPING,
        TRAINED_STEPPING,
        (0.02, 0.05, 0.55, 1.8, 1.3),
        (0.15, 0.3, 0.25, 0.5, 0.5),
        (0.42, 0.39, 0.91, 0.5, 1.2),
        (0.5, 0.8, 0.1, 1.0, 1.0),
        (0.8, 1.2, 0.1, 1.0, 1.0),
        (0.2, 0.0, 2.0, 0.0, 0.0),
    ),
    "balance": (
        (0.0, 0.0, 0.0, 0.0),
        (1.1, 0.34, -0.04, -1.72),
        (1.8, 0.0, 1.0, 0.0),
        (1.1, 0.0, 0.0, 0.0),
        (0.8, 0.0, 0.4, 0.0),
        (1.29, 0.23, -0.02, -1.97),
        (0.4, 0.0, 0.0, 0.0),
        (0.5, 0.0, 0.0, 0.0),
    ),
}
"""Good sets, poor ones, and what trainings at a cheap physics learned."""


@dataclass(frozen=True, kw_only=True)
class AtEverySetting(OnWorkers):
    """What the experiments below share.

    :param seeds: number of episodes of each set at each setting, at least 2
    :param time_limit: time limit of an episode, in s
    """

    seeds: int = 20
    time_limit: float = 12.0

    def results(
        self, task: str, parameters: tuple[float, ...], newtons: float, workers: Workers
    ) -> Iterator[tuple[Row, list[EpisodeResult]]]:
        """Each setting's columns, and the results of a parameter set there.

        :param task: name of the task
        :param parameters: values of its parameters
        :param newtons: force of the pushes, if the task has some, in N
        :param workers: who simulates
        """
        for physics in SETTINGS:
            config = settings_of(
                task, (newtons, newtons), engine="pybullet", physics=physics, time_limit=self.time_limit
            )
            specs = [EpisodeSpec(parameters, seed, task, config) for seed in range(self.seeds)]
            yield setting(physics), list(workers.simulate_all(specs))


@dataclass(frozen=True)
class Fineness(AtEverySetting):
    """Good sets and poor ones of both tasks, without a push.

    :param sets: number of the sets of each task, from the first
    """

    sets: int = 8

    def rows(self) -> Iterator[Row]:
        """A row for each set and setting."""
        with Workers(self.workers) as workers:
            for task, parameters in ((task, set_) for task, sets in SETS.items() for set_ in sets[: self.sets]):
                finest = None
                for columns, results in self.results(task, parameters, 0.0, workers):
                    yield {
                        "task": task,
                        "parameters": ", ".join(f"{value:g}" for value in parameters),
                        **columns,
                        **compared(results, finest),
                        "steps_per_second": mean(result.steps_per_second for result in results),
                        "sole_clearance_mm": 1000.0 * mean(result.sole_clearance for result in results),
                        "survival": mean(result.survived for result in results),
                    }
                    finest = finest or results


@dataclass(frozen=True)
class FinenessAtSlowGaits(AtEverySetting):
    """Several V1 under pushes; some of them make the robot step slowly.

    :param v1: values of V1
    :param newtons: force of the pushes, in N
    """

    v1: tuple[float, ...] = (0.2, 0.3, 0.4, 0.5, 0.6, 0.7)
    newtons: float = 100.0

    def rows(self) -> Iterator[Row]:
        """A row for each V1 and setting."""
        with Workers(self.workers) as workers:
            for v1 in self.v1:
                finest = None
                for columns, results in self.results("balance", (v1, 0.0, 0.0, 0.0), self.newtons, workers):
                    yield {"V1": f"{v1:g}", **columns, **compared(results, finest)}
                    finest = finest or results


@dataclass(frozen=True, kw_only=True)
class FinenessAnywhere(AtEverySetting):
    """Sets from the whole box of P1 to P5.

    :param sets: number of the sets
    """

    sets: int = 40
    seeds: int = 4

    def rows(self) -> Iterator[Row]:
        """A row for each setting."""
        generator = random.Random(7)
        scores: list[list[float]] = [[] for _ in SETTINGS]
        with Workers(self.workers) as workers:
            for _ in range(self.sets):
                parameters = tuple(generator.uniform(0.0, 2.0) for _ in range(5))
                for column, (_, results) in zip(
                    scores, self.results("stepping", parameters, 0.0, workers), strict=True
                ):
                    column.append(mean(result.score for result in results))
        for physics, column in zip(SETTINGS, scores, strict=True):
            distances = [abs(score - finest) for score, finest in zip(column, scores[0], strict=True)]
            yield {
                **setting(physics),
                "sets": self.sets,
                "mean_score": mean(column),
                "rms_distance": mean(distance**2 for distance in distances) ** 0.5,
                "largest_distance": max(distances),
                "sets_within_0_02": sum(distance < 0.02 for distance in distances),
            }


def setting(physics: PyBulletPhysics) -> Row:
    """Columns of a setting of the physics.

    :param physics: the setting
    """
    return {
        "physics_rate_hz": physics.rate,
        "solver_iterations": physics.solver_iterations,
        "added_plate_inertia_kg_m2": f"{physics.added_plate_inertia:g}",
    }


def compared(results: Sequence[EpisodeResult], finest: Sequence[EpisodeResult] | None) -> Row:
    """Mean score, its distance from the finest setting's, and the standard error of that, from the seeds in pairs.

    :param results: results at a setting
    :param finest: results of the same seeds at the finest, unless this is it
    """
    score = mean(result.score for result in results)
    if finest is None:
        return {"score": score, "difference": None, "difference_error": None}
    fine = mean(result.score for result in finest)
    differences = [one.score - other.score for one, other in zip(results, finest, strict=True)]
    error = stdev(differences) / len(differences) ** 0.5
    return {"score": score, "difference": score / fine - 1.0, "difference_error": error / fine}
