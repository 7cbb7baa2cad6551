"""What the shipped parameters do on bumps and on ground that slips, in both engines."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple, get_args

from experiments.conditions import HIPS, LEARNED
from experiments.maker import ParallelExperiment, survival
from experiments.record import Row
from sarah.episode.evaluation import Evaluation, evaluate
from sarah.episode.push import Push
from sarah.episode.spec import FIRST_EVALUATION_SEED
from sarah.episode.tasks import BALANCE
from sarah.episode.workers import Workers
from sarah.simulation.engines import Engine
from sarah.simulation.physics import PHYSICS
from sarah.simulation.terrain import Terrain

NEWTONS = 75.0
"""Force of the pushes, in N."""


class Case(NamedTuple):
    """A ground, and who meets it.

    :param ground: name of the ground
    :param terrain: the ground
    :param newtons: force of the push, in N; 0 for none
    :param hips: name of V1 to V4
    """

    ground: str
    terrain: Terrain
    newtons: float
    hips: str = "learned"


def bumps(millimetres: float, cell_cm: float = 5.0) -> Terrain:
    """Bumps of one height and distance.

    :param millimetres: their largest height, in mm
    :param cell_cm: distance between neighbouring ones, in cm
    """
    height, cell = millimetres / 1000.0, cell_cm / 100.0
    return Terrain(roughness=(height, height), cell=(cell, cell))


def friction(left: float, right: float) -> Terrain:
    """Friction coefficients under both feet.

    :param left: under the left foot
    :param right: under the right foot
    """
    return Terrain(friction_left=(left, left), friction_right=(right, right))


PLANE, ROUGH, SLIPPERY = "plane", "bumps of 10 mm every 5 cm", "friction 0.25"
GROUNDS = {
    PLANE: Terrain(),
    "bumps of no height": bumps(1e-6),
    "bumps of 5 mm every 5 cm": bumps(5.0),
    ROUGH: bumps(10.0),
    "bumps of 15 mm every 5 cm": bumps(15.0),
    "bumps of 20 mm every 5 cm": bumps(20.0),
    "bumps of 10 mm every 2 cm": bumps(10.0, 2.0),
    "bumps of 10 mm every 10 cm": bumps(10.0, 10.0),
    "friction 0.15": friction(0.15, 0.15),
    SLIPPERY: friction(0.25, 0.25),
    "friction 0.4": friction(0.4, 0.4),
    "friction 1.2": friction(1.2, 1.2),
    "ice under the left foot": friction(0.15, 0.9),
}
"""Grounds by name."""
CASES = [
    *(Case(name, terrain, newtons) for name, terrain in GROUNDS.items() for newtons in (0.0, NEWTONS)),
    *(Case(name, GROUNDS[name], NEWTONS, "V = 0") for name in (PLANE, ROUGH, SLIPPERY)),
]


@dataclass(frozen=True)
class RoughGround(ParallelExperiment):
    """The shipped parameters on bumps and slippery ground, without a push and with one of 75 N.

    :param episodes: number of episodes of a row
    :param reference_episodes: number of pushed episodes on 10 mm and on friction 0.25 at PyBullet's reference physics;
        with 0 there is no such row
    :param time_limit: time limit of an episode, in s; a push comes at 2 to 3 s
    """

    episodes: int = 200
    reference_episodes: int = 12
    time_limit: float = 8.0

    def rows(self) -> Iterator[Row]:
        """A row for each engine, physics and case."""
        engines: tuple[Engine, ...] = get_args(Engine)
        with Workers(self.workers) as workers:
            for engine in engines:
                for case in CASES:
                    yield self._row(case, engine, "standard", self.episodes, workers)
            if self.reference_episodes:
                for case in CASES:
                    if case.ground in (ROUGH, SLIPPERY) and case.newtons:
                        yield self._row(case, "pybullet", "reference", self.reference_episodes, workers)

    def _row(self, case: Case, engine: Engine, physics: str, episodes: int, workers: Workers) -> Row:
        config = BALANCE.config_of(LEARNED.config, physics=PHYSICS[physics], engine=engine, time_limit=self.time_limit)
        push = Push((case.newtons, case.newtons), at_seconds=(2.0, 3.0))
        seeds = range(FIRST_EVALUATION_SEED, FIRST_EVALUATION_SEED + episodes)
        found: Evaluation = evaluate(
            BALANCE, HIPS[case.hips], replace(config, push=push, terrain=case.terrain), seeds, workers
        )
        return {
            "engine": engine,
            "physics": physics,
            "ground": case.ground,
            "push_n": f"{case.newtons:g}",
            "hips": case.hips,
            **survival(found),
            "score": found.mean("score"),
            "steps_per_second": found.mean("steps_per_second"),
            "shifts_by_sensors": found.mean("shifts_by_sensors"),
            "sole_clearance_mm": 1000.0 * found.mean("sole_clearance"),
            "final_distance_cm": 100.0 * found.median("drift"),
        }
