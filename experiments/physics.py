"""How fine must the physics be? Scores of parameter sets at several settings, each on the same seeds.

Scores come with their distance from the first setting's, which is the finest, and the standard error of that.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from statistics import mean, stdev

from experiments.maker import ParallelExperiment
from experiments.record import Row
from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.push import Push
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.episode.workers import Workers
from sarah.simulation.engines import Engine
from sarah.simulation.physics import PyBulletPhysics
from sarah.simulation.randomisation import Randomisation

STANDARD = PyBulletPhysics()
RANDOM = Randomisation()
SETTINGS: dict[str, tuple[Engine, PyBulletPhysics]] = {
    "reference": ("pybullet", PyBulletPhysics(1000, 100, added_plate_inertia=0.0)),
    "500 Hz x 30": ("pybullet", PyBulletPhysics(500, 30, added_plate_inertia=0.0)),
    "no added inertia": ("pybullet", replace(STANDARD, added_plate_inertia=0.0)),
    "standard": ("pybullet", STANDARD),
    "mujoco": ("mujoco", STANDARD),
}
"""Engine and physics by name: the finest, a coarser one, the standard without and with its added inertia, MuJoCo's."""
NO_HIPS = (0.0, 0.0, 0.0, 0.0)
LOW_P1 = (0.02, 0.05, 0.55, 1.8, 1.3)
"""P1 to P5 that NAF learned in one training, with a P1 near zero."""


def parameter_sets() -> dict[str, tuple[tuple[float, ...], tuple[float, ...]]]:
    """P1 to P5 and V1 to V4 that score well, by name."""
    shipped = PARAMETER_SETS["balance"].spec
    assert isinstance(shipped.config, BalanceConfig)
    return {
        "paper, V = 0": (PAPER_STEPPING, NO_HIPS),
        "shipped, V = 0": (shipped.config.stepping, NO_HIPS),
        "low P1, V = 0": (LOW_P1, NO_HIPS),
        "paper, V1 = V3 = 1": (PAPER_STEPPING, (1.0, 0.0, 1.0, 0.0)),
        "shipped": (shipped.config.stepping, shipped.parameters),
        "low P1, V1 = V3 = 1": (LOW_P1, (1.0, 0.0, 1.0, 0.0)),
    }


@dataclass(frozen=True, kw_only=True)
class AtEverySetting(ParallelExperiment):
    """What the experiments below share.

    :param seeds: number of episodes of each set at each setting, at least 2
    :param time_limit: time limit of an episode, in s
    """

    seeds: int = 8
    time_limit: float = 10.0

    def results(
        self,
        stepping: tuple[float, ...],
        balance: tuple[float, ...],
        workers: Workers,
        control_rate: int = 100,
        randomisation: Randomisation = RANDOM,
    ) -> Iterator[tuple[str, list[EpisodeResult]]]:
        """Each setting's name, and the results of a parameter set there, without a push.

        :param stepping: values of P1 to P5
        :param balance: values of V1 to V4
        :param workers: who simulates
        :param control_rate: control ticks per second
        :param randomisation: ranges that the seeds draw from
        """
        for name, (engine, physics) in SETTINGS.items():
            config = BalanceConfig(
                physics.at_control_rate(control_rate),
                engine,
                randomisation=randomisation,
                time_limit=self.time_limit,
                stepping=stepping,  # type: ignore[arg-type]
                push=Push(newtons=(0.0, 0.0)),
            )
            seeds = self.seeds if randomisation.enabled else 1  # without randomisation, all episodes are the same
            specs = [EpisodeSpec(balance, seed, BALANCE, config) for seed in range(seeds)]
            yield name, list(workers.simulate_all(specs))


@dataclass(frozen=True)
class FinenessInConditions(AtEverySetting):
    """Good sets at two control rates, with delays, and as designed: without noise, errors and delay.

    :param sets: number of the sets, from the first
    :param control_rates: control ticks per second
    :param delays: delays from sensing to acting, in s
    """

    sets: int = 6
    control_rates: tuple[int, ...] = (100, 200)
    delays: tuple[float, ...] = (0.0, 0.010, 0.020)

    def rows(self) -> Iterator[Row]:
        """A row for each set, condition and setting."""
        conditions = {f"{1000 * delay:g} ms": Randomisation(delay_seconds=delay) for delay in self.delays}
        conditions["as designed"] = Randomisation(enabled=False)
        with Workers(self.workers) as workers:
            for name, (stepping, balance) in list(parameter_sets().items())[: self.sets]:
                for control_rate in self.control_rates:
                    for condition, randomisation in conditions.items():
                        finest = None
                        for setting, results in self.results(stepping, balance, workers, control_rate, randomisation):
                            yield {
                                "parameters": name,
                                "control_rate_hz": control_rate,
                                "sensors": condition,
                                "setting": setting,
                                **compared(results, finest),
                                "steps_per_second": mean(result.steps_per_second for result in results),
                                "shifts_timed_out": 1.0 - mean(result.shifts_by_sensors for result in results),
                                "sole_clearance_mm": 1000.0 * mean(result.sole_clearance for result in results),
                            }
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
        scores: dict[str, list[float]] = {name: [] for name in SETTINGS}
        with Workers(self.workers) as workers:
            for _ in range(self.sets):
                parameters = tuple(generator.uniform(0.0, 2.0) for _ in range(5))
                for name, results in self.results(parameters, NO_HIPS, workers):
                    scores[name].append(mean(result.score for result in results))
        finest = next(iter(scores.values()))
        for name, column in scores.items():
            distances = [abs(score - fine) for score, fine in zip(column, finest, strict=True)]
            yield {
                "setting": name,
                "sets": self.sets,
                "mean_score": mean(column),
                "rms_distance": mean(distance**2 for distance in distances) ** 0.5,
                "largest_distance": max(distances),
                "sets_within_0_02": sum(distance < 0.02 for distance in distances),
            }


def compared(results: Sequence[EpisodeResult], finest: Sequence[EpisodeResult] | None) -> Row:
    """Mean score, its distance from the finest setting's, and the standard error of that, from the seeds in pairs.

    A single seed has no error.

    :param results: results at a setting
    :param finest: results of the same seeds at the finest, unless this is it
    """
    score = mean(result.score for result in results)
    if finest is None:
        return {"score": score, "difference": None, "difference_error": None}
    fine = mean(result.score for result in finest)
    differences = [one.score - other.score for one, other in zip(results, finest, strict=True)]
    error = stdev(differences) / len(differences) ** 0.5 / fine if len(differences) > 1 else None
    return {"score": score, "difference": score / fine - 1.0, "difference_error": error}
