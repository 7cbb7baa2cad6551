"""The protocol of a simulator: what an episode needs of a physics engine."""

from __future__ import annotations

import math
from typing import NamedTuple, Protocol

from sarah.robot.reading import SensorReading, Side, Vector
from sarah.scenery.ground import LEVEL_GRAVITY, Ground

LARGEST_STATE = 1e3
"""Largest state of a torso, in any SI unit: a larger one means that the simulation diverges."""


class TorsoState(NamedTuple):
    """True state of the torso, in the world's frame.

    :param position: position of its centre, in m
    :param orientation: orientation as a unit quaternion (x, y, z, w)
    :param velocity: velocity of its centre, in m/s
    :param angular_velocity: angular velocity, in rad/s
    """

    position: Vector
    orientation: tuple[float, float, float, float]
    velocity: Vector
    angular_velocity: Vector

    @property
    def axis(self) -> Vector:
        """Unit vector along the torso, from the legs to the head."""
        x, y, z, w = self.orientation
        return (2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y))

    def upright(self, vertical: Vector) -> float:
        """Cosine of the angle between the torso's axis and gravity's vertical.

        :param vertical: unit vector against gravity, in the world's frame
        """
        (axis_x, axis_y, axis_z), (x, y, z) = self.axis, vertical
        return axis_x * x + axis_y * y + axis_z * z

    @property
    def is_finite(self) -> bool:
        """Whether the state consists of finite numbers that a robot's state can have."""
        position, orientation, velocity, angular_velocity = self
        return math.hypot(*position, *orientation, *velocity, *angular_velocity) < LARGEST_STATE


class Simulator(Protocol):
    """A robot in its world, built for one episode: it stands on a plane, its soles touch it, all joints are at zero.

    In the world's frame the plane is z = 0, also where it slopes: gravity is tilted instead.
    """

    @property
    def time(self) -> float:
        """Simulated time so far, in s."""

    @property
    def ground(self) -> Ground:
        """Ground under the robot."""

    def set_targets(self, targets: tuple[float, ...]) -> None:
        """Set where the servos move the joints from now on.

        :param targets: positions in the order of ``ACTUATED_JOINTS``, in rad and m
        """

    def push(self, force: Vector) -> None:
        """Push the torso at its centre during the next control tick.

        :param force: force in the world's frame, in N
        """

    def advance(self) -> None:
        """Simulate one control tick."""

    def read(self) -> SensorReading:
        """True sensor signals of the last control tick, without noise or delay."""

    def torso_state(self) -> TorsoState:
        """True state of the torso, which no sensor of the robot measures."""

    def joint_positions(self, names: tuple[str, ...]) -> tuple[float, ...]:
        """Positions of some joints, in rad and m.

        :param names: names of the joints
        :return: positions in the same order
        """

    def actuator_motion(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Speeds (rad/s, m/s) and efforts (Nm, N) of the actuators, in the order of ``ACTUATED_JOINTS``."""

    def sole_height(self, side: Side) -> float:
        """Height of a foot's lowest sole contact over the floor, in m.

        :param side: side of the foot
        """

    def close(self) -> None:
        """Give the engine's resources back; the simulator cannot be used after that."""


def rotate_to_body(orientation: tuple[float, float, float, float], vector: Vector) -> Vector:
    """Rotate a vector from the world's frame into a body's frame.

    :param orientation: orientation of the body, as a unit quaternion (x, y, z, w)
    :param vector: vector in the world's frame
    :return: the same vector in the body's frame
    """
    x, y, z, w = orientation
    a, b, c = vector
    return (
        (1.0 - 2.0 * (y * y + z * z)) * a + 2.0 * (x * y + w * z) * b + 2.0 * (x * z - w * y) * c,
        2.0 * (x * y - w * z) * a + (1.0 - 2.0 * (x * x + z * z)) * b + 2.0 * (y * z + w * x) * c,
        2.0 * (x * z + w * y) * a + 2.0 * (y * z - w * x) * b + (1.0 - 2.0 * (x * x + y * y)) * c,
    )


def rotate_to_world(orientation: tuple[float, float, float, float], vector: Vector) -> Vector:
    """Rotate a vector from a body's frame into the world's frame.

    :param orientation: orientation of the body, as a unit quaternion (x, y, z, w)
    :param vector: vector in the body's frame
    :return: the same vector in the world's frame
    """
    x, y, z, w = orientation
    return rotate_to_body((-x, -y, -z, w), vector)


def specific_force(torso: TorsoState, velocity_before: Vector, dt: float, gravity: Vector = LEVEL_GRAVITY) -> Vector:
    """Mean specific force over a control tick, which an ideal accelerometer in the torso reads.

    :param torso: state of the torso at the end of the tick
    :param velocity_before: velocity at the beginning of the tick, in the world's frame, in m/s
    :param dt: duration of the tick, in s
    :param gravity: acceleration of gravity, in the world's frame, in m/s^2
    :return: specific force in the torso's frame, in m/s^2; (0, 0, 9.81) at rest on level ground
    """
    now, before = torso.velocity, velocity_before
    force = (
        (now[0] - before[0]) / dt - gravity[0],
        (now[1] - before[1]) / dt - gravity[1],
        (now[2] - before[2]) / dt - gravity[2],
    )
    return rotate_to_body(torso.orientation, force)
