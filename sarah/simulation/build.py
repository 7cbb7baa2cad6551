"""The simulator of an engine, by the engine's name. An engine is imported only when an episode needs it."""

from __future__ import annotations

import os
from collections.abc import Callable

from sarah.errors import SimulationError, one_line
from sarah.robot.description import RobotDescription
from sarah.simulation.engines import check_engine
from sarah.simulation.physics import Physics
from sarah.simulation.randomisation import Conditions
from sarah.simulation.simulator import Simulator

BuildSimulator = Callable[[RobotDescription, Physics, Conditions], Simulator]


def simulator_of(engine: str) -> BuildSimulator:
    """Class that builds an engine's simulator.

    :param engine: name of the engine, ``"pybullet"`` or ``"mujoco"``
    :raises ConfigurationError: if the engine is not installed
    :raises SimulationError: if its package cannot be imported
    """
    check_engine(engine)
    try:
        if engine == "mujoco":
            from sarah.simulation.mujoco_simulator import MujocoSimulator

            return MujocoSimulator
        from sarah.simulation.pybullet_simulator import PyBulletSimulator

        return PyBulletSimulator
    except Exception as error:  # MuJoCo raises anything, if it cannot draw as the environment asks
        is_asked_to_draw = engine == "mujoco" and "MUJOCO_GL" in os.environ
        hint = "; unset MUJOCO_GL, as nothing is drawn with it" if is_asked_to_draw else ""
        raise SimulationError(f"the package {engine} cannot be imported: {one_line(error)}{hint}") from error
