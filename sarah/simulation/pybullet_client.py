"""PyBullet itself, quietly imported, and its clients: worlds that nobody uses any more are emptied and used again."""

from __future__ import annotations

import os
import tempfile
from importlib import import_module
from types import ModuleType

from sarah.errors import SimulationError


def _import_pybullet() -> ModuleType:
    """Import PyBullet without the build time that it writes to the process's standard error."""
    try:
        kept = os.dup(2)
    except OSError:  # closed: nothing will be written
        return import_module("pybullet")
    with open(os.devnull, "wb") as nowhere:
        os.dup2(nowhere.fileno(), 2)
        try:
            return import_module("pybullet")
        finally:
            os.dup2(kept, 2)
            os.close(kept)


pybullet = _import_pybullet()

_spare_clients: list[int] = []


def take_client() -> int:
    """A client with an empty world.

    An emptied world in which everything is set and built anew repeats an episode bit for bit, as a fresh one does,
    and costs 20 ms less.

    :return: PyBullet's number of the client
    :raises SimulationError: if there is none left
    """
    if _spare_clients:
        return _spare_clients.pop()
    client: int = pybullet.connect(pybullet.DIRECT)
    if client < 0:
        raise SimulationError("PyBullet has no free client: close simulations that are done")
    return client


def give_back_client(client: int) -> None:
    """Empty a client's world, for whoever takes it next.

    :param client: its number
    """
    pybullet.resetSimulation(physicsClientId=client)
    _spare_clients.append(client)


def load_robot(client: int, urdf: str, height: float, flags: int) -> tuple[int, dict[str, int]]:
    """Load the robot into a world, standing above its origin.

    :param client: of the world
    :param urdf: the robot
    :param height: of the torso's centre, in m
    :param flags: of ``loadURDF``
    :return: PyBullet's number of the body, and its index of each link and of the joint that carries it, by either name
    """
    with tempfile.NamedTemporaryFile("w", prefix="sarah-", suffix=".urdf", encoding="utf-8") as file:
        file.write(urdf)
        file.flush()
        body = pybullet.loadURDF(file.name, basePosition=(0.0, 0.0, height), flags=flags, physicsClientId=client)
    indices = {"torso": -1}
    for joint in range(pybullet.getNumJoints(body, physicsClientId=client)):
        info = pybullet.getJointInfo(body, joint, physicsClientId=client)
        indices[info[1].decode()] = indices[info[12].decode()] = joint
    return body, indices
