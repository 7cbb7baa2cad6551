"""A robot in its world, with its sensors and its controller: what an episode and an operation have in common."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import STAND_SECONDS, PatternGenerator, SteppingParameters
from sarah.episode.settings import EpisodeConfig
from sarah.robot.description import ANKLE_JOINTS, describe_robot
from sarah.robot.dimensions import all_dimensions
from sarah.robot.reading import ACTUATED_JOINTS, GRAVITY, SensorReading, Vector
from sarah.simulation.build import BuildSimulator, simulator_of
from sarah.simulation.randomisation import Conditions, draw_conditions
from sarah.simulation.sensors import ImperfectSensors
from sarah.simulation.terrain import draw_ground
from sarah.simulation.world import HoldsWorld


class RunningRobot(HoldsWorld):
    """A robot that stands in a new world, and then does what its pattern generator says.

    :param config: settings of robot, world and controller
    :param seed: seed of the conditions
    :param build: function that makes the simulator from robot, physics and conditions; by default that of the
        configuration's engine
    :param conditions: properties of robot and world; by default those that :func:`conditions_of` draws from the seed
    """

    generator: PatternGenerator
    """Source of the joint targets. It has the paper's parameters until it is given others."""
    termination: str | None
    """Way in which it ended: ``"diverged"``, or what a subclass finds; ``None`` while it goes on."""

    def __init__(
        self,
        config: EpisodeConfig,
        seed: int,
        build: BuildSimulator | None = None,
        conditions: Conditions | None = None,
    ) -> None:
        self.config = config
        self.termination = None
        self.robot = describe_robot(config.dimensions)
        conditions = conditions or conditions_of(config, seed)
        gravity_x, gravity_y, gravity_z = conditions.ground.gravity
        strength = math.hypot(gravity_x, gravity_y, gravity_z) or GRAVITY
        self.vertical = (-gravity_x / strength, -gravity_y / strength, -gravity_z / strength)
        """Unit vector against gravity, in the world's frame."""
        self.simulation = (build or simulator_of(config.engine))(self.robot, config.physics, conditions)
        self.truth = self.last_reading = self.simulation.read()
        self._dt = config.physics.control_dt
        limits = [self.robot.limits[joint] for joint in ACTUATED_JOINTS]
        stepping = SteppingParameters(*PAPER_STEPPING)
        self.generator = PatternGenerator(stepping, dt=self._dt, limits=limits, constants=config.controller)
        self._sensors = ImperfectSensors(conditions.sensors, self._dt)

    def stand(self) -> SensorReading:
        """Stand for the first second.

        :return: the last reading of that second, which the agent of an episode acts on
        """
        for _ in range(round(STAND_SECONDS / self._dt)):
            self.generator.tick(self.sense())
            self.simulation.advance()
        return self.last_reading

    def sense(self) -> SensorReading:
        """Read the sensors; if the simulation has diverged, the last finite reading stays."""
        truth = self.simulation.read()
        if truth.is_finite:
            self.truth, self.last_reading = truth, self._sensors(truth)
        else:
            self.termination = "diverged"
        return self.last_reading

    def trace_row(self, time: float, push: Vector | None, steps_per_second: float, score: float) -> dict[str, Any]:
        """Row of a :class:`~sarah.episode.trace.Trace`, of a tick in which the targets are set.

        :param time: simulated time, in s
        :param push: force of a push in this tick, in N
        :param steps_per_second: steps per second in the last 2 s, at the end of the tick
        :param score: score so far
        """
        generator, reading, torso = self.generator, self.last_reading, self.simulation.torso_state()
        return {
            "time": time,
            "position": torso.position,
            "orientation": torso.orientation,
            "joints": self.truth.joints,
            "ankles": self.simulation.joint_positions(ANKLE_JOINTS),
            "targets": generator.targets,
            "pressures": reading.pressures,
            "acceleration": reading.acceleration,
            "angular_rate": reading.angular_rate,
            "phase": generator.phase.value,
            "stance": generator.stance.value,
            "stable_x": generator.stable_x,
            "tilt": generator.tilt,
            "rate": generator.rate,
            "steps_per_second": steps_per_second,
            "push": push or (0.0, 0.0, 0.0),
            "score": score,
        }

    def close(self) -> None:
        """Give the physics engine's resources back."""
        self.simulation.close()


def conditions_of(config: EpisodeConfig, seed: int) -> Conditions:
    """Draw an episode's robot and world.

    :param config: settings of the episode
    :param seed: seed of the episode
    """
    drawn = draw_conditions(config.randomisation, seed)
    ground = draw_ground(config.terrain, seed)
    if not config.payload:
        return dataclasses.replace(drawn, ground=ground)
    torso = all_dimensions(config.dimensions)["torso_mass"]
    loaded = drawn.mass_factors["torso"] + config.payload / torso
    return dataclasses.replace(drawn, ground=ground, mass_factors={**drawn.mass_factors, "torso": loaded})
