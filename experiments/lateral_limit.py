"""What decides whether the robot survives a push to the side: its margin of stability when the push ends.

The margin is that of Hof, Gazendam and Sinke (2005, J. Biomechanics 38): the distance from the extrapolated centre of
mass, x + v / sqrt(g / z), to the outer edge of the foot on the side that the robot is pushed to. A pendulum whose
margin is above zero comes to rest over that foot, whatever happens to its other foot.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise, product
from typing import NamedTuple

from experiments.conditions import HIPS, LATERAL, LEARNED
from experiments.experiment import OnWorkers
from experiments.record import Row
from sarah.episode.episode import Episode
from sarah.episode.push import Push
from sarah.episode.spec import FIRST_EVALUATION_SEED
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.episode.workers import Workers
from sarah.reports.robustness import wilson_interval
from sarah.robot.description import PLATES
from sarah.robot.reading import GRAVITY, Side
from sarah.simulation.pybullet_client import pybullet
from sarah.simulation.pybullet_simulator import PyBulletSimulator
from sarah.simulation.simulator import rotate_to_world

MARGINS_MM = (-math.inf, 20.0, 30.0, 40.0, 50.0, math.inf)
"""Ends of the groups of margins, in mm."""


class Outcome(NamedTuple):
    """What became of a push.

    :param margin: margin of stability at the end of the push, in m
    :param survived: whether the robot survived
    """

    margin: float
    survived: bool


def margin_of_stability(simulation: PyBulletSimulator, side: Side) -> float:
    """Distance from the extrapolated centre of mass to a foot's outer edge, in m; inside the foot is positive.

    :param simulation: simulation of the robot
    :param side: side of the foot
    """
    client, body = simulation.client, simulation.body
    links = range(pybullet.getNumJoints(body, physicsClientId=client))
    states = pybullet.getLinkStates(
        body, list(links), computeLinkVelocity=1, computeForwardKinematics=1, physicsClientId=client
    )
    base, _ = pybullet.getBasePositionAndOrientation(body, physicsClientId=client)
    velocity, _ = pybullet.getBaseVelocity(body, physicsClientId=client)
    motions = [(base, velocity), *((state[0], state[6]) for state in states)]
    masses = [pybullet.getDynamicsInfo(body, link, physicsClientId=client)[0] for link in (-1, *links)]

    def mean(part: int, axis: int) -> float:
        return sum(mass * motion[part][axis] for mass, motion in zip(masses, motions, strict=True)) / sum(masses)

    edge = max(
        side.value
        * (states[simulation.links[plate]][4][0] + rotate_to_world(states[simulation.links[plate]][5], sole)[0])
        for plate in (f"{side}_{name}" for name in PLATES)
        for sole in simulation.robot.soles[plate]
    )
    extrapolated = mean(0, 0) + mean(1, 0) / math.sqrt(GRAVITY / mean(0, 2))
    return edge - side.value * extrapolated


def simulate(hips: str, index: int, newtons: float, time_limit: float) -> Outcome:
    """Push a robot to the right or to the left, in turn.

    :param hips: name of V1 to V4
    :param index: index of the episode, from 0
    :param newtons: force of the push, in N
    :param time_limit: time limit, in s
    """
    degrees = LATERAL[index % 2]
    push = Push((newtons, newtons), (degrees, degrees), at_seconds=(2.0, 3.0))
    config = BALANCE.config_of(LEARNED.config, push=push, engine="pybullet", time_limit=time_limit)
    episode, margin = Episode(config, FIRST_EVALUATION_SEED + index, BALANCE), math.nan
    assert isinstance(config, BalanceConfig) and episode.push is not None
    end = episode.push.begin + episode.push.duration
    try:
        episode.stand()
        episode.start(HIPS[hips])
        while episode.termination is None:
            episode.tick()
            if math.isnan(margin) and episode.simulation.time > end - config.physics.control_dt / 2:
                assert isinstance(episode.simulation, PyBulletSimulator)
                margin = margin_of_stability(episode.simulation, Side.RIGHT if index % 2 == 0 else Side.LEFT)
        return Outcome(margin, episode.result().survived)
    finally:
        episode.close()


@dataclass(frozen=True)
class LateralLimit(OnWorkers):
    """Pushes to the right and to the left in turn, in PyBullet, with the shipped parameters and with V = 0.

    :param newtons: forces of the pushes, in N
    :param pushes: number of pushes of each force
    :param time_limit: time limit, in s
    """

    newtons: tuple[float, ...] = (100.0, 125.0, 150.0)
    pushes: int = 120
    time_limit: float = 8.0

    def rows(self) -> Iterator[Row]:
        """A row for each V, force and group of margins."""
        with Workers(self.workers) as workers:
            for hips, newtons in product(HIPS, self.newtons):
                jobs = [workers.submit(simulate, hips, index, newtons, self.time_limit) for index in range(self.pushes)]
                outcomes: list[Outcome] = [job.result() for job in jobs]
                for low, high in pairwise(MARGINS_MM):
                    group = [outcome for outcome in outcomes if low <= 1000.0 * outcome.margin < high]
                    survivors = sum(outcome.survived for outcome in group)
                    interval = wilson_interval(survivors, len(group)) if group else (None, None)
                    yield {
                        "hips": hips,
                        "push_n": f"{newtons:g}",
                        "margin": named(low, high),
                        "pushes": len(group),
                        "survivors": survivors,
                        "survival": survivors / len(group) if group else None,
                        "survival_low": interval[0],
                        "survival_high": interval[1],
                        "mean_margin_mm": 1000.0 * sum(outcome.margin for outcome in outcomes) / len(outcomes),
                    }


def named(low: float, high: float) -> str:
    """Name of a group of margins.

    :param low: lower end, in mm
    :param high: upper end, in mm
    """
    if math.isinf(low):
        return f"below {high:g} mm"
    return f"over {low:g} mm" if math.isinf(high) else f"{low:g} to {high:g} mm"
