"""MuJoCo's model of the robot, and what of MuJoCo all code in a process shares: callbacks and warnings."""

from __future__ import annotations

import copy
import math
import threading
from collections.abc import Callable
from functools import lru_cache

import mujoco

from sarah.errors import SimulationError
from sarah.robot.description import ANKLE_JOINTS, PLATES, RobotDescription
from sarah.robot.reading import ACTUATED_JOINTS, Side
from sarah.simulation.terrain import LARGEST_REACH, LARGEST_ROUGHNESS
from sarah.simulation.world import check_arithmetic

CONTACT_STEPS = 0.5
"""Time constant with which a contact stops what moves towards it, in physics steps."""
CONTACT_SECONDS = 0.015
"""Time constant with which contacts of the default robot correct errors of position, in s. MuJoCo finds a contact only
when the bodies overlap, and a faster correction would throw the foot up again."""
CONTACT_IMPEDANCE = 0.99
"""Impedance of contacts, from 0 to 1: share of the full constraint force that a contact applies."""
JOINT_DAMPING = 2.0
"""Factor on the URDF's joint damping, which PyBullet, the reference, applies twice."""
QUARTER_TURN = (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))
"""Rotation by 90 degrees about z, as MuJoCo's quaternion (w, x, y, z)."""
CALLBACKS = {
    name: getattr(mujoco, f"get_mjcb_{name}")
    for name in ("passive", "control", "contactfilter", "sensor", "act_dyn", "act_gain", "act_bias")
}
"""MuJoCo's callbacks that change what it computes, each with what returns it."""
_PASSIVE, _CONTROL, _FILTER, _SENSOR, _DYNAMICS, _GAIN, _BIAS = CALLBACKS.values()


def model_of(robot: RobotDescription, rate: int, solver_iterations: int, nodes: int) -> mujoco.MjModel:
    """A model of our own of a robot, as designed, on a plane or a field of nodes x nodes heights.

    Only soles touch the floor, and only pads touch their plates. A process compiles each model once.

    :param robot: checked robot
    :param rate: physics steps per second
    :param solver_iterations: largest number of iterations of the solver in a step
    :param nodes: number of heights along each side of the ground; 0 for a plane
    :return: a copy that the caller may change
    :raises SimulationError: if other code in the process changes what MuJoCo computes
    """
    check_arithmetic()
    check_callbacks()
    return copy.copy(_compiled(robot.urdf, robot.scale.time, rate, solver_iterations, nodes))


def check_callbacks() -> None:
    """Refuse a process in which MuJoCo calls other code in every simulation.

    :raises SimulationError: naming the callback
    """
    # In every tick; a loop would take three times as long.
    if _PASSIVE() or _CONTROL() or _FILTER() or _SENSOR() or _DYNAMICS() or _GAIN() or _BIAS():
        name = next(name for name, get in CALLBACKS.items() if get())
        raise SimulationError(
            f"other code in this process has set MuJoCo's callback mjcb_{name}, which would act on the robot too: "
            f"remove it with mujoco.set_mjcb_{name}(None)"
        )


class _Quiet:
    """A context in which MuJoCo warns nobody: a state that is not finite ends the episode.

    MuJoCo's own warning would also write a file where the process runs. What others set is put back when the last
    thread leaves.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._within = 0
        self._before: Callable[[str], None] | None = None

    def __enter__(self) -> None:
        with self._lock:
            if not self._within:
                self._before = mujoco.get_mju_user_warning()
                mujoco.set_mju_user_warning(_ignore)
            self._within += 1

    def __exit__(self, *_: object) -> None:
        with self._lock:
            self._within -= 1
            if not self._within:
                mujoco.set_mju_user_warning(self._before)


def _ignore(message: str) -> None:
    pass


WITHOUT_WARNINGS = _Quiet()
"""Context for MuJoCo's steps."""


def sole_name(side: Side, plate: str, index: int) -> str:
    """Name of the shape of a sole's contact in the model.

    :param side: side of the foot
    :param plate: name of the foot's plate
    :param index: number of the contact on that plate
    """
    return f"{side}_{plate}_sole_{index}"


@lru_cache(maxsize=32)
def _compiled(urdf: str, time_scale: float, rate: int, solver_iterations: int, nodes: int) -> mujoco.MjModel:
    spec = mujoco.MjSpec.from_string(urdf)
    spec.compiler.fusestatic = False  # otherwise the torso becomes part of the world
    spec.body("torso").add_freejoint()
    spec.option.timestep = 1.0 / rate
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_DISCRETE
    spec.option.iterations = solver_iterations
    spec.option.disableflags |= (
        mujoco.mjtDisableBit.mjDSBL_REFSAFE  # contacts stay as hard as asked
        | mujoco.mjtDisableBit.mjDSBL_AUTORESET  # a diverging simulation ends the episode instead of starting anew
        | mujoco.mjtDisableBit.mjDSBL_ISLAND  # there is only one robot
    )
    damping = rate / CONTACT_STEPS
    hardness = {
        "solref": (-damping / (CONTACT_SECONDS * time_scale), -damping),
        "solimp": (*[CONTACT_IMPEDANCE] * 2, 0.001, 0.5, 2.0),
    }
    for geom in spec.geoms:
        geom.contype = geom.conaffinity = 0
    if nodes:
        # Half of both sides, which an episode makes shorter; over and under 0.
        size = (2 * LARGEST_REACH, 2 * LARGEST_REACH, 2 * LARGEST_ROUGHNESS, LARGEST_ROUGHNESS)
        spec.add_hfield(name="floor", nrow=nodes, ncol=nodes, size=size, userdata=[0.0] * nodes**2)
        floor = spec.worldbody.add_geom(name="floor", type=mujoco.mjtGeom.mjGEOM_HFIELD, hfieldname="floor")
        floor.pos = (0.0, 0.0, -LARGEST_ROUGHNESS)
        floor.quat = QUARTER_TURN
    else:
        floor = spec.worldbody.add_geom(name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=(0, 0, 1))
    floor.contype = floor.conaffinity = 0
    for side in Side:
        # The pads are in the order of the URDF: the forefoot's first.
        for plate, pad in zip(PLATES, spec.body(f"{side}_shank").geoms, strict=True):
            pad.name = f"{side}_{plate}_pad"
            soles = 0
            for geom in spec.body(f"{side}_{plate}").geoms:
                if geom.type == mujoco.mjtGeom.mjGEOM_BOX:
                    geom.name = f"{side}_{plate}"
                    # This contact needs no friction: the hinge leaves nothing to slide.
                    spec.add_pair(geomname1=pad.name, geomname2=geom.name, condim=1, **hardness)
                    if nodes:  # plates are too high over a plane to touch it
                        spec.add_pair(geomname1="floor", geomname2=geom.name, condim=3, **hardness)
                    spec.add_sensor(
                        name=pad.name,
                        type=mujoco.mjtSensor.mjSENS_CONTACT,
                        objtype=mujoco.mjtObj.mjOBJ_GEOM,
                        objname=pad.name,
                        intprm=(1 << mujoco.mjtConDataField.mjCONDATA_FORCE.value, 2, 1),
                    )
                else:
                    geom.name = sole_name(side, plate, soles)
                    soles += 1
                    spec.add_pair(geomname1="floor", geomname2=geom.name, condim=3, **hardness)
    for name in (*ACTUATED_JOINTS, *ANKLE_JOINTS):
        joint = spec.joint(name)
        joint.actfrclimited = mujoco.mjtLimited.mjLIMITED_FALSE  # would clip what MuJoCo computes before a step
        joint.damping *= JOINT_DAMPING
        joint.solref_limit, joint.solimp_limit = hardness["solref"], hardness["solimp"]
    for name in ACTUATED_JOINTS:
        spec.add_actuator(
            name=name,
            target=name,
            trntype=mujoco.mjtTrn.mjTRN_JOINT,
            biastype=mujoco.mjtBias.mjBIAS_AFFINE,
        )
    return spec.compile()
