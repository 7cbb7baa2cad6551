"""What every engine's world has in common: it is ours alone, and as it was described."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NoReturn, SupportsIndex

from sarah.errors import SimulationError
from sarah.robot.description import RobotDescription
from sarah.robot.reading import Vector
from sarah.simulation.randomisation import Conditions

CHECKS = 10
"""Number of checks of a world, one of which looks at its settings too."""
TOLERANCE = 1e-9
"""Largest difference of a loaded number from its description, as a share of it and of 1."""
LITTLE = 2.0**-60
"""Number that leaves 1 as it is when a sum is rounded to the nearest number."""


class HoldsWorld:
    """Something that holds simulated worlds: a copy would share or lose them, so it cannot be copied or pickled."""

    def __reduce_ex__(self, protocol: SupportsIndex) -> NoReturn:
        """Refuse to be copied and pickled.

        :param protocol: protocol of pickle
        :raises SimulationError: always
        """
        raise SimulationError(
            f"{type(self).__name__} holds simulated worlds, which a copy would share, so it cannot be copied or "
            "pickled: make another one with the same arguments"
        )


def check_arithmetic() -> None:
    """Refuse a process in which sums are not rounded to the nearest number, as some libraries leave it.

    :raises SimulationError: if so, because no episode would repeat
    """
    one = float(len("1"))  # constants would be added by the compiler
    if not one - LITTLE == one == one + LITTLE:
        raise SimulationError(
            "this process rounds sums up, down or towards 0 (fesetround), so no episode would repeat: "
            "set the rounding to the nearest number again"
        )


def check_loaded(
    engine: str,
    robot: RobotDescription,
    conditions: Conditions,
    masses: Mapping[str, float],
    limits: Mapping[str, tuple[float, float]],
    gravity: Vector,
) -> None:
    """Compare what an engine has with what it was to load.

    :param engine: name of the engine
    :param robot: checked robot
    :param conditions: properties of robot and world in this episode
    :param masses: mass of each link in the engine, in kg
    :param limits: lowest and highest position of each joint in the engine, in rad or m
    :param gravity: acceleration of gravity in the engine, in m/s^2
    :raises SimulationError: naming the first number that differs
    """
    numbers: list[tuple[str, float, float | None]] = [("number of joints", len(robot.limits), len(limits))]
    for link, mass in robot.masses.items():
        numbers.append((f"mass of {link}", mass * conditions.mass_factors.get(link, 1.0), masses.get(link)))
    for joint, ends in robot.limits.items():
        names = f"lower limit of {joint}", f"upper limit of {joint}"
        numbers.extend(zip(names, ends, limits.get(joint, (None, None)), strict=True))
    numbers.extend(zip([f"gravity along {axis}" for axis in "xyz"], conditions.ground.gravity, gravity, strict=True))
    for name, value, there in numbers:
        if there is None or not abs(there - value) <= TOLERANCE * max(1.0, abs(value)):
            raise SimulationError(
                f"{engine} loaded another robot than the one described: {name} is {there!r} there, and should be "
                f"{value!r}; something else in this process changes how it reads numbers, or the engine itself"
            )
