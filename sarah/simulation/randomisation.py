"""The uncertain properties of a robot and its world, and one episode's draw of them."""

from __future__ import annotations

import math
import random
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated

from sarah.errors import ConfigurationError
from sarah.ranges import Range, Within, check_ranges
from sarah.robot.description import GROUPS
from sarah.robot.reading import Side, Vector
from sarah.robot.scale import Sized
from sarah.scenery.ground import LEVEL, Ground

LINKS = tuple(link for group in GROUPS.values() for link in group)
SLIPPERY = 0.5
"""Friction coefficient below which simulators take friction cones. Pyramids make it differ by direction, by up to 41 %,
but a sole that does not slide does not feel that."""


@dataclass(frozen=True)
class Randomisation:
    """Uncertain properties of the robot and its world, drawn for each episode from its seed.

    Parameters learned on one exact robot exploit it. So they must hold under a little of everything: under errors that
    stay the same in an episode, such as a sensor mounted askew, and under noise. The values are reconstructed, as the
    paper gives none; those of sensors are what datasheets of small inertial units and load cells promise, before
    calibration. A pair is a uniform range; one number, or equal ends, fix the value.

    :param enabled: whether to randomise; if not, the robot is as designed, with the quickest servos of the range, and
        the seed draws push and terrain only
    :param friction: range of the Coulomb friction coefficient between sole and floor
    :param mass_deviation: largest relative deviation of each link's mass and inertia
    :param mass_offset: largest offset of the torso's centre of mass along each of its axes, in m
    :param actuator_bandwidth: range of the position servos' bandwidth, per second
    :param imu_tilt_degrees: largest angle by which the inertial measurement unit is mounted askew, about any horizontal
        axis, in degrees
    :param acceleration_bias: largest constant error of each axis of the accelerometer, in m/s^2
    :param angular_rate_bias: largest constant error of each axis of the gyroscope, in rad/s
    :param pad_gain: largest relative error of each pressure pad's gain
    :param acceleration_noise_density: density of the accelerometer's white noise, in m/s^2 per root Hz
    :param angular_rate_noise_density: density of the gyroscope's white noise, in rad/s per root Hz
    :param imu_bandwidth: bandwidth of the first-order low-pass inside the inertial measurement unit, in Hz
    :param pad_noise_density: density of each pressure pad's white noise, in N per root Hz
    :param delay_seconds: delay between sensing and acting, in s
    """

    enabled: bool = True
    friction: Annotated[Range, Within(0.0, 5.0)] = Range((0.7, 1.0))
    mass_deviation: Annotated[float, Within(0.0, 0.9)] = 0.05
    mass_offset: Annotated[float, Sized(0.0, 0.1, "m")] = 0.010
    actuator_bandwidth: Annotated[Range, Sized(0.1, 1000.0, "per second")] = Range((40.0, 50.0))
    imu_tilt_degrees: Annotated[float, Within(0.0, 45.0, "degrees")] = 2.0
    acceleration_bias: Annotated[float, Within(0.0, 100.0, "m/s^2")] = 0.1
    angular_rate_bias: Annotated[float, Within(0.0, 100.0, "rad/s")] = 0.02
    pad_gain: Annotated[float, Within(0.0, 0.9)] = 0.2
    acceleration_noise_density: Annotated[float, Within(0.0, 10.0, "m/s^2 per root Hz")] = 0.028
    angular_rate_noise_density: Annotated[float, Within(0.0, 10.0, "rad/s per root Hz")] = 0.0028
    imu_bandwidth: Annotated[float, Within(0.1, 100_000.0, "Hz")] = 40.0
    pad_noise_density: Annotated[float, Sized(0.0, 100.0, "N per root Hz")] = 0.42
    delay_seconds: Annotated[float, Within(0.0, 1.0, "s")] = 0.010

    def __post_init__(self) -> None:
        """Refuse ranges that no robot has."""
        check_ranges("randomisation.", self)


@dataclass(frozen=True)
class SensorConditions:
    """One episode's draw of the sensors' errors; without any, they are perfect.

    :param imu_tilt: rotation by which the inertial measurement unit is mounted askew, about the torso's x and y axis,
        in rad
    :param acceleration_bias: constant error of the accelerometer, in m/s^2
    :param angular_rate_bias: constant error of the gyroscope, in rad/s
    :param pad_gains: factor on each pad's load
    :param acceleration_noise_density: density of the accelerometer's white noise, in m/s^2 per root Hz
    :param angular_rate_noise_density: density of the gyroscope's white noise, in rad/s per root Hz
    :param imu_bandwidth: bandwidth of the inertial measurement unit's low-pass, in Hz; infinite for none
    :param pad_noise_density: density of each pressure pad's white noise, in N per root Hz
    :param delay_seconds: delay between sensing and acting, in s
    :param seed: seed of the noise
    """

    imu_tilt: tuple[float, float] = (0.0, 0.0)
    acceleration_bias: Vector = (0.0, 0.0, 0.0)
    angular_rate_bias: Vector = (0.0, 0.0, 0.0)
    pad_gains: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)
    acceleration_noise_density: float = 0.0
    angular_rate_noise_density: float = 0.0
    imu_bandwidth: float = math.inf
    pad_noise_density: float = 0.0
    delay_seconds: float = 0.0
    seed: int = 0


@dataclass(frozen=True)
class Conditions:
    """One episode's draw: the properties of its robot and world.

    :param friction: Coulomb friction coefficient between sole and floor
    :param mass_factors: factor on the mass and inertia of every link
    :param mass_offset: offset of the torso's centre of mass in its frame, in m
    :param actuator_bandwidth: bandwidth of the position servos, per second
    :param sensors: errors of the sensors
    :param ground: ground under the robot; it may have friction coefficients of its own
    """

    friction: float = 0.9
    mass_factors: Mapping[str, float] = field(default_factory=lambda: dict.fromkeys(LINKS, 1.0))
    mass_offset: Vector = (0.0, 0.0, 0.0)
    actuator_bandwidth: float = 50.0
    sensors: SensorConditions = SensorConditions()
    ground: Ground = LEVEL

    def __post_init__(self) -> None:
        """Refuse factors that omit a link."""
        if set(self.mass_factors) != set(LINKS):
            raise ConfigurationError(f"mass_factors must name every link: {', '.join(LINKS)}")

    @property
    def is_slippery(self) -> bool:
        """Whether a sole slides so easily that its friction has to be the same in all directions."""
        return min(self.friction_under(side) for side in Side) < SLIPPERY

    def friction_under(self, side: Side) -> float:
        """Coulomb friction coefficient between a foot's soles and the ground.

        :param side: side of the foot
        """
        own = self.ground.friction(side)
        return self.friction if own is None else own


NOMINAL = Conditions()
"""The robot as designed, with perfect sensors."""


def draw_conditions(ranges: Randomisation, seed: int) -> Conditions:
    """Draw one episode's conditions.

    :param ranges: ranges to draw from
    :param seed: seed of the episode; the same seed draws the same conditions
    :return: the draw; with the randomisation off, the robot as designed with perfect sensors and the quickest servos
    """
    if not ranges.enabled:
        return replace(NOMINAL, actuator_bandwidth=ranges.actuator_bandwidth[1])
    # Each quantity takes a fixed number of draws, so that changing one range leaves the others' draws alone.
    generator = random.Random(seed)
    return Conditions(
        friction=generator.uniform(*ranges.friction),
        mass_factors={link: 1.0 + ranges.mass_deviation * generator.uniform(-1.0, 1.0) for link in LINKS},
        actuator_bandwidth=generator.uniform(*ranges.actuator_bandwidth),
        mass_offset=_within(ranges.mass_offset, generator),
        sensors=_draw_sensors(ranges, generator),
    )


def _draw_sensors(ranges: Randomisation, generator: random.Random) -> SensorConditions:
    angle = math.radians(ranges.imu_tilt_degrees) * generator.random()
    direction = math.tau * generator.random()

    def gain() -> float:
        return 1.0 + ranges.pad_gain * generator.uniform(-1.0, 1.0)

    return SensorConditions(
        imu_tilt=(angle * math.cos(direction), angle * math.sin(direction)),
        acceleration_bias=_within(ranges.acceleration_bias, generator),
        angular_rate_bias=_within(ranges.angular_rate_bias, generator),
        pad_gains=(gain(), gain(), gain(), gain()),
        acceleration_noise_density=ranges.acceleration_noise_density,
        angular_rate_noise_density=ranges.angular_rate_noise_density,
        imu_bandwidth=ranges.imu_bandwidth,
        pad_noise_density=ranges.pad_noise_density,
        delay_seconds=ranges.delay_seconds,
        seed=generator.getrandbits(64),
    )


def _within(largest: float, generator: random.Random) -> Vector:
    x, y, z = (largest * generator.uniform(-1.0, 1.0) for _ in range(3))
    return (x, y, z)
