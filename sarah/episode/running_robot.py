"""A robot in its world, with its sensors and its controller: what an episode and an operation have in common."""

from __future__ import annotations

import math
from collections.abc import Sequence

from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import STAND_SECONDS, PatternGenerator, PhaseChange, SteppingParameters
from sarah.control.supervisor import Controller, Supervisor
from sarah.episode.robot_settings import RobotSettings, conditions_of
from sarah.robot.description import describe_robot
from sarah.robot.reading import ACTUATED_JOINTS, GRAVITY, SensorReading, Targets, Vector
from sarah.simulation.build import BuildSimulator, simulator_of
from sarah.simulation.randomisation import Conditions
from sarah.simulation.sensors import ImperfectSensors
from sarah.simulation.simulator import TorsoState
from sarah.simulation.world import HoldsWorld


class Observer:
    """Something that records what a robot does, in each tick at one or both moments of the loop that count."""

    def sensed(self, robot: RunningRobot) -> None:
        """Record what the robot feels; phase and targets are those of the tick before.

        :param robot: robot that runs
        """

    def decided(self, robot: RunningRobot, change: PhaseChange | None, force: Vector | None) -> None:
        """Record what the robot will do: its new targets are set, and nothing has moved yet.

        :param robot: robot that runs
        :param change: end of a phase in this tick
        :param force: force of a push in this tick, in N
        """


class RunningRobot(HoldsWorld):
    """A robot that stands in a new world, and then does what its pattern generator says.

    :param config: settings of robot, world and controller
    :param seed: seed of the conditions
    :param build: function that makes the simulator from robot, physics and conditions; by default that of the
        configuration's engine
    :param conditions: properties of robot and world; by default those that the seed draws
    """

    generator: Controller
    """Source of the joint targets, supervised or not. It has the paper's parameters until it is given others."""
    observers: Sequence[Observer]
    """Records of what it does from the next tick on."""
    termination: str | None
    """Way in which it ended: ``"diverged"``, or what an episode or a window finds; ``None`` while it goes on."""
    torso: TorsoState
    """True state of the torso at the end of the last tick that has not diverged."""

    def __init__(
        self,
        config: RobotSettings,
        seed: int,
        build: BuildSimulator | None = None,
        conditions: Conditions | None = None,
    ) -> None:
        self.config = config
        self.observers = ()
        self.termination = None
        self.description = describe_robot(config.dimensions)
        conditions = conditions or conditions_of(config, seed)
        gravity_x, gravity_y, gravity_z = conditions.ground.gravity
        strength = math.hypot(gravity_x, gravity_y, gravity_z) or GRAVITY
        self.vertical = (-gravity_x / strength, -gravity_y / strength, -gravity_z / strength)
        """Unit vector against gravity, in the world's frame."""
        self.simulation = (build or simulator_of(config.engine))(self.description, config.physics, conditions)
        self.truth = self.last_reading = self.simulation.read()
        self.torso = self.simulation.torso_state()
        dt = config.physics.control_dt
        limits = [self.description.limits[joint] for joint in ACTUATED_JOINTS]
        stepping = SteppingParameters(*PAPER_STEPPING)
        self.generator = (
            Supervisor(stepping, dt=dt, limits=limits, constants=config.controller, settings=config.supervisor)
            if config.supervisor.enabled
            else PatternGenerator(stepping, dt=dt, limits=limits, constants=config.controller)
        )
        self._sensors = ImperfectSensors(conditions.sensors, dt)

    def stand(self) -> SensorReading:
        """Stand for the first second.

        :return: the last reading of that second, which the agent of an episode acts on
        """
        for _ in range(round(STAND_SECONDS / self.config.physics.control_dt)):
            self.tick()
        return self.last_reading

    def tick(self, force: Vector | None = None) -> None:
        """Advance by one control tick: sense, decide and act. Nothing happens once the robot has ended.

        If the simulation diverges, the last finite reading and state stay.

        :param force: force of a push in this tick, in N
        """
        if self.sense():
            change = self.generator.tick(self.last_reading)
            self.act(self.generator.targets, change, force)

    def sense(self) -> bool:
        """Read the sensors.

        :return: whether there is a new :attr:`last_reading`; there is none once the robot has ended
        """
        truth = self.simulation.read()
        if not truth.is_finite:
            self.termination = "diverged"
        if self.termination is not None:
            return False
        self.truth, self.last_reading = truth, self._sensors(truth)
        for observer in self.observers:
            observer.sensed(self)
        return True

    def act(self, targets: Targets, change: PhaseChange | None, force: Vector | None = None) -> None:
        """Move to targets, until the next tick.

        :param targets: joint targets in the order of ``ACTUATED_JOINTS``, in rad and m
        :param change: end of a phase that the controller reported in this tick
        :param force: force of a push in this tick, in N
        """
        simulation = self.simulation
        simulation.set_targets(targets)
        if force is not None:
            simulation.push(force)
        for observer in self.observers:
            observer.decided(self, change, force)
        simulation.advance()
        torso = simulation.torso_state()
        if torso.is_finite:
            self.torso = torso
        else:
            self.termination = "diverged"

    def close(self) -> None:
        """Give the physics engine's resources back."""
        self.simulation.close()
