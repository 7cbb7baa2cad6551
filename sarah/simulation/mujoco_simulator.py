"""One robot in one MuJoCo world: build, act, sense, push.

Every episode changes its own copy of the robot's model: friction, masses, servos, gravity.
"""

from __future__ import annotations

import math

import mujoco
import numpy as np

from sarah.errors import SimulationError
from sarah.robot.description import ANKLE_JOINTS, PLATES, RobotDescription
from sarah.robot.reading import ACTUATED_JOINTS, SensorReading, Side, Vector
from sarah.simulation.mujoco_model import WITHOUT_WARNINGS, check_callbacks, model_of, sole_name
from sarah.simulation.physics import PHYSICS, Physics
from sarah.simulation.randomisation import NOMINAL, Conditions
from sarah.simulation.simulator import TorsoState, rotate_to_world, specific_force
from sarah.simulation.terrain import LARGEST_ROUGHNESS
from sarah.simulation.world import CHECKS, HoldsWorld, check_arithmetic, check_loaded

HIP_DAMPING, LEG_DAMPING = 10_000.0, 20_000.0
"""Effort per deviation from the speed that a servo of the default robot demands, in Nms/rad and Ns/m."""
LOWEST_RATE = 500
"""Lowest number of physics steps per second: contacts are softer at lower rates."""
FREE = mujoco.mjtJoint.mjJNT_FREE
"""Type of the joint between the world and the torso."""
STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS | mujoco.mjtState.mjSTATE_WARMSTART
"""State that a physics step begins with."""
NEAR_LIMIT = 0.5
"""Share of a servo's limit from which on the state before each physics step is saved, which may have to be repeated."""
Shares = tuple[float, float, float, float, float, float]
"""Efforts of the servos as shares of their limits, in the order of ``ACTUATED_JOINTS``."""


class MujocoSimulator(HoldsWorld):
    """A :class:`~sarah.simulation.simulator.Simulator` in MuJoCo.

    :param robot: checked robot
    :param physics: resolution in time, at least 500 Hz; the solver may converge, and stop, before its last iteration
    :param conditions: friction, masses, servo bandwidth and gravity of this episode
    :raises SimulationError: if what MuJoCo has loaded is not the robot, or if other code in the process acts on it; and
        later on, if other code resets it
    """

    model: mujoco.MjModel
    """MuJoCo's model of this robot, for any of MuJoCo's own functions."""
    data: mujoco.MjData
    """MuJoCo's state of it."""

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
        self._substeps = math.ceil(max(physics.rate, LOWEST_RATE) / physics.control_rate)
        rate = self._substeps * physics.control_rate
        nodes = len(self.ground.heights)
        self.model = model_of(robot, rate, physics.solver_iterations, nodes)
        self.data = mujoco.MjData(self.model)
        self._feet = {
            side: [
                self.model.geom(sole_name(side, plate, index)).id
                for plate in PLATES
                for index in range(len(robot.soles[f"{side}_{plate}"]))
            ]
            for side in Side
        }
        self._apply_conditions(rate, conditions)
        self._check_loaded(conditions)
        self._addresses = {name: int(self.model.joint(name).qposadr[0]) for name in (*ACTUATED_JOINTS, *ANKLE_JOINTS)}
        self._positions = [self._addresses[name] for name in ACTUATED_JOINTS]
        self._speeds = [int(self.model.joint(name).dofadr[0]) for name in ACTUATED_JOINTS]
        self._limits = [robot.efforts[name] for name in ACTUATED_JOINTS]
        shares = [damping / limit for damping, limit in zip(self._damping, self._limits, strict=True)]
        self._servos = list(zip(shares, self._positions, self._speeds, strict=True))
        self._before = np.empty(mujoco.mj_stateSize(self.model, STATE))
        self.data.qpos[2] = robot.standing_height + self.ground.lift(robot)
        # These are views of MuJoCo's memory.
        self._qpos, self._qvel, self._pads = self.data.qpos, self.data.qvel, self.data.sensordata
        self._pushed = self.data.xfrc_applied[self.model.body("torso").id, :3]
        self._is_pushed = False
        self._checks = 0
        self._settings: tuple[object, ...] = ()
        self._targets: tuple[float, ...] = (0.0,) * len(ACTUATED_JOINTS)
        self._shares: Shares = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        self.look()
        self._velocity_before = self._torso.velocity

    def _apply_conditions(self, rate: int, conditions: Conditions) -> None:
        model = self.model
        for link, factor in conditions.mass_factors.items():
            index = model.body(link).id
            model.body_mass[index] *= factor
            model.body_inertia[index] *= factor
        model.body_ipos[model.body("torso").id] += conditions.mass_offset
        mujoco.mj_setConst(model, self.data)  # updates what MuJoCo derives from the masses
        mujoco.mj_resetData(model, self.data)
        for side in Side:
            of_side = [model.geom(index).name.startswith(f"{side}_") for index in model.pair_geom2]
            model.pair_friction[of_side, :2] = conditions.friction_under(side)
        if conditions.is_slippery:  # otherwise pyramids, the default, are as good
            model.opt.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        model.opt.gravity[:] = self.ground.gravity
        if self.ground.is_rough:
            self._shape_ground()
        # MuJoCo takes the position at a step's end. With this rate a servo is the same first-order lag at every rate.
        self._rate = (math.exp(conditions.actuator_bandwidth / rate) - 1.0) * rate
        scale = self.robot.scale
        hip, leg = HIP_DAMPING * scale.factor("Nms/rad"), LEG_DAMPING * scale.factor("Ns/m")
        self._damping = [leg if name.endswith("leg_length") else hip for name in ACTUATED_JOINTS]
        for actuator in range(len(ACTUATED_JOINTS)):
            self._let_follow(actuator)

    def _check_loaded(self, conditions: Conditions) -> None:
        model = self.model
        masses = {link: float(model.body(link).mass[0]) for link in self.robot.masses}
        joints = [model.joint(index) for index in range(model.njnt) if model.jnt_type[index] != FREE]
        limits = {joint.name: (float(joint.range[0]), float(joint.range[1])) for joint in joints}
        x, y, z = model.opt.gravity.tolist()
        check_loaded("MuJoCo", self.robot, conditions, masses, limits, (x, y, z))

    def _shape_ground(self) -> None:
        """Give the compiled height field this episode's bumps.

        MuJoCo divides a cell along the other diagonal than the ground does, so its field is turned by 90 degrees.
        """
        heights, reach = np.array(self.ground.heights), self.ground.reach
        self.model.hfield_size[0, :2] = reach
        self.model.hfield_data[:] = (0.5 + 0.5 * heights[:, ::-1].T / LARGEST_ROUGHNESS).ravel()

    def _let_follow(self, actuator: int) -> None:
        """Let a servo follow its target."""
        damping = self._damping[actuator]
        self.model.actuator_gainprm[actuator, 0] = damping * self._rate
        self.model.actuator_biasprm[actuator, :3] = (0.0, -damping * self._rate, -damping)

    def _let_give(self, actuator: int, effort: float) -> None:
        """Let a servo apply an effort, in Nm or N, whatever its target."""
        self.model.actuator_gainprm[actuator, 0] = 0.0
        self.model.actuator_biasprm[actuator, :3] = (effort, 0.0, 0.0)

    def set_targets(self, targets: tuple[float, ...]) -> None:
        """Set where the servos move the joints from now on."""
        if targets != self._targets:  # the servos keep their targets
            self._targets = targets
            self.data.ctrl[:] = targets

    def push(self, force: Vector) -> None:
        """Push the torso at its centre during the next control tick."""
        self._pushed[:] = force
        self._is_pushed = True

    def advance(self) -> None:
        """Simulate one control tick."""
        model, data = self.model, self.data
        self._velocity_before = self._torso.velocity
        unsaved, largest = 0, 0.0
        with WITHOUT_WARNINGS:
            for _ in range(self._substeps):
                if unsaved == 0 or largest > NEAR_LIMIT:
                    mujoco.mj_getState(model, data, self._before, STATE)
                    unsaved = 0
                mujoco.mj_step(model, data)
                unsaved += 1
                shares = self._effort_shares()
                largest = _largest(shares)
                if largest > 1.0:
                    shares = self._step_again(shares, unsaved)
                    unsaved = 0
        self._shares = shares
        if self._is_pushed:  # MuJoCo keeps the force until it is reset
            self._pushed[:] = 0.0
            self._is_pushed = False
        self.time += self._dt
        self.look()

    def _step_again(self, shares: Shares, unsaved: int) -> Shares:
        """Repeat a physics step, in which servos that exceeded their limits apply their largest effort.

        :param shares: efforts of the servos in the step, as shares of their limits
        :param unsaved: number of steps since the state was saved, this one included
        :return: efforts in the repeated step, as shares of the limits
        """
        model, data, before = self.model, self.data, self._before
        if unsaved > 1:
            mujoco.mj_setState(model, data, before, STATE)
            mujoco.mj_step(model, data, unsaved - 1)
            mujoco.mj_getState(model, data, before, STATE)
        limited: dict[int, float] = {}
        while _largest(shares) > 1.0:
            for actuator, share in enumerate(shares):
                if abs(share) > 1.0:
                    limited[actuator] = math.copysign(1.0, share)
                    self._let_give(actuator, limited[actuator] * self._limits[actuator])
            mujoco.mj_setState(model, data, before, STATE)
            mujoco.mj_step(model, data)
            found = self._effort_shares()
            a, b, c, d, e, f = (limited.get(actuator, share) for actuator, share in enumerate(found))
            shares = a, b, c, d, e, f
        for actuator in limited:
            self._let_follow(actuator)
        return shares

    def _effort_shares(self) -> Shares:
        """Efforts of servos that follow their targets, after the last physics step, as shares of their limits."""
        x, v, rate = self._qpos.tolist(), self._qvel.tolist(), self._rate
        a, b, c, d, e, f = self._targets
        (ga, xa, va), (gb, xb, vb), (gc, xc, vc), (gd, xd, vd), (ge, xe, ve), (gf, xf, vf) = self._servos
        return (
            ga * (rate * (a - x[xa]) - v[va]),
            gb * (rate * (b - x[xb]) - v[vb]),
            gc * (rate * (c - x[xc]) - v[vc]),
            gd * (rate * (d - x[xd]) - v[vd]),
            ge * (rate * (e - x[xe]) - v[ve]),
            gf * (rate * (f - x[xf]) - v[vf]),
        )

    def torso_state(self) -> TorsoState:
        """True state of the torso, which no sensor of the robot measures."""
        return self._torso

    def look(self) -> None:
        """Query the motion of the torso from MuJoCo, after whatever changed it."""
        self._seen = self._qpos[:7].tolist()
        x, y, z, orientation_w, orientation_x, orientation_y, orientation_z = self._seen
        orientation = (orientation_x, orientation_y, orientation_z, orientation_w)
        velocity_x, velocity_y, velocity_z, *rate = self._qvel[:6].tolist()
        self._angular_rate: Vector = tuple(rate)  # MuJoCo gives it in the torso's frame
        angular_velocity = rotate_to_world(orientation, self._angular_rate)
        velocity = (velocity_x, velocity_y, velocity_z)
        self._torso: TorsoState = TorsoState((x, y, z), orientation, velocity, angular_velocity)

    def read(self) -> SensorReading:
        """True sensor signals of the last control tick, without noise or delay.

        :raises SimulationError: if other code in the process has reset the robot's world, or acts on it
        """
        positions = self._qpos.tolist()
        self._check_world(positions[:7])
        return SensorReading(
            specific_force(self._torso, self._velocity_before, self._dt, self.ground.gravity),
            self._angular_rate,
            tuple(self._pads[::3].tolist()),  # the first of three components is the normal force
            tuple([positions[index] for index in self._positions]),
        )

    def _check_world(self, pose: list[float]) -> None:
        """Refuse a world that other code has changed since the first check; its settings every tenth time."""
        check_callbacks()
        is_same = abs(self.data.time - self.time) < self._dt / 2 and (pose == self._seen or not self._torso.is_finite)
        if is_same and self._checks % CHECKS == 0:
            check_arithmetic()
            model = self.model
            settings = (model.opt.gravity.tolist(), model.opt.timestep, model.body_mass.tolist())
            self._settings = self._settings or settings
            is_same = settings == self._settings
        self._checks += 1
        if not is_same:
            raise SimulationError(
                "other code in this process has changed the robot's model in MuJoCo, or has reset, advanced or moved "
                "the robot: it must leave both alone"
            )

    def joint_positions(self, names: tuple[str, ...]) -> tuple[float, ...]:
        """Positions of some joints, in rad and m."""
        return tuple(float(self._qpos[self._addresses[name]]) for name in names)

    def actuator_motion(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Speeds (rad/s, m/s) and efforts (Nm, N) of the actuators, in the order of ``ACTUATED_JOINTS``."""
        speeds = self._qvel.tolist()
        efforts = [share * limit for share, limit in zip(self._shares, self._limits, strict=True)]
        return tuple([speeds[index] for index in self._speeds]), tuple(efforts)

    def sole_height(self, side: Side) -> float:
        """Height of a foot's lowest sole contact over the ground, in m."""
        mujoco.mj_kinematics(self.model, self.data)  # a step leaves the link positions of its beginning
        centres = self.data.geom_xpos.tolist()
        return min([self.ground.distance(centres[sole]) for sole in self._feet[side]]) - self.robot.contact_radius

    def close(self) -> None:
        """Do nothing: MuJoCo's memory is freed with the object."""


def _largest(shares: Shares) -> float:
    return max(max(shares), -min(shares))
