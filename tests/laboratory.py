"""What several tests share.

The laboratories do to a simulated robot what no episode does, in each physics engine: place it, turn it, weigh it.
"""

import copy
import math
import pickle
from collections.abc import Callable, Sequence
from itertools import product
from typing import Any

import numpy as np
import pytest

from sarah.episode.result import METRICS, EpisodeResult
from sarah.robot.description import PLATES
from sarah.robot.reading import SensorReading, Side, Vector
from sarah.scenery.ground import LEVEL
from sarah.simulation.engines import is_installed
from sarah.simulation.physics import PHYSICS, Physics
from sarah.simulation.pybullet_world import pybullet
from sarah.simulation.simulator import Simulator, TorsoState

CONTROL_DT = PHYSICS["standard"].control_dt
COARSE_PHYSICS = Physics(rate=100, solver_iterations=5)
"""Physics that takes a fifth of the time, for tests that do not look at the robot."""
NUMBERS: dict[str, Any] = {
    **dict.fromkeys([name for name in METRICS if name in EpisodeResult.__dataclass_fields__], 0.0),
    "score": 0.8,
    "episode_return": 4.0,
    "steps_per_second": 3.0,
    "steps": 30,
    "duration": 14.15,
    "shifts_by_sensors": 1.0,
    "lifts_by_sensors": 1.0,
    "sole_clearance": 0.02,
    "vibration": 9.0,
    "actuator_power": 15.0,
    "peak_hip_rate": 0.5,
    "peak_leg_speed": 0.6,
}
RESULT = EpisodeResult(termination="time_limit", final_position=(0.03, 0.04, 0.84), **NUMBERS)
"""Result of an episode that nobody simulated."""
WAYS: dict[str, Callable[[Any], Any]] = {
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
    "pickle": lambda value: pickle.loads(pickle.dumps(value)),
}
"""Ways to copy an object."""
NEEDS_PYBULLET = pytest.mark.skipif(not is_installed("pybullet"), reason="needs pybullet")


class BulletLaboratory:
    """PyBullet's."""

    engine = "pybullet"

    def place(self, simulation: Any, height: float = 30.0, roll: float = 0.0, pitch: float = 0.0) -> None:
        """Put the robot in the air, turned by ``roll`` about y or ``pitch`` about x."""
        orientation = turned(roll, pitch)
        client = simulation.client
        pybullet.resetBasePositionAndOrientation(simulation.body, (0, 0, height), orientation, physicsClientId=client)
        simulation.look()

    def turn(self, simulation: Any, rate: Sequence[float]) -> None:
        """Let the torso turn, with a rate in the world's frame."""
        pybullet.resetBaseVelocity(simulation.body, (0, 0, 0), rate, physicsClientId=simulation.client)
        simulation.look()

    def move_joint(self, simulation: Any, name: str, position: float, speed: float) -> None:
        index = simulation.links[name]
        pybullet.resetJointState(
            simulation.body, index, position, targetVelocity=speed, physicsClientId=simulation.client
        )

    def remove_pads(self, simulation: Any) -> None:
        """Let the plates pass through the pads."""
        body, links = simulation.body, simulation.links
        for side, plate in product(Side, PLATES):
            shank, foot = links[f"{side}_shank"], links[f"{side}_{plate}"]
            pybullet.setCollisionFilterPair(body, body, shank, foot, 0, simulation.client)

    def mass(self, simulation: Any, link: str) -> float:
        return float(self._dynamics(simulation, link)[0])

    def friction_under(self, simulation: Any, side: Side) -> set[float]:
        return {self._dynamics(simulation, f"{side}_{plate}")[1] for plate in PLATES}

    def touches_ground(self, simulation: Any, position: Sequence[float]) -> bool:
        """Whether a ball as large as a sole's contact touches the ground."""
        client = simulation.client
        shape = pybullet.createCollisionShape(
            pybullet.GEOM_SPHERE, radius=simulation.robot.contact_radius, physicsClientId=client
        )
        ball = pybullet.createMultiBody(1.0, shape, basePosition=position, physicsClientId=client)
        pybullet.performCollisionDetection(physicsClientId=client)
        contacts = pybullet.getContactPoints(ball, 0, physicsClientId=client)  # the ground is the first body
        pybullet.removeBody(ball, physicsClientId=client)
        return any(contact[8] <= 0.0 for contact in contacts)

    def link_position(self, simulation: Any, link: str) -> np.ndarray:
        if link == "torso":
            return np.array(simulation.torso_state().position)
        return np.array(self._state(simulation, link)[4])

    def link_velocity(self, simulation: Any, link: str) -> np.ndarray:
        """Of a link's centre of mass, in the world's frame."""
        if link == "torso":
            return np.array(simulation.torso_state().velocity)
        return np.array(self._state(simulation, link)[6])

    @staticmethod
    def _dynamics(simulation: Any, link: str) -> Any:
        return pybullet.getDynamicsInfo(simulation.body, simulation.links[link], physicsClientId=simulation.client)

    @staticmethod
    def _state(simulation: Any, link: str) -> Any:
        return pybullet.getLinkState(
            simulation.body,
            simulation.links[link],
            computeLinkVelocity=1,
            computeForwardKinematics=1,
            physicsClientId=simulation.client,
        )


class MujocoLaboratory:
    """MuJoCo's, with the same methods."""

    engine = "mujoco"

    def place(self, simulation: Any, height: float = 30.0, roll: float = 0.0, pitch: float = 0.0) -> None:
        x, y, z, w = turned(roll, pitch)
        simulation.data.qpos[:7] = (0.0, 0.0, height, w, x, y, z)
        simulation.look()

    def turn(self, simulation: Any, rate: Sequence[float]) -> None:
        import mujoco

        in_torso = np.zeros(3)
        mujoco.mju_negQuat(to_torso := np.zeros(4), simulation.data.qpos[3:7])
        mujoco.mju_rotVecQuat(in_torso, np.array(rate), to_torso)
        simulation.data.qvel[:6] = (0.0, 0.0, 0.0, *in_torso)
        simulation.look()

    def move_joint(self, simulation: Any, name: str, position: float, speed: float) -> None:
        joint = simulation.data.joint(name)
        joint.qpos[0], joint.qvel[0] = position, speed

    def remove_pads(self, simulation: Any) -> None:
        for side, plate in product(Side, PLATES):
            simulation.model.geom(f"{side}_{plate}_pad").pos[2] += 1.0

    def mass(self, simulation: Any, link: str) -> float:
        return float(simulation.model.body(link).mass[0])

    def friction_under(self, simulation: Any, side: Side) -> set[float]:
        model = simulation.model
        soles = [index for index in range(model.ngeom) if model.geom(index).name.startswith(f"{side}_")]
        pairs = (model.pair_dim == 3) & np.isin(model.pair_geom2, soles)
        return {float(friction) for friction in model.pair_friction[pairs, :2].ravel()}

    def touches_ground(self, simulation: Any, position: Sequence[float]) -> bool:
        import mujoco

        model, data = simulation.model, simulation.data
        floor, sole = model.geom("floor").id, model.geom("left_forefoot_sole_0").id
        mujoco.mj_kinematics(model, data)
        data.geom_xpos[sole] = position
        mujoco.mj_collision(model, data)
        return any({*contact.geom} == {floor, sole} and contact.dist <= 0.0 for contact in data.contact)

    def link_position(self, simulation: Any, link: str) -> np.ndarray:
        import mujoco

        mujoco.mj_kinematics(simulation.model, simulation.data)
        return np.array(simulation.data.body(link).xpos)

    def link_velocity(self, simulation: Any, link: str) -> np.ndarray:
        import mujoco

        model, data = simulation.model, simulation.data
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_comVel(model, data)
        velocity = np.zeros(6)
        mujoco.mj_objectVelocity(
            model, data, mujoco.mjtObj.mjOBJ_BODY, model.body(link).id, velocity, 0
        )  # angular, then linear
        return velocity[3:]


def turned(roll: float, pitch: float) -> tuple[float, float, float, float]:
    """Unit quaternion (x, y, z, w) of a turn by ``pitch`` about x, and then by ``roll`` about y."""
    x, y = math.sin(pitch / 2), math.sin(roll / 2)
    w_x, w_y = math.cos(pitch / 2), math.cos(roll / 2)
    return w_y * x, y * w_x, -y * x, w_y * w_x


def purple(picture: np.ndarray) -> np.ndarray:
    """Which pixels have the colour of a push."""
    red, green, blue = np.moveaxis(picture.astype(int), -1, 0)
    return (red > green + 60) & (blue > green + 60)


Laboratory = BulletLaboratory | MujocoLaboratory
BuildSimulation = Callable[..., Simulator]
"""Function that builds a simulation of conditions and physics, which are both optional."""


def laboratory(engine: str) -> Laboratory:
    """An engine's laboratory; a test of an engine that is not installed is skipped."""
    need(engine)
    return BulletLaboratory() if engine == "pybullet" else MujocoLaboratory()


def advance(simulation: Simulator, ticks: int) -> None:
    for _ in range(ticks):
        simulation.advance()


def need(engine: str) -> None:
    """Skip the test that calls it if an engine is not installed."""
    if not is_installed(engine):
        pytest.skip(f"needs {engine}")


class NoPhysics:
    """A simulator in which nothing ever moves."""

    ground = LEVEL

    def __init__(self, *_: object) -> None:
        self.time = 0.0
        self.closed = False
        self.targets: list[tuple[float, ...]] = []

    def set_targets(self, targets: tuple[float, ...]) -> None:
        self.targets.append(targets)

    def push(self, force: Vector) -> None:
        raise AssertionError("nobody pushes in the First Training")

    def advance(self) -> None:
        self.time += CONTROL_DT

    def read(self) -> SensorReading:
        return SensorReading((0.0, 0.0, 9.81), (0.0, 0.0, 0.0), (75.0,) * 4, (0.0,) * 6)

    def torso_state(self) -> TorsoState:
        return TorsoState((0.0, 0.0, 0.84), (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))

    def actuator_motion(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        return (0.0,) * 6, (0.0,) * 6

    def joint_positions(self, names: tuple[str, ...]) -> tuple[float, ...]:
        return (0.0,) * len(names)

    def sole_height(self, side: Side) -> float:
        return 0.0

    def close(self) -> None:
        self.closed = True
