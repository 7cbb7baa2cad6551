"""Settings that the episodes of every task have."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, get_args

from sarah.control.constants import ControllerConstants
from sarah.control.pattern_generator import STAND_SECONDS
from sarah.episode.reward import RewardForm
from sarah.errors import ConfigurationError, check_range, check_types, unknown_name
from sarah.number import plain
from sarah.robot.description import check_dimensions
from sarah.simulation.engines import Engine, default_engine
from sarah.simulation.physics import PHYSICS, Physics, physics_for
from sarah.simulation.randomisation import Randomisation
from sarah.simulation.terrain import Terrain

LONGEST_EPISODE = 3600.0
"""Longest time limit of an episode, in s."""
PLAUSIBLE = {"payload": (0.0, 100.0, "kg"), "time_limit": (STAND_SECONDS, LONGEST_EPISODE, "s")}
"""Lowest value, highest value and unit of each setting that is a number."""


@dataclass(frozen=True)
class EpisodeConfig:
    """Settings that all episodes of an experiment share, whatever the task.

    :param physics: resolution of the physics in time; fields that the engine does not have are ignored
    :param engine: physics engine: ``pybullet``, the reference, or ``mujoco``, the default where PyBullet is not
        installed
    :param randomisation: ranges that each episode's seed draws from
    :param terrain: ground, drawn from each episode's seed as well
    :param controller: constants of the pattern generator and the hip law
    :param payload: mass of what the torso carries, in kg, spread over it as its own mass is
    :param dimensions: dimensions of the robot that differ from their defaults: values by name in SI units, such as
        hinge_height 0.04
    :param time_limit: time limit of an episode, in s; the paper's first criterion
    :param reward_form: form of the reward, the paper's equation 2: ``symmetric``, or ``printed`` for the equation to
        the letter
    """

    physics: Physics = PHYSICS["standard"]
    engine: Engine = field(default_factory=default_engine)
    randomisation: Randomisation = Randomisation()
    terrain: Terrain = Terrain()
    controller: ControllerConstants = ControllerConstants()
    payload: float = 0.0
    dimensions: Mapping[str, float] = field(default_factory=dict)
    time_limit: float = 30.0
    reward_form: RewardForm = "symmetric"

    def __post_init__(self) -> None:
        """Refuse settings that cannot be simulated."""
        check_types(self, physics=Physics, randomisation=Randomisation, terrain=Terrain)
        check_types(self, controller=ControllerConstants, dimensions=Mapping)
        dimensions = check_dimensions(self.dimensions) if self.dimensions else {}
        object.__setattr__(self, "dimensions", dimensions)  # whatever becomes of the mapping that was given
        for name, allowed in (("engine", get_args(Engine)), ("reward_form", get_args(RewardForm))):
            given = plain(getattr(self, name))
            if given not in allowed:
                raise ConfigurationError(unknown_name(name, str(given), allowed))
            object.__setattr__(self, name, given)
        object.__setattr__(self, "physics", physics_for(self.engine, self.physics))
        for name, (low, high, unit) in PLAUSIBLE.items():
            object.__setattr__(self, name, float(check_range(name, getattr(self, name), low, high, unit)))
        if self.time_limit < STAND_SECONDS + self.physics.control_dt:
            raise ConfigurationError(
                f"time_limit must be above the {STAND_SECONDS:g} s of standing, not {self.time_limit!r}"
            )

    def check_for_training(self) -> None:
        """Refuse settings with which there is nothing to learn.

        :raises ConfigurationError: naming the setting
        """

    def dependent_defaults(self, content: Mapping[str, Any]) -> dict[str, Any]:
        """Values of fields that depend on other fields: the physics, on its engine.

        :param content: new values of some fields, as a file gives them
        """
        return {"physics": physics_for(content.get("engine", self.engine), self.physics)}
