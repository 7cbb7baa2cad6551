"""The physics engines by name. None is imported before an episode asks for it."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from typing import Literal

from sarah.errors import ConfigurationError
from sarah.robot.description import RobotDescription
from sarah.simulation.physics import Physics
from sarah.simulation.randomisation import Conditions
from sarah.simulation.simulator import Simulator

Engine = Literal["pybullet", "mujoco"]
BuildSimulator = Callable[[RobotDescription, Physics, Conditions], Simulator]


def simulator_of(engine: str) -> BuildSimulator:
    """What builds an engine's simulator.

    :param engine: ``"pybullet"`` or ``"mujoco"``
    :raises ConfigurationError: if the engine is not installed
    """
    check_engine(engine)
    if engine == "mujoco":
        from sarah.simulation.mujoco_simulator import MujocoSimulator

        return MujocoSimulator
    from sarah.simulation.pybullet_simulator import PyBulletSimulator

    return PyBulletSimulator


def check_engine(engine: str) -> None:
    """Refuse an engine that is not installed.

    :param engine: ``"pybullet"`` or ``"mujoco"``
    :raises ConfigurationError: naming how to install it
    """
    spec = find_spec(engine)
    if spec is None or spec.origin is None:  # `pip uninstall mujoco` leaves a folder of that name, but no package
        raise ConfigurationError(f"engine {engine!r} needs the package {engine}: pip install 'sarah[{engine}]'")
