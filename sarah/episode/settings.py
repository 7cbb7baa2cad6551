"""Settings that the episodes of every task have."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import Annotated, Any, Literal, TypeVar, get_args

from sarah.control.constants import STANDARD_CONSTANTS, ControllerConstants
from sarah.control.pattern_generator import STAND_SECONDS
from sarah.errors import ConfigurationError, check_types, unknown_name
from sarah.number import is_number, plain
from sarah.ranges import Within, check_ranges, ranges_of
from sarah.robot.dimensions import check_dimensions, scale_of, unscaled_dimensions
from sarah.robot.scale import Scale, Sized
from sarah.simulation.engines import Engine, default_engine
from sarah.simulation.physics import PHYSICS, Physics, physics_for
from sarah.simulation.randomisation import Randomisation
from sarah.simulation.terrain import Terrain

RewardForm = Literal["symmetric", "printed"]
HALF_WIDTH = 0.5
"""Displacement of the default robot from its start at which the reward is zero, in m."""
STEP_FREQUENCY = 3.0
"""Rewarded number of steps per second; both are the paper's."""
LONGEST_EPISODE = 3600.0
"""Longest time limit of an episode, in s."""
BOX_HALF_WIDTH = 0.25
"""Displacement of the default robot's torso along any axis at which an episode ends, in m; it is the paper's."""
LEAST_CLEARANCE = 0.010
"""Sole clearance of the default robot below which a gait is a shuffle, in m."""
OF_DEFAULT_ROBOT: dict[str, Any] = {
    "controller": STANDARD_CONSTANTS,
    "randomisation": Randomisation(),
    "terrain": Terrain(),
    "reward_half_width": HALF_WIDTH,
    "box_half_width": BOX_HALF_WIDTH,
    "least_clearance": LEAST_CLEARANCE,
}
"""Defaults of the settings that go with the length and the mass of the robot."""
WRITTEN_BEFORE = {"physics", "engine", "randomisation", "terrain", "controller", "payload", "time_limit", "reward_form"}
"""All that versions wrote down, beside dimensions, in which nothing went with a robot's size."""
WRITTEN_SINCE = {"step_frequency", "reward_half_width", "box_half_width", "least_clearance"}
"""What files have that were written since."""
ConfigType = TypeVar("ConfigType", bound="EpisodeConfig")
SettingsType = TypeVar("SettingsType")


@dataclass(frozen=True)
class EpisodeConfig:
    """Settings that all episodes of an experiment share, whatever the task.

    What goes with the length and the mass of a robot is by default that of the default robot, scaled
    (:mod:`sarah.robot.scale`); what is given is taken as it is.

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
    :param step_frequency: rewarded number of steps per second; the paper's is 3
    :param reward_half_width: displacement from the start at which the reward is zero, in m; the paper's is 0.5
    :param box_half_width: displacement along any axis at which an episode ends, in m; the paper's second criterion
    :param least_clearance: sole clearance below which a gait is a shuffle, and not valid, in m
    """

    physics: Physics = None  # type: ignore[assignment]  # as are others, of the robot's size
    engine: Engine = field(default_factory=default_engine)
    randomisation: Randomisation = None  # type: ignore[assignment]
    terrain: Terrain = None  # type: ignore[assignment]
    controller: ControllerConstants = None  # type: ignore[assignment]
    payload: Annotated[float, Sized(0.0, 100.0, "kg")] = 0.0
    dimensions: Mapping[str, float] = field(default_factory=dict)
    time_limit: Annotated[float, Within(STAND_SECONDS, LONGEST_EPISODE, "s")] = 30.0
    reward_form: RewardForm = "symmetric"
    step_frequency: Annotated[float, Within(0.1, 100.0, "per second")] = STEP_FREQUENCY
    reward_half_width: Annotated[float, Sized(0.001, 100.0, "m")] = None  # type: ignore[assignment]
    box_half_width: Annotated[float, Sized(0.001, 100.0, "m")] = None  # type: ignore[assignment]
    least_clearance: Annotated[float, Sized(0.0, 1.0, "m")] = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        """Refuse settings that cannot be simulated."""
        check_types(self, dimensions=Mapping)
        dimensions = check_dimensions(self.dimensions) if self.dimensions else {}
        object.__setattr__(self, "dimensions", dimensions)  # whatever becomes of the mapping that was given
        self._complete()
        check_types(self, physics=Physics, randomisation=Randomisation, terrain=Terrain, controller=ControllerConstants)
        for name, allowed in (("engine", get_args(Engine)), ("reward_form", get_args(RewardForm))):
            given = plain(getattr(self, name))
            if given not in allowed:
                raise ConfigurationError(unknown_name(name, str(given), allowed))
            object.__setattr__(self, name, given)
        object.__setattr__(self, "physics", physics_for(self.engine, self.physics, self.scale))
        check_ranges("", self)
        if self.time_limit < STAND_SECONDS + self.physics.control_dt:
            raise ConfigurationError(
                f"time_limit must be above the {STAND_SECONDS:g} s of standing, not {self.time_limit!r}"
            )

    def _complete(self) -> None:
        """Set what was not given to that of the robot's size."""
        for name, default in OF_DEFAULT_ROBOT.items():
            if getattr(self, name) is None:
                within = ranges_of(type(self)).get(name)
                own = default * self.scale.factor(within.unit) if within else self.scale.scaled(default)
                object.__setattr__(self, name, own)
        if self.physics is None:
            object.__setattr__(self, "physics", PHYSICS["standard"].at_scale(self.scale))

    @property
    def scale(self) -> Scale:
        """Size of the robot as ratios to that of the default robot."""
        return scale_of(self.dimensions)

    def for_robot(self: ConfigType, dimensions: Mapping[str, float], usual: EpisodeConfig | None = None) -> ConfigType:
        """Settings for a robot of other dimensions: what goes with length and mass follows, by the ratio of both.

        :param dimensions: dimensions of the robot that differ from their defaults
        :param usual: settings from which those that were set by hand differ: they stay; by default all settings follow
        """
        dimensions, usual = check_dimensions(dimensions), usual or self
        before, after = (usual._at(scale_of(robot), self.engine) for robot in (self.dimensions, dimensions))
        if (control_rate := self.physics.control_rate) != before.physics.control_rate:  # set by hand
            before, after = (one._with_control_rate(control_rate) for one in (before, after))
        return replace(_following(self, before, after), dimensions=dimensions)

    def _at(self, scale: Scale, engine: Engine) -> EpisodeConfig:
        """These settings for a robot of a size, in an engine."""
        ratio = scale.over(self.scale)
        physics = physics_for(engine, self.physics, self.scale).at_scale(ratio)
        return replace(ratio.scaled(self), engine=engine, physics=physics)

    def _with_control_rate(self, control_rate: int) -> EpisodeConfig:
        return replace(self, physics=self.physics.at_control_rate(control_rate))

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
