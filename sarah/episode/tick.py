"""A control tick as the reward and the endings of a task see it."""

from __future__ import annotations

import math
from typing import NamedTuple

from sarah.control.pattern_generator import Phase
from sarah.robot.reading import SensorReading, Side, Vector
from sarah.simulation.simulator import Simulator, TorsoState


class Tick(NamedTuple):
    """Everything that is known at the end of a control tick.

    Frames: x to the robot's right, y forward, z up, along the ground's normal. Actuators have the order of
    ``ACTUATED_JOINTS``.

    :param time: simulated time, in s
    :param start: position of the torso's centre when the episode began, in m
    :param torso: true state of the torso
    :param steps: number of completed steps
    :param steps_per_second: frequency f of the steps over the last 2 s, in 1/s
    :param phase: phase of the pattern generator
    :param stance: side of the leg that stands
    :param truth: true sensor signals at the beginning of the tick
    :param reading: the same signals as the robot got them, with noise and delay
    :param simulator: simulator, for what the properties below do not give
    :param vertical: unit vector against gravity; (0, 0, 1) on level ground
    """

    time: float
    start: Vector
    torso: TorsoState
    steps: int
    steps_per_second: float
    phase: Phase
    stance: Side
    truth: SensorReading
    reading: SensorReading
    simulator: Simulator
    vertical: Vector = (0.0, 0.0, 1.0)

    @property
    def x(self) -> float:
        """Displacement of the torso from its start to the right, in m: c_x of equation 2."""
        return self.torso.position[0] - self.start[0]

    @property
    def y(self) -> float:
        """Displacement of the torso from its start forward, in m: c_y of equation 2."""
        return self.torso.position[1] - self.start[1]

    @property
    def height(self) -> float:
        """Height of the torso's centre over the floor, in m: c_z of equation 2."""
        return self.torso.position[2]

    @property
    def velocity(self) -> Vector:
        """Velocity of the torso's centre, in m/s."""
        return self.torso.velocity

    @property
    def tilt(self) -> float:
        """Angle between the torso's axis and gravity's vertical, in rad."""
        return math.acos(max(-1.0, min(1.0, self.upright)))

    @property
    def upright(self) -> float:
        """Cosine of the angle between the torso's axis and gravity's vertical."""
        return self.torso.upright(self.vertical)

    @property
    def pads(self) -> tuple[float, float, float, float]:
        """True forces on the four pads at the beginning of the tick, in N, left before right, forefoot first."""
        return self.truth.pressures

    @property
    def joint_speeds(self) -> tuple[float, ...]:
        """Speeds of the actuators, in rad/s and m/s."""
        return self.simulator.actuator_motion()[0]

    @property
    def efforts(self) -> tuple[float, ...]:
        """Efforts of the actuators, in Nm and N."""
        return self.simulator.actuator_motion()[1]

    @property
    def power(self) -> float:
        """Mechanical power of the six actuators, in W, with braking counted like driving."""
        speeds, efforts = self.simulator.actuator_motion()
        return sum(abs(speed * effort) for speed, effort in zip(speeds, efforts, strict=True))
