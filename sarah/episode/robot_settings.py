"""Settings of a robot and its world, and one episode's draw of them."""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import Annotated, Any, TypeVar

from sarah.control.constants import ControllerConstants
from sarah.control.pattern_generator import STAND_SECONDS
from sarah.control.supervisor_settings import SupervisorSettings
from sarah.errors import ConfigurationError, check_type
from sarah.number import is_number, plain
from sarah.ranges import Within, check_ranges, ranges_of, types_of
from sarah.robot.dimensions import all_dimensions, check_dimensions, scale_of, unscaled_dimensions
from sarah.robot.scale import Scale, Sized
from sarah.simulation.engines import Engine, default_engine
from sarah.simulation.physics import PHYSICS, Physics, physics_for
from sarah.simulation.randomisation import Conditions, Randomisation, draw_conditions
from sarah.simulation.terrain import Terrain, draw_ground

LONGEST_EPISODE = 3600.0
"""Longest time limit of an episode, in s."""
WRITTEN_BEFORE = {"physics", "engine", "randomisation", "terrain", "controller", "payload", "time_limit", "reward_form"}
"""All that versions wrote down, beside dimensions, in which nothing went with a robot's size."""
WRITTEN_SINCE = {"step_frequency", "reward_half_width", "box_half_width", "least_clearance"}
"""What files have that were written since."""
ConfigType = TypeVar("ConfigType", bound="RobotSettings")
SettingsType = TypeVar("SettingsType")


@dataclass(frozen=True)
class RobotSettings:
    """Settings of a robot and its world, and of how long an episode is.

    What depends on the length and the mass of a robot is by default that of the default robot, scaled
    (:mod:`sarah.robot.scale`). What is given is taken as it is.

    :param physics: resolution of the physics in time; in files and in Python, fields that the engine does not have are
        ignored
    :param engine: physics engine: ``pybullet``, the reference, or ``mujoco``, the default where PyBullet is not
        installed
    :param randomisation: ranges that each episode's seed draws from
    :param terrain: ground, drawn from each episode's seed as well
    :param controller: constants of the pattern generator and the hip law
    :param supervisor: settings that decide when the robot stops by itself because something fails
    :param payload: extra mass in the torso, in kg, distributed like the torso's own mass
    :param dimensions: dimensions of the robot that differ from their defaults: values by name in SI units, such as
        hinge_height 0.04
    :param time_limit: time limit of an episode, in s; the paper's first criterion
    """

    physics: Physics = None  # type: ignore[assignment]  # as are others, of the robot's size
    engine: Engine = field(default_factory=default_engine)
    randomisation: Randomisation = None  # type: ignore[assignment]
    terrain: Terrain = None  # type: ignore[assignment]
    controller: ControllerConstants = None  # type: ignore[assignment]
    supervisor: SupervisorSettings = None  # type: ignore[assignment]
    payload: Annotated[float, Sized(0.0, 100.0, "kg")] = 0.0
    dimensions: Mapping[str, float] = field(default_factory=dict)
    time_limit: Annotated[float, Within(STAND_SECONDS, LONGEST_EPISODE, "s")] = 30.0

    def __post_init__(self) -> None:
        """Refuse settings that cannot be simulated."""
        check_type("dimensions", self.dimensions, Mapping)
        dimensions = check_dimensions(self.dimensions) if self.dimensions else {}
        object.__setattr__(self, "dimensions", dimensions)  # whatever becomes of the mapping that was given
        scale, ranges = self.scale, ranges_of(type(self))
        if self.physics is None:
            object.__setattr__(self, "physics", PHYSICS["standard"].at_scale(scale))
        for name, kind in types_of(type(self)).items():  # what was not given is that of the robot's size
            sized = ranges.get(name)
            if getattr(self, name) is None and isinstance(kind, type) and is_dataclass(kind):
                object.__setattr__(self, name, scale.scaled(kind()))
            elif getattr(self, name) is None and isinstance(sized, Sized) and sized.usual is not None:
                object.__setattr__(self, name, sized.usual * scale.factor(sized.unit))
        check_ranges("", self)
        object.__setattr__(self, "physics", physics_for(self.engine, self.physics, scale))
        if self.time_limit < STAND_SECONDS + self.physics.control_dt:
            raise ConfigurationError(
                f"time_limit must be above the {STAND_SECONDS:g} s of standing, not {self.time_limit!r}"
            )

    @property
    def scale(self) -> Scale:
        """Size of the robot as ratios to that of the default robot."""
        return scale_of(self.dimensions)

    def for_robot(self: ConfigType, dimensions: Mapping[str, float], usual: RobotSettings | None = None) -> ConfigType:
        """Settings for a robot of other dimensions: what goes with length and mass follows, by the ratio of both.

        :param dimensions: dimensions of the robot that differ from their defaults
        :param usual: settings from which those that were set by hand differ: they stay; by default all settings follow
        """
        dimensions, usual = check_dimensions(dimensions), usual or self
        before, after = (usual._at(scale_of(robot), self.engine) for robot in (self.dimensions, dimensions))
        if (control_rate := self.physics.control_rate) != before.physics.control_rate:  # set by hand
            before, after = (replace(one, physics=one.physics.at_control_rate(control_rate)) for one in (before, after))
        return replace(_following(self, before, after), dimensions=dimensions)

    def _at(self, scale: Scale, engine: Engine) -> RobotSettings:
        """These settings for a robot of a size, in an engine."""
        ratio = scale.over(self.scale)
        physics = physics_for(engine, self.physics, self.scale).at_scale(ratio)
        return replace(ratio.scaled(self), engine=engine, physics=physics)

    def check_for_training(self) -> None:
        """Refuse settings with which there is nothing to learn.

        :raises ConfigurationError: naming the setting
        """

    def dependent_defaults(self, content: Mapping[str, Any]) -> dict[str, Any]:
        """Values of fields that depend on other fields: the physics on its engine, and much on the robot's size.

        Where a version that knew no sizes wrote all of its settings down, its robot has what it was simulated with.

        :param content: new values of some fields, as a file gives them
        """
        given, robot = content.get("dimensions"), self
        if isinstance(given, Mapping) and all(is_number(plain(value)) for value in given.values()):
            dimensions = {**self.dimensions, **given}
            if content.keys() >= WRITTEN_BEFORE and WRITTEN_SINCE.isdisjoint(content):
                robot = replace(self, dimensions=unscaled_dimensions(dimensions))
            else:
                robot = self.for_robot(dimensions)
        dependent = {name: value for name, value in vars(robot).items() if value != getattr(self, name)}
        return {**dependent, "physics": physics_for(content.get("engine", self.engine), robot.physics, robot.scale)}


def _following(config: SettingsType, before: Any, after: Any) -> SettingsType:
    """Settings that take the values of others wherever they had those from before."""
    values = {}
    for item in fields(config):  # type: ignore[arg-type]  # a dataclass
        if hasattr(before, item.name):
            value, was, becomes = (getattr(settings, item.name) for settings in (config, before, after))
            if is_dataclass(value) and type(value) is type(was):
                values[item.name] = _following(value, was, becomes)
            else:
                values[item.name] = becomes if value == was else value
    return replace(config, **values)  # type: ignore[type-var]  # a dataclass


def conditions_of(config: RobotSettings, seed: int) -> Conditions:
    """Draw an episode's robot and world.

    :param config: settings of the episode
    :param seed: seed of the episode
    """
    drawn = draw_conditions(config.randomisation, seed)
    ground = draw_ground(config.terrain, seed)
    if not config.payload:
        return replace(drawn, ground=ground)
    torso = all_dimensions(config.dimensions)["torso_mass"]
    loaded = drawn.mass_factors["torso"] + config.payload / torso
    return replace(drawn, ground=ground, mass_factors={**drawn.mass_factors, "torso": loaded})


def conditions_put_up(config: RobotSettings, seed: int, times: int) -> Conditions:
    """Draw robot and world of one that is set upright again and again: only the noise of its sensors is new each time.

    :param config: settings of robot and world
    :param seed: seed of both
    :param times: number of times that it was set upright before
    """
    conditions = conditions_of(config, seed)
    noise = random.Random(f"noise {seed} {times}").getrandbits(64)
    return replace(conditions, sensors=replace(conditions.sensors, seed=noise))
