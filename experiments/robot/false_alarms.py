"""Does a supervisor stop robots of which nothing fails?

Robots with the shipped parameters are pushed, or stand on difficult ground, or have weak servos or late sensors. A
supervised robot moves as one without a supervisor until it is stopped, so only robots that are stopped are simulated
again without it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from pandas import DataFrame

from experiments.experiment import Experiment, product
from experiments.record import Row
from experiments.robot.conditions import SHIPPED
from experiments.robot.other_sizes import LEGS, ROBOTS
from experiments.tables import table
from sarah.control.supervisor import State, Supervisor
from sarah.episode.episode import Episode, simulate
from sarah.episode.push import NO_PUSH, Push
from sarah.episode.spec import FIRST_EVALUATION_SEED, EpisodeSpec
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.robot.dimensions import dimensions_alike
from sarah.robot.scale import MASS
from sarah.simulation.engines import Engine
from sarah.simulation.randomisation import Randomisation
from sarah.simulation.terrain import Terrain

TIME_LIMIT = 10.0
"""Time limit of the episodes, in s."""
PUSHES = Push((0.0, 100.0))
SITUATIONS: Mapping[str, dict[str, Any]] = {
    "pushes to 100 N": {"push": PUSHES},
    "pushes of 125 N": {"push": Push(125.0)},
    "slope of 6°": {"terrain": Terrain((6.0, 6.0))},
    "bumps of 10 mm": {"terrain": Terrain(roughness=(0.01, 0.01))},
    "servos of 12 per second": {"randomisation": Randomisation(actuator_bandwidth=(12.0, 12.0))},
    "delay of 50 ms": {"randomisation": Randomisation(delay_seconds=0.05)},
    **{robot: {"push": PUSHES} for robot in ROBOTS},
}
"""What the robots meet, by name, as settings that differ from those of level ground without a push."""


def settings_in(situation: str, engine: Engine) -> BalanceConfig:
    """Settings of the episodes in a situation; what goes with the robot's size follows it."""
    changes = {"push": NO_PUSH, **SITUATIONS[situation]}
    config = BALANCE.config_of(SHIPPED.config, engine=engine, time_limit=TIME_LIMIT, **changes)
    if situation in ROBOTS:
        mass, leg_length, _ = ROBOTS[situation]
        config = config.for_robot(dimensions_alike(leg_length / LEGS, mass / MASS))
    return config


@dataclass(frozen=True)
class FalseAlarms(Experiment):
    """Robots of which nothing fails, with a supervisor."""

    episodes: int = 200  # number of robots in each situation and engine

    def cases(self) -> list[Row]:
        """Each situation in each engine."""
        return product(situation=SITUATIONS, engine=("pybullet", "mujoco"))

    def rows(self, situation: str, engine: Engine) -> Iterator[Row]:
        """How many robots survive without and with the supervisor, and how many survivors it would have stopped."""
        config = settings_in(situation, engine)
        without = supervised = stopped = 0
        for seed in range(FIRST_EVALUATION_SEED, FIRST_EVALUATION_SEED + self.episodes):
            spec = EpisodeSpec(SHIPPED.parameters, seed, BALANCE, config)
            survived, is_stopped = _supervised(spec)
            survives_alone = simulate(spec).survived if is_stopped else survived
            without += survives_alone
            supervised += survived
            stopped += is_stopped and survives_alone
        yield {"episodes": self.episodes, "survivors": without, "survivors_supervised": supervised, "stopped": stopped}


def _supervised(spec: EpisodeSpec) -> tuple[bool, bool]:
    """Whether a supervised robot survives, and whether it is stopped."""
    supervisor = replace(spec.config.supervisor, enabled=True)
    with Episode(replace(spec.config, supervisor=supervisor), spec.seed, spec.task) as episode:
        episode.stand()
        result = episode.run(spec.parameters)
        generator = episode.robot.generator
    assert isinstance(generator, Supervisor)
    return result.survived, generator.state is not State.STEPPING


FULL = FalseAlarms()
QUICK = FalseAlarms(episodes=1)


def alarms(rows: DataFrame) -> str:
    """Robots that a supervisor stops although nothing fails."""
    caption = (
        f"How many of {FULL.episodes} robots with the shipped parameters survive {TIME_LIMIT:g} s, without a "
        f"supervisor and with one, and how many of the survivors it would have stopped."
    )
    columns = ["situation", "engine", "survivors", "survivors_supervised", "stopped"]
    return table(rows, columns, caption)
