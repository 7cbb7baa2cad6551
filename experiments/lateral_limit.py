"""What decides whether the robot survives a push to the side: the energy that it lacks to tip over when the push ends.

A rigid body that turns about the outer edge of its foot tips over if its kinetic energy there exceeds what it takes to
lift its centre of mass over the edge:

    lacking energy = m g (r - z) - L^2 / (2 I)

r is the distance of the centre of mass from the edge, z its height, and L and I the robot's angular momentum and
inertia about the edge. Above zero a rigid body falls back onto its feet, and below it tips over.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise, product
from typing import NamedTuple

from experiments.conditions import HIPS, LATERAL, LEARNED
from experiments.maker import ParallelExperiment
from experiments.record import Row
from sarah.control.constants import ControllerConstants
from sarah.episode.episode import Episode
from sarah.episode.push import Push
from sarah.episode.spec import FIRST_EVALUATION_SEED
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.episode.workers import Workers
from sarah.reports.robustness import wilson_interval
from sarah.robot.description import PLATES
from sarah.robot.reading import GRAVITY, Side, Vector
from sarah.simulation.pybullet_simulator import PyBulletSimulator
from sarah.simulation.pybullet_world import pybullet
from sarah.simulation.simulator import rotate_to_body, rotate_to_world

ENERGIES = (-math.inf, -2.0, -1.0, 0.0, 1.0, math.inf)
"""Ends of the groups of lacking energies, in J."""
CONTROLLERS = {
    "learned": (HIPS["learned"], ControllerConstants()),
    "learned, no spread": (HIPS["learned"], ControllerConstants(spread_gain=0.0)),
    "V = 0": (HIPS["V = 0"], ControllerConstants()),
}
"""V1 to V4 and the controller's constants, by name."""


class Motion(NamedTuple):
    """A body of the robot, in the world's frame.

    :param mass: mass, in kg
    :param inertia: principal moments of inertia, in kg m^2
    :param position: position of its centre of mass, in m
    :param orientation: orientation of its principal axes, as a unit quaternion (x, y, z, w)
    :param velocity: velocity of its centre of mass, in m/s
    :param rate: angular velocity, in rad/s
    """

    mass: float
    inertia: Vector
    position: Vector
    orientation: tuple[float, float, float, float]
    velocity: Vector
    rate: Vector


def motions(simulation: PyBulletSimulator) -> list[Motion]:
    """All bodies of a robot.

    :param simulation: simulation of the robot
    """
    client, body = simulation.client, simulation.body
    links = list(range(pybullet.getNumJoints(body, physicsClientId=client)))
    base = pybullet.getBasePositionAndOrientation(body, physicsClientId=client)
    moving = [(*base, *pybullet.getBaseVelocity(body, physicsClientId=client))]
    for state in pybullet.getLinkStates(body, links, 1, 1, client):  # with velocities and forward kinematics
        moving.append((state[0], state[1], state[6], state[7]))
    dynamics = [pybullet.getDynamicsInfo(body, link, physicsClientId=client) for link in (-1, *links)]
    return [Motion(values[0], values[2], *state) for values, state in zip(dynamics, moving, strict=True)]


def outer_edge(simulation: PyBulletSimulator, side: Side) -> float:
    """Lateral position of the outermost sole contact of a foot, in m.

    :param simulation: simulation of the robot
    :param side: side of the foot
    """
    plates = [f"{side}_{name}" for name in PLATES]
    links = [simulation.links[plate] for plate in plates]
    states = pybullet.getLinkStates(simulation.body, links, 0, 1, simulation.client)
    across = [
        state[4][0] + rotate_to_world(state[5], sole)[0]
        for plate, state in zip(plates, states, strict=True)
        for sole in simulation.robot.soles[plate]
    ]
    return max(across) if side is Side.RIGHT else min(across)


def lacking_energy(bodies: list[Motion], edge: float, side: Side) -> float:
    """Energy that a rigid body with these motions lacks to tip over an edge on the floor, in J.

    :param bodies: bodies that move as one
    :param edge: lateral position of the edge, in m
    :param side: side to which it would tip
    """
    mass = sum(body.mass for body in bodies)
    x = sum(body.mass * body.position[0] for body in bodies) / mass - edge
    z = sum(body.mass * body.position[2] for body in bodies) / mass
    momentum = inertia = 0.0
    for body in bodies:
        arm_x, arm_z = body.position[0] - edge, body.position[2]
        spin = rotate_to_body(body.orientation, body.rate)
        axis = rotate_to_body(body.orientation, (0.0, 1.0, 0.0))
        own = [moment * component for moment, component in zip(body.inertia, axis, strict=True)]
        momentum += body.mass * (arm_z * body.velocity[0] - arm_x * body.velocity[2])
        momentum += sum(moment * component for moment, component in zip(own, spin, strict=True))
        inertia += body.mass * (arm_x * arm_x + arm_z * arm_z)
        inertia += sum(moment * component for moment, component in zip(own, axis, strict=True))
    outward = max(0.0, side.value * momentum)
    return mass * GRAVITY * (math.hypot(x, z) - z) - outward * outward / (2.0 * inertia)


class Outcome(NamedTuple):
    """What became of a push.

    :param lacking: energy that the robot lacked to tip over when the push ended, in J
    :param survived: whether it survived
    """

    lacking: float
    survived: bool


def simulate(controller: str, index: int, newtons: float, time_limit: float) -> Outcome:
    """Push a robot to the right or to the left, in turn.

    :param controller: one of :data:`CONTROLLERS`
    :param index: index of the episode, from 0
    :param newtons: force of the push, in N
    :param time_limit: time limit, in s; it must not end during the push
    """
    degrees, side = LATERAL[index % 2], (Side.RIGHT, Side.LEFT)[index % 2]
    push = Push((newtons, newtons), (degrees, degrees), at_seconds=(2.0, 3.0))
    hips, constants = CONTROLLERS[controller]
    config = BALANCE.config_of(
        LEARNED.config, push=push, engine="pybullet", time_limit=time_limit, controller=constants
    )
    lacking = math.nan
    with Episode(config, FIRST_EVALUATION_SEED + index, BALANCE) as episode:
        simulation = episode.robot.simulation
        assert isinstance(config, BalanceConfig) and episode.push is not None
        assert isinstance(simulation, PyBulletSimulator)
        end = episode.push.begin + episode.push.duration
        episode.stand()
        episode.start(hips)
        while episode.termination is None:
            episode.tick()
            if math.isnan(lacking) and simulation.time > end - config.physics.control_dt / 2:
                lacking = lacking_energy(motions(simulation), outer_edge(simulation, side), side)
        return Outcome(lacking, episode.result().survived)


@dataclass(frozen=True)
class LateralLimit(ParallelExperiment):
    """Pushes to the right and to the left in turn, in PyBullet: the shipped parameters with their spread and without.

    :param newtons: forces of the pushes, in N
    :param pushes: number of pushes of each force
    :param time_limit: time limit, in s
    """

    newtons: tuple[float, ...] = (100.0, 125.0, 150.0)
    pushes: int = 120
    time_limit: float = 8.0

    def rows(self) -> Iterator[Row]:
        """A row for each controller and group of lacking energies."""
        with Workers(self.workers) as workers:
            for controller in CONTROLLERS:
                jobs = [
                    workers.submit(simulate, controller, index, newtons, self.time_limit)
                    for newtons, index in product(self.newtons, range(self.pushes))
                ]
                outcomes: list[Outcome] = [job.result() for job in jobs]
                for low, high in pairwise(ENERGIES):
                    group = [outcome for outcome in outcomes if low <= outcome.lacking < high]
                    survivors = sum(outcome.survived for outcome in group)
                    interval = wilson_interval(survivors, len(group)) if group else (None, None)
                    yield {
                        "controller": controller,
                        "lacking": named(low, high),
                        "pushes": len(group),
                        "survivors": survivors,
                        "survival": survivors / len(group) if group else None,
                        "survival_low": interval[0],
                        "survival_high": interval[1],
                    }


def named(low: float, high: float) -> str:
    """Name of a group of lacking energies.

    :param low: lower end, in J
    :param high: upper end, in J
    """
    if math.isinf(low):
        return f"below {high:g} J"
    return f"over {low:g} J" if math.isinf(high) else f"{low:g} to {high:g} J"
