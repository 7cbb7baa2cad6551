"""How fast is an episode in each engine, at each physics, on each ground?

Every round times the same episode first at the standard physics of PyBullet on the plane, then otherwise. So whatever
else the machine does slows both, and the ratio is the median of the rounds'.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, replace

from pandas import DataFrame

from benchmarks.timing import Timing, spread
from experiments.record import Row
from experiments.tables import shown, table
from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.episode import simulate
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.simulation.engines import Engine
from sarah.simulation.physics import PHYSICS, Physics, PyBulletPhysics
from sarah.simulation.terrain import Terrain

PHYSICS_BY_NAME: dict[str, Physics] = {
    "standard": PHYSICS["standard"],
    "500 Hz, 30 iterations": PyBulletPhysics(500, 30, added_plate_inertia=0.0),
    "reference": PHYSICS["reference"],
}
GROUNDS = {
    "plane": Terrain(),
    "bumps of 10 mm every 5 cm": Terrain(roughness=(0.01, 0.01), cell=(0.05, 0.05)),
    "bumps of 10 mm every 2 cm": Terrain(roughness=(0.01, 0.01), cell=(0.02, 0.02)),
    "bumps of 20 mm every 5 cm": Terrain(roughness=(0.02, 0.02), cell=(0.05, 0.05)),
    "friction 0.25": Terrain(friction_left=(0.25, 0.25), friction_right=(0.25, 0.25)),
}


@dataclass(frozen=True)
class Episodes(Timing):
    """Processor time of episodes with the paper's P1 to P5, from building the world to the result.

    :param rounds: number of episodes, after one that warms up
    :param time_limit: time limit of an episode, in s
    """

    rounds: int = 7
    time_limit: float = 12.0

    def cases(self) -> list[Row]:
        """The engines on each ground, and PyBullet at each other physics."""
        grounds = [(engine, "standard", ground) for engine in ("pybullet", "mujoco") for ground in GROUNDS]
        physics = [("pybullet", name, "plane") for name in PHYSICS_BY_NAME if name != "standard"]
        return [dict(zip(("engine", "physics", "ground"), case, strict=True)) for case in grounds + physics]

    def rows(self, engine: Engine, physics: str, ground: str) -> Iterator[Row]:
        """Speed of an episode, and its time over that at the standard physics of PyBullet on the plane.

        :param engine: physics engine
        :param physics: name of the physics
        :param ground: name of the ground
        """
        usual = EpisodeConfig(engine="pybullet", time_limit=self.time_limit)
        config = replace(usual, engine=engine, physics=PHYSICS_BY_NAME[physics], terrain=GROUNDS[ground])
        seconds = [(self._seconds(config, seed), self._seconds(usual, seed)) for seed in (0, *range(self.rounds))][1:]
        yield {
            "times_real_time": self.rounds / sum(own for own, _ in seconds),
            **spread("time_ratio", [own / other for own, other in seconds]),
        }

    def _seconds(self, config: EpisodeConfig, seed: int) -> float:
        """Processor time per simulated second."""
        spec = EpisodeSpec(PAPER_STEPPING, seed, config=config)
        start = time.process_time()
        simulated = simulate(spec).duration
        return (time.process_time() - start) / simulated


FULL = Episodes()
QUICK = Episodes(rounds=1, time_limit=1.2)


def answer(rows: DataFrame) -> str:
    """How fast an episode is in each engine."""
    plain = rows[(rows.ground == "plane") & (rows.physics == "standard")].set_index("engine").times_real_time
    return (
        f"On one core an episode runs at {shown(plain['pybullet'], '.0f')} times real time in PyBullet, and at "
        f"{shown(plain['mujoco'], '.0f')} times real time in MuJoCo."
    )


def speeds(rows: DataFrame) -> str:
    """Speed of all cases."""
    columns = ["engine", "physics", "ground", "times_real_time", "time_ratio", "time_ratio_low", "time_ratio_high"]
    caption = (
        "Speed of an episode, and its processor time divided by that in PyBullet at the standard physics on the plane: "
        "the median, the smallest and the largest of seven."
    )
    return table(rows, columns, caption, real_time=".0f", time_ratio=".2f")
