"""One robot in one PyBullet world: build, act, sense, push.

A world is built for one episode and closed after it. Only a world that is built anew repeats an episode bit for bit;
poses that are reset in place, or a restored state, do not.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ElementTree
from itertools import product

from sarah.errors import SimulationError
from sarah.robot.description import ANKLE_JOINTS, PLATES, RobotDescription
from sarah.robot.reading import ACTUATED_JOINTS, SensorReading, Side, Vector
from sarah.simulation.physics import PHYSICS, Physics, PyBulletPhysics
from sarah.simulation.pybullet_world import PyBulletWorld, pybullet
from sarah.simulation.randomisation import NOMINAL, Conditions
from sarah.simulation.simulator import TorsoState, rotate_to_body, rotate_to_world, specific_force
from sarah.simulation.world import HoldsWorld, check_loaded

CONTACT_SECONDS = 0.0015
"""Time in which contacts of the default robot reduce errors of position to 1/e, in s. PyBullet takes a share per
physics step instead; with the same share at every rate, coarse steps would make the floor soft. With 1 ms a standing
robot creeps at 1 kHz."""
CONTACT_MARGIN = 0.0003
"""Distance at which the solver begins to consider a contact, in m, for a shape of 0.1 m or so: Bullet takes it in
proportion to the shape's size. With 2 mm, coarse steps damp the rocking more. PyBullet's 0.02 also costs time for feet
in the air."""


class PyBulletSimulator(HoldsWorld):
    """A :class:`~sarah.simulation.simulator.Simulator` in PyBullet.

    :param robot: checked robot
    :param physics: resolution in time
    :param conditions: friction, masses and servo bandwidth of this episode
    :raises SimulationError: if what PyBullet has loaded is not the robot; and later on, if other code in the process
        changes its world
    """

    client: int
    """Number of PyBullet's client, for any of PyBullet's own functions."""
    body: int
    """Number of the robot's body."""
    links: dict[str, int]
    """Index of each link, by its name and by that of the joint which carries it."""

    def __init__(
        self,
        robot: RobotDescription,
        physics: Physics = PHYSICS["standard"],
        conditions: Conditions = NOMINAL,
    ) -> None:
        self.robot = robot
        self.time = 0.0
        self._dt = physics.control_dt
        self.ground = conditions.ground
        self._substeps = physics.rate // physics.control_rate
        self._world = PyBulletWorld()
        self.client = self._world.client
        try:
            self._build(physics, conditions)
            self._check_loaded(conditions)
        except BaseException:
            self.close()
            raise

    def _build(self, physics: Physics, conditions: Conditions) -> None:
        corrected = 1.0 - math.exp(-1.0 / (physics.rate * CONTACT_SECONDS * self.robot.scale.time))
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=self._dt,
            numSubSteps=self._substeps,
            numSolverIterations=physics.solver_iterations,
            contactERP=corrected,
            numNonContactInnerIterations=2,  # motors settle before contacts do; otherwise standing soles creep
            enableConeFriction=conditions.is_slippery,  # otherwise pyramids are as good, and cheaper
            enableFileCaching=0,
            physicsClientId=self.client,
        )
        pybullet.setGravity(*self.ground.gravity, physicsClientId=self.client)
        self._build_floor()
        self.body, self.links = self._world.load_robot(
            self._urdf(conditions),
            self.robot.standing_height + self.ground.lift(self.robot),
            flags=pybullet.URDF_USE_INERTIA_FROM_FILE
            | pybullet.URDF_IGNORE_VISUAL_SHAPES
            # PyBullet reports contact between parent and child (pad and plate) only with both of these flags.
            | pybullet.URDF_USE_SELF_COLLISION
            | pybullet.URDF_USE_SELF_COLLISION_INCLUDE_PARENT,
        )
        self._joints = [self.links[name] for name in ACTUATED_JOINTS]
        self._pads: dict[tuple[int, int], int] = {}
        for index, (side, plate) in enumerate(product(Side, PLATES)):
            shank, foot = self.links[f"{side}_shank"], self.links[f"{side}_{plate}"]
            self._pads[shank, foot] = self._pads[foot, shank] = index
        self._feet = {}
        for side in Side:
            plates = [f"{side}_{plate}" for plate in PLATES]
            self._feet[side] = ([self.links[name] for name in plates], [self.robot.soles[name] for name in plates])
        self._keep_only_pad_contacts()
        self._apply_conditions(conditions)
        # A servo's share of the way in one physics step, which makes it the same first-order lag at every rate.
        gain = 1.0 - math.exp(-conditions.actuator_bandwidth / physics.rate)
        self._gains = [gain] * len(self._joints)
        self._added_plate_inertia = physics.added_plate_inertia if isinstance(physics, PyBulletPhysics) else 0.0
        self._plate_inertias = {
            link: pybullet.getDynamicsInfo(self.body, link, physicsClientId=self.client)[2]
            for links, _ in self._feet.values()
            for link in links
        }
        self._carries = [False] * len(self._plate_inertias)
        # PyBullet takes efforts as impulses over the whole tick, and lets every substep spend all of it.
        self._efforts = [self.robot.efforts[name] / self._substeps for name in ACTUATED_JOINTS]
        self.look()
        self._velocity_before = self._torso.velocity
        self._targets: tuple[float, ...] = ()
        self.set_targets((0.0,) * len(self._joints))

    def _urdf(self, conditions: Conditions) -> str:
        """The robot's description with the torso's centre of mass where it is; PyBullet cannot move it later."""
        x, y, z = self._mass_offset = conditions.mass_offset
        if self._mass_offset == NOMINAL.mass_offset:
            return self.robot.urdf
        root = ElementTree.fromstring(self.robot.urdf)
        origin = root.find("link[@name='torso']/inertial/origin")
        if origin is None:
            raise SimulationError("the robot's torso has no inertial origin")
        origin.set("xyz", f"{x!r} {y!r} {z!r}")
        return ElementTree.tostring(root, encoding="unicode")

    def _build_floor(self) -> None:
        if self.ground.is_rough:
            heights = [height for row in self.ground.heights for height in row]
            shape = pybullet.createCollisionShape(
                pybullet.GEOM_HEIGHTFIELD,
                meshScale=(self.ground.cell, self.ground.cell, 1.0),
                heightfieldData=heights,
                numHeightfieldRows=len(self.ground.heights),
                numHeightfieldColumns=len(self.ground.heights),
                physicsClientId=self.client,
            )
            middle = (min(heights) + max(heights)) / 2  # where PyBullet puts the frame of the shape
        else:
            shape, middle = pybullet.createCollisionShape(pybullet.GEOM_PLANE, physicsClientId=self.client), 0.0
        floor = pybullet.createMultiBody(0.0, shape, basePosition=(0.0, 0.0, middle), physicsClientId=self.client)
        pybullet.changeDynamics(floor, -1, lateralFriction=1.0, restitution=0.0, physicsClientId=self.client)
        self._world.own(floor)

    def _keep_only_pad_contacts(self) -> None:
        links = sorted(set(self.links.values()))
        for first in links:
            for second in links:
                if first < second and (first, second) not in self._pads:
                    pybullet.setCollisionFilterPair(self.body, self.body, first, second, 0, self.client)

    def _apply_conditions(self, conditions: Conditions) -> None:
        client = self.client
        frictions = {str(side): conditions.friction_under(side) for side in Side}
        for link, factor in conditions.mass_factors.items():  # contains every link
            index = self.links[link]
            dynamics = pybullet.getDynamicsInfo(self.body, index, physicsClientId=client)
            pybullet.changeDynamics(
                self.body,
                index,
                mass=dynamics[0] * factor,
                localInertiaDiagonal=[inertia * factor for inertia in dynamics[2]],
                lateralFriction=frictions.get(link.partition("_")[0], conditions.friction),
                restitution=0.0,
                linearDamping=0.0,
                angularDamping=0.0,
                physicsClientId=client,
            )
        # This is a call of its own: PyBullet would apply the other settings to the base instead of the link.
        pybullet.changeDynamics(
            self.body, -1, activationState=pybullet.ACTIVATION_STATE_DISABLE_SLEEPING, physicsClientId=client
        )
        for name in ANKLE_JOINTS:  # otherwise PyBullet's default motor holds them
            pybullet.setJointMotorControl2(
                self.body, self.links[name], pybullet.VELOCITY_CONTROL, force=0.0, physicsClientId=client
            )

    def _check_loaded(self, conditions: Conditions) -> None:
        body, client = self.body, self.client
        joints = [pybullet.getJointInfo(body, joint, client) for joint in range(pybullet.getNumJoints(body, client))]
        limits = {info[1].decode(): info[8:10] for info in joints}
        masses = {name: pybullet.getDynamicsInfo(body, self.links[name], client)[0] for name in self.robot.masses}
        world = pybullet.getPhysicsEngineParameters(client)
        gravity = (world["gravityAccelerationX"], world["gravityAccelerationY"], world["gravityAccelerationZ"])
        check_loaded("PyBullet", self.robot, conditions, masses, limits, gravity)

    def set_targets(self, targets: tuple[float, ...]) -> None:
        """Set where the servos move the joints from now on."""
        if targets == self._targets:  # the servos keep their targets
            return
        self._targets = targets
        pybullet.setJointMotorControlArray(
            self.body,
            self._joints,
            pybullet.POSITION_CONTROL,
            targetPositions=targets,
            forces=self._efforts,
            positionGains=self._gains,
            physicsClientId=self.client,
        )

    def _add_plate_inertia(self) -> None:
        """Give the plates that press on their pads the added inertia, and the others their own.

        Light plates between the floor and pads that carry a whole robot make the solver converge slowly. While a plate
        carries it hardly turns, so its inertia changes little else (docs/explanation/physics.md says how much).
        """
        for index, ((link, inertias), load) in enumerate(zip(self._plate_inertias.items(), self._loads, strict=True)):
            carries = load > 0.0
            if carries != self._carries[index]:
                self._carries[index] = carries
                about_hinge, *others = inertias
                inertia = (about_hinge + (self._added_plate_inertia if carries else 0.0), *others)
                pybullet.changeDynamics(self.body, link, localInertiaDiagonal=inertia, physicsClientId=self.client)

    def push(self, force: Vector) -> None:
        """Push the torso at its centre during the next control tick."""
        pybullet.applyExternalForce(
            self.body, -1, force, self._torso.position, pybullet.WORLD_FRAME, physicsClientId=self.client
        )

    def advance(self) -> None:
        """Simulate one control tick."""
        self._velocity_before = self._torso.velocity
        # Any code may have changed it since the last tick, because Bullet has one for all worlds of a process.
        pybullet.setPhysicsEngineParameter(contactBreakingThreshold=CONTACT_MARGIN, physicsClientId=self.client)
        pybullet.stepSimulation(physicsClientId=self.client)
        self.time += self._dt
        self.look()
        if self._added_plate_inertia:
            self._add_plate_inertia()

    def torso_state(self) -> TorsoState:
        """True state of the torso, which no sensor of the robot measures."""
        return self._torso

    def read(self) -> SensorReading:
        """True sensor signals of the last control tick, without noise or delay.

        :raises SimulationError: if other code in the process has changed the world
        """
        self._world.check(self._pose)
        torso = self._torso
        return SensorReading(
            specific_force(torso, self._velocity_before, self._dt, self.ground.gravity),
            rotate_to_body(torso.orientation, torso.angular_velocity),
            self._loads,
            self._positions,
        )

    def joint_positions(self, names: tuple[str, ...]) -> tuple[float, ...]:
        """Positions of some joints, in rad and m.

        :raises SimulationError: if other code in the process has changed the world
        """
        self._world.check()
        indices = [self.links[name] for name in names]
        return tuple(state[0] for state in pybullet.getJointStates(self.body, indices, self.client))

    def actuator_motion(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Speeds (rad/s, m/s) and efforts (Nm, N) of the actuators, in the order of ``ACTUATED_JOINTS``."""
        # PyBullet divides the impulse of the last substep by the whole tick.
        return self._speeds, tuple([effort * self._substeps for effort in self._joint_efforts])

    def look(self) -> None:
        """Query motion of torso and actuators, and the pads' loads, from PyBullet, after whatever changed them."""
        self._pose = pybullet.getBasePositionAndOrientation(self.body, physicsClientId=self.client)
        position, orientation = self._pose
        velocity, rate = pybullet.getBaseVelocity(self.body, physicsClientId=self.client)
        if self._mass_offset != NOMINAL.mass_offset:  # PyBullet gives the motion of the centre of mass
            x, y, z = rotate_to_world(orientation, self._mass_offset)
            position = (position[0] - x, position[1] - y, position[2] - z)
            velocity = (
                velocity[0] - (rate[1] * z - rate[2] * y),
                velocity[1] - (rate[2] * x - rate[0] * z),
                velocity[2] - (rate[0] * y - rate[1] * x),
            )
        self._torso = TorsoState(position, orientation, velocity, rate)
        self._positions, self._speeds, _, self._joint_efforts = zip(
            *pybullet.getJointStates(self.body, self._joints, self.client), strict=True
        )
        self._loads = self._pad_loads()

    def _pad_loads(self) -> tuple[float, float, float, float]:
        loads = [0.0, 0.0, 0.0, 0.0]
        for contact in pybullet.getContactPoints(self.body, self.body, physicsClientId=self.client):
            # PyBullet divides the impulse of the last substep by the whole tick.
            loads[self._pads[contact[3], contact[4]]] += contact[9] * self._substeps
        return (loads[0], loads[1], loads[2], loads[3])

    def sole_height(self, side: Side) -> float:
        """Height of a foot's lowest sole contact over the ground, in m."""
        lowest = math.inf
        links, soles = self._feet[side]
        states = pybullet.getLinkStates(self.body, links, computeForwardKinematics=1, physicsClientId=self.client)
        for state, contacts in zip(states, soles, strict=True):
            (x, y, z), orientation = state[4], state[5]
            for contact in contacts:
                along_x, along_y, along_z = rotate_to_world(orientation, contact)
                lowest = min(lowest, self.ground.distance((x + along_x, y + along_y, z + along_z)))
        return lowest - self.robot.contact_radius

    def close(self) -> None:
        """Give PyBullet's client back; the simulator cannot be used after that."""
        self._world.close()
