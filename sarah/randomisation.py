"""One episode's conditions, drawn from its seed."""

from __future__ import annotations

import math
import random
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from sarah.config import Push, Randomisation
from sarah.description import GROUPS
from sarah.errors import ConfigurationError
from sarah.sensors import Vector

LINKS = tuple(link for group in GROUPS.values() for link in group)


@dataclass(frozen=True)
class Conditions:
    """One episode's draw: the robot and the world as they really are.

    :param friction: Coulomb friction coefficient between sole and floor
    :param mass_factors: factor on the mass and inertia of every link
    :param actuator_bandwidth: of the position servos, per second
    :param pad_threshold: pad load above which a foot counts as carrying, in N
    :param acceleration_noise: standard deviation in m/s^2
    :param angular_rate_noise: standard deviation in rad/s
    :param imu_bandwidth: of the inertial measurement unit's low-pass, in Hz
    :param pad_noise: standard deviation in N
    :param delay_ticks: control ticks between sensing and acting
    :param start_velocity: of the torso along x and y, in m/s
    :param sensor_seed: of the sensor noise
    """

    friction: float = 0.9
    mass_factors: Mapping[str, float] = field(default_factory=lambda: dict.fromkeys(LINKS, 1.0))
    actuator_bandwidth: float = 50.0
    pad_threshold: float = 30.0
    acceleration_noise: float = 0.0
    angular_rate_noise: float = 0.0
    imu_bandwidth: float = math.inf
    pad_noise: float = 0.0
    delay_ticks: int = 0
    start_velocity: tuple[float, float] = (0.0, 0.0)
    sensor_seed: int = 0

    def __post_init__(self) -> None:
        """Refuse factors that leave a link out."""
        if set(self.mass_factors) != set(LINKS):
            raise ConfigurationError(f"mass_factors must name every link: {', '.join(LINKS)}")


NOMINAL = Conditions()
"""The robot as designed, with perfect sensors."""


def draw_conditions(ranges: Randomisation, seed: int) -> Conditions:
    """Draw one episode's conditions.

    :param ranges: what to draw from
    :param seed: of the episode; the same seed draws the same conditions
    :return: the draw; with the randomisation off, the robot as designed with perfect sensors and a start velocity
    """
    # Each quantity takes a fixed number of draws, so that changing one range leaves the others' draws alone.
    generator = random.Random(seed)
    velocity = (generator.gauss(0.0, ranges.start_speed), generator.gauss(0.0, ranges.start_speed))
    if not ranges.enabled:
        return replace(NOMINAL, start_velocity=velocity)
    return Conditions(
        friction=generator.uniform(*ranges.friction),
        mass_factors={link: 1.0 + ranges.mass_deviation * generator.uniform(-1.0, 1.0) for link in LINKS},
        actuator_bandwidth=generator.uniform(*ranges.actuator_bandwidth),
        pad_threshold=generator.uniform(*ranges.pad_threshold),
        acceleration_noise=ranges.acceleration_noise,
        angular_rate_noise=ranges.angular_rate_noise,
        imu_bandwidth=ranges.imu_bandwidth,
        pad_noise=ranges.pad_noise,
        delay_ticks=ranges.delay_ticks,
        start_velocity=velocity,
        sensor_seed=generator.getrandbits(64),
    )


@dataclass(frozen=True)
class DrawnPush:
    """One episode's push.

    :param force: on the torso's centre, in the world's frame, in N
    :param begin: simulated time at which it begins, in s
    :param duration: in s
    """

    force: Vector
    begin: float
    duration: float


def draw_push(ranges: Push, seed: int) -> DrawnPush:
    """Draw one episode's push, independently of its conditions.

    :param ranges: what to draw from
    :param seed: of the episode; the same seed draws the same direction and time at any force
    """
    generator = random.Random(f"push {seed}")
    newtons = generator.uniform(*ranges.newtons)
    direction = math.radians(generator.uniform(*ranges.degrees))
    begin = generator.uniform(*ranges.at_seconds)
    return DrawnPush((newtons * math.cos(direction), newtons * math.sin(direction), 0.0), begin, ranges.duration)
