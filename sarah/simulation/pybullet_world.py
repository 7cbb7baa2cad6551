"""PyBullet, imported without its message, and its worlds, each of which is ours alone."""

from __future__ import annotations

import locale
import math
import os
import tempfile
import threading
import uuid
import weakref
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any

from sarah.errors import SimulationError
from sarah.robot.reading import Vector
from sarah.simulation.engines import is_installed
from sarah.simulation.world import CHECKS, HoldsWorld, check_arithmetic

Pose = tuple[Vector, tuple[float, float, float, float]]
MARK = "sarah"
"""Key under which our worlds carry a name that nobody else's has."""
BULLETS_CONTACT_MARGIN = 0.02
"""Bullet's own distance at which the solver begins to consider a contact, in m, which all worlds of a process share."""


def _import_pybullet() -> Any:
    """Import PyBullet without the build time that it writes to standard error; return None if it is not installed."""
    if not is_installed("pybullet"):
        return None
    try:
        kept = os.dup(2)
    except OSError:  # standard error is closed, so nothing will be written
        return import_module("pybullet")
    with open(os.devnull, "wb") as nowhere:
        os.dup2(nowhere.fileno(), 2)
        try:
            return import_module("pybullet")
        finally:
            os.dup2(kept, 2)
            os.close(kept)


pybullet = _import_pybullet()

_spare: list[tuple[int, str]] = []
"""Clients whose worlds are empty, and the names that these worlds carry."""
_open: set[str] = set()
"""Names of the worlds that are open."""
_loading = threading.Lock()
"""Lock of the thread that loads a robot, and has set the process's locale aside."""


class PyBulletWorld(HoldsWorld):
    """A new, empty world of PyBullet's. It is emptied, and its client used again, when it is closed or forgotten.

    Everything in an emptied world is set and built anew, so an episode repeats bit for bit, as in a new world. Emptying
    one is quicker than making one, which also costs memory for good. Other code in the process may have disconnected a
    client that was kept, or even be using its number: a world carries a name, by which it is known.

    :raises SimulationError: if PyBullet has no free client, or if this process does not round to the nearest number
    """

    client: int
    """PyBullet's number of the client. It is never 0, where other code works that gives no number."""

    def __init__(self) -> None:
        check_arithmetic()
        self._name = uuid.uuid4().hex
        self._bodies: list[int] = []
        self._counts: tuple[int, int] | None = None
        self._settings: tuple[Any, ...] = ()
        self._checks = 0
        self.client = _emptied_client()
        _open.add(self._name)
        self._give_back = weakref.finalize(self, _give_back, self.client, self._name, self._bodies)
        self._give_back.atexit = False

    def own(self, body: int) -> None:
        """Mark a body as one of this world's.

        :param body: PyBullet's number of the body
        """
        pybullet.addUserData(body, MARK, self._name, physicsClientId=self.client)
        self._bodies.append(body)

    def load_robot(self, urdf: str, height: float, flags: int) -> tuple[int, dict[str, int]]:
        """Load the robot, standing above the origin.

        :param urdf: text of the robot's URDF
        :param height: height of the torso's centre over the floor, in m
        :param flags: flags of PyBullet's ``loadURDF``
        :return: PyBullet's number of the body, and its index of each link and joint by name; a link has its joint's
            index
        :raises SimulationError: if PyBullet cannot read the URDF from a temporary file
        """
        try:
            with tempfile.NamedTemporaryFile("w", prefix="sarah-", suffix=".urdf", encoding="utf-8") as file:
                file.write(urdf)
                file.flush()
                with _decimal_points():
                    body = pybullet.loadURDF(
                        file.name, basePosition=(0.0, 0.0, height), flags=flags, physicsClientId=self.client
                    )
        except (OSError, UnicodeError, pybullet.error) as error:
            raise SimulationError(
                f"PyBullet cannot read the robot from a temporary file, whose folder TMPDIR chooses: {error}"
            ) from error
        self.own(body)
        indices = {"torso": -1}
        for joint in range(pybullet.getNumJoints(body, physicsClientId=self.client)):
            info = pybullet.getJointInfo(body, joint, physicsClientId=self.client)
            indices[info[1].decode()] = indices[info[12].decode()] = joint
        return body, indices

    def check(self, pose: Pose | None = None) -> None:
        """Refuse a world that other code has changed since the first check.

        :param pose: position and orientation of the robot when it was last looked at, if nothing else moves it
        :raises SimulationError: if bodies or constraints were added or removed, if the robot was moved, or if the world
            was reset or disconnected; within ten checks also if settings or masses are others
        """
        client = self.client
        if not self._give_back.alive:
            raise SimulationError("the simulated world is closed: make another one")
        try:
            counts = (pybullet.getNumBodies(physicsClientId=client), pybullet.getNumConstraints(physicsClientId=client))
            if self._counts is None:
                self._counts, self._settings = counts, self._present_settings()
            is_same = counts == self._counts and (
                pose is None
                or pybullet.getBasePositionAndOrientation(self._bodies[-1], physicsClientId=client) == pose
                or not all(map(math.isfinite, (*pose[0], *pose[1])))
            )
            self._checks += 1
            if is_same and self._checks % CHECKS == 0:
                check_arithmetic()
                is_same = _carries(client, self._name, self._bodies) and self._present_settings() == self._settings
        except pybullet.error:
            is_same = False
        if not is_same:
            raise SimulationError(
                "other code in this process has changed the robot's world in PyBullet, moved the robot, or reset or "
                f"disconnected the world: it must leave client {client} alone"
            )

    def _present_settings(self) -> tuple[Any, ...]:
        """Settings of the engine, and mass and friction of every link."""
        links = [
            (body, link)
            for body in self._bodies
            for link in range(-1, pybullet.getNumJoints(body, physicsClientId=self.client))
        ]
        properties = [pybullet.getDynamicsInfo(*link, physicsClientId=self.client)[:2] for link in links]
        return pybullet.getPhysicsEngineParameters(self.client), properties

    def close(self) -> None:
        """Empty the world, and keep its client for the next one."""
        self._give_back()


def _emptied_client() -> int:
    """A client with an empty world that nobody else uses."""
    while _spare:
        client, name = _spare.pop()
        if _carries(client, name, [0]):
            pybullet.resetSimulation(physicsClientId=client)
            return client
    client = pybullet.connect(pybullet.DIRECT)
    if client == 0:  # code that gives no number works there
        client = pybullet.connect(pybullet.DIRECT)
        pybullet.disconnect(0)
    if client < 0:
        raise SimulationError("PyBullet has no free client: close simulators that are not needed")
    return int(client)


def _give_back(client: int, name: str, bodies: list[int]) -> None:
    """Empty a client's world, and keep the client, unless it is no longer ours."""
    _open.discard(name)
    if not _carries(client, name, bodies):
        return
    pybullet.resetSimulation(physicsClientId=client)
    if not _open:  # another thread may be about to advance one of them
        pybullet.setPhysicsEngineParameter(contactBreakingThreshold=BULLETS_CONTACT_MARGIN, physicsClientId=client)
    body = pybullet.createMultiBody(0.0, physicsClientId=client)
    pybullet.addUserData(body, MARK, name, physicsClientId=client)
    _spare.append((client, name))


def _carries(client: int, name: str, bodies: list[int]) -> bool:
    """Whether all bodies of a world carry its name."""
    if not pybullet.isConnected(client):
        return False
    for body in bodies:
        mark = pybullet.getUserDataId(body, MARK, physicsClientId=client)
        if mark < 0 or pybullet.getUserData(mark, physicsClientId=client) != name.encode():
            return False
    return True


@contextmanager
def _decimal_points() -> Iterator[None]:
    """Let this process read numbers with decimal points for a while, as Bullet reads a URDF in the process's locale."""
    with _loading:
        before = locale.setlocale(locale.LC_NUMERIC)
        locale.setlocale(locale.LC_NUMERIC, "C")
        try:
            yield
        finally:
            locale.setlocale(locale.LC_NUMERIC, before)
