"""What nobody knows exactly about a robot, drawn anew for each episode from the episode's seed.

Parameters learned on one exact robot exploit it: they must hold under a little of everything. The ranges are
reconstructed, the paper gives none.
"""

from __future__ import annotations

import math
import random
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace

from sarah.description import GROUPS
from sarah.errors import ConfigurationError

LINKS = tuple(link for group in GROUPS.values() for link in group)


@dataclass(frozen=True)
class Randomisation:
    """Ranges of the randomisation; a pair is a uniform range, and equal ends fix the value.

    :param enabled: whether to randomise; off leaves :data:`NOMINAL` with a random start velocity only
    :param friction: Coulomb friction coefficient between sole and floor
    :param mass_deviation: largest relative deviation of each link's mass and inertia
    :param actuator_bandwidth: of the position servos, per second
    :param pad_threshold: pad load above which a foot counts as carrying, in N
    :param acceleration_noise: standard deviation of the accelerometer's white noise, in m/s^2
    :param angular_rate_noise: standard deviation of the gyroscope's white noise, in rad/s
    :param delay_ticks: control ticks of delay between sensing and acting
    :param start_speed: standard deviation of the torso's horizontal velocity at the start, in m/s
    """

    enabled: bool = True
    friction: tuple[float, float] = (0.7, 1.0)
    mass_deviation: float = 0.05
    actuator_bandwidth: tuple[float, float] = (40.0, 50.0)
    pad_threshold: tuple[float, float] = (20.0, 40.0)
    acceleration_noise: float = 0.2
    angular_rate_noise: float = 0.02
    delay_ticks: int = 1
    start_speed: float = 0.01

    def __post_init__(self) -> None:
        """Refuse ranges that no robot has."""
        for field in fields(self):
            value = getattr(self, field.name)
            ends = value if isinstance(value, tuple) else (value, value)
            if not (math.isfinite(ends[0]) and 0.0 <= ends[0] <= ends[1] < math.inf):
                raise ConfigurationError(
                    f"randomisation.{field.name} must be finite, not negative and in rising order, not {value!r}"
                )
        if self.mass_deviation >= 1.0:
            raise ConfigurationError(f"randomisation.mass_deviation must be below 1, not {self.mass_deviation!r}")
        if self.actuator_bandwidth[0] == 0.0:
            raise ConfigurationError("randomisation.actuator_bandwidth must be above 0")


@dataclass(frozen=True)
class Conditions:
    """One episode's draw: the robot and the world as they really are. Units as in :class:`Randomisation`.

    :param mass_factors: factor on each link's mass and inertia
    :param start_velocity: of the torso along x and y, in m/s
    :param sensor_seed: of the sensor noise
    """

    friction: float
    mass_factors: Mapping[str, float]
    actuator_bandwidth: float
    pad_threshold: float
    acceleration_noise: float
    angular_rate_noise: float
    delay_ticks: int
    start_velocity: tuple[float, float]
    sensor_seed: int


NOMINAL = Conditions(
    friction=0.9,
    mass_factors={link: 1.0 for link in LINKS},
    actuator_bandwidth=50.0,
    pad_threshold=30.0,
    acceleration_noise=0.0,
    angular_rate_noise=0.0,
    delay_ticks=0,
    start_velocity=(0.0, 0.0),
    sensor_seed=0,
)
"""The robot as designed, with perfect sensors."""


def draw_conditions(ranges: Randomisation, seed: int) -> Conditions:
    """Draw one episode's conditions.

    :param ranges: what to draw from
    :param seed: of the episode; the same seed draws the same conditions
    :return: the draw. With the randomisation off only the start velocity is drawn, so that seeds still differ
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
        delay_ticks=ranges.delay_ticks,
        start_velocity=velocity,
        sensor_seed=generator.getrandbits(64),
    )
