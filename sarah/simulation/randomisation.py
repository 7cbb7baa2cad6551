"""The uncertain properties of a robot and its world, and one episode's draw of them."""

from __future__ import annotations

import math
import random
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from sarah.errors import ConfigurationError, check_fields, to_ranges
from sarah.robot.description import GROUPS

LINKS = tuple(link for group in GROUPS.values() for link in group)
PLAUSIBLE = {
    "friction": (0.0, 5.0, ""),
    "mass_deviation": (0.0, 0.9, ""),
    "actuator_bandwidth": (0.1, 1000.0, "per second"),
    "pad_threshold": (0.0, 1000.0, "N"),
    "acceleration_noise": (0.0, 100.0, "m/s^2"),
    "angular_rate_noise": (0.0, 100.0, "rad/s"),
    "imu_bandwidth": (0.1, 100_000.0, "Hz"),
    "pad_noise": (0.0, 1000.0, "N"),
    "delay_ticks": (0, 100, "ticks"),
    "start_speed": (0.0, 10.0, "m/s"),
}
"""Lowest value, highest value and unit of each setting. Beyond them, somebody has mistaken the unit."""


@dataclass(frozen=True)
class Randomisation:
    """Uncertain properties of the robot and its world, drawn for each episode from its seed.

    Parameters learned on one exact robot exploit it, so they must hold under a little of everything. The ranges are
    reconstructed, as the paper gives none. A pair is a uniform range; one number, or equal ends, fix the value.

    :param enabled: whether to randomise; if not, the robot is as designed, except for a random start velocity
    :param friction: range of the Coulomb friction coefficient between sole and floor
    :param mass_deviation: largest relative deviation of each link's mass and inertia
    :param actuator_bandwidth: range of the position servos' bandwidth, per second
    :param pad_threshold: range of the load above which a foot counts as loaded, in N
    :param acceleration_noise: standard deviation of the accelerometer's white noise, in m/s^2
    :param angular_rate_noise: standard deviation of the gyroscope's white noise, in rad/s
    :param imu_bandwidth: bandwidth of the first-order low-pass inside the inertial measurement unit, in Hz
    :param pad_noise: standard deviation of each pressure pad's white noise, in N
    :param delay_ticks: delay between sensing and acting, in control ticks
    :param start_speed: standard deviation of the torso's velocity along x and y at the start, in m/s
    """

    enabled: bool = True
    friction: tuple[float, float] = (0.7, 1.0)
    mass_deviation: float = 0.05
    actuator_bandwidth: tuple[float, float] = (40.0, 50.0)
    pad_threshold: tuple[float, float] = (20.0, 40.0)
    acceleration_noise: float = 0.2
    angular_rate_noise: float = 0.02
    imu_bandwidth: float = 40.0
    pad_noise: float = 3.0
    delay_ticks: int = 1
    start_speed: float = 0.01

    def __post_init__(self) -> None:
        """Refuse ranges that no robot has."""
        to_ranges(self, "friction", "actuator_bandwidth", "pad_threshold")
        check_fields("randomisation", self, PLAUSIBLE)


@dataclass(frozen=True)
class Conditions:
    """One episode's draw: the properties of its robot and world.

    :param friction: Coulomb friction coefficient between sole and floor
    :param mass_factors: factor on the mass and inertia of every link
    :param actuator_bandwidth: bandwidth of the position servos, per second
    :param pad_threshold: load above which a foot counts as loaded, in N
    :param acceleration_noise: standard deviation of the accelerometer's white noise, in m/s^2
    :param angular_rate_noise: standard deviation of the gyroscope's white noise, in rad/s
    :param imu_bandwidth: bandwidth of the inertial measurement unit's low-pass, in Hz; infinite for none
    :param pad_noise: standard deviation of each pressure pad's white noise, in N
    :param delay_ticks: delay between sensing and acting, in control ticks
    :param start_velocity: velocity of the torso along x and y at the start, in m/s
    :param sensor_seed: seed of the sensor noise
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
        """Refuse factors that omit a link."""
        if set(self.mass_factors) != set(LINKS):
            raise ConfigurationError(f"mass_factors must name every link: {', '.join(LINKS)}")


NOMINAL = Conditions()
"""The robot as designed, with perfect sensors."""


def draw_conditions(ranges: Randomisation, seed: int) -> Conditions:
    """Draw one episode's conditions.

    :param ranges: ranges to draw from
    :param seed: seed of the episode; the same seed draws the same conditions
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
