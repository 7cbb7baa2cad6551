"""The disturbances of an episode: what its seed draws, and its parameters do not choose.

They are known after the episode without a simulation, so a training can take their part out of the return.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from sarah.episode.push import DrawnPush
from sarah.robot.description import GROUPS
from sarah.simulation.randomisation import draw_conditions
from sarah.simulation.terrain import draw_terrain


def drawn_disturbances(spec: Any) -> tuple[float, ...]:
    """Disturbances of an episode whose settings and seed draw them. Bumps and errors of sensors are left out.

    :param spec: specification of the episode, an :class:`~sarah.episode.spec.EpisodeSpec`
    :return: 14 numbers: force of the push in N, sine and cosine of its direction, and time at which it begins in s;
        friction coefficient, the mean of both feet; bandwidth of the servos, per second; slope in degrees times cosine
        and sine of the direction uphill; mass of each group of links, as a factor; offset of the torso's centre of mass
        along x, y and z in m
    """
    config, seed = spec.config, spec.seed
    conditions, terrain = draw_conditions(config.randomisation, seed), draw_terrain(config.terrain, seed)
    frictions = [own[0] if own else conditions.friction for own in (terrain.friction_left, terrain.friction_right)]
    slope, uphill = terrain.slope_degrees[0], math.radians(terrain.direction_degrees[0])
    masses, factors = spec.robot.masses, conditions.mass_factors
    return (
        *_numbers_of(spec.task.draw_push(config, seed)),
        sum(frictions) / len(frictions),
        conditions.actuator_bandwidth,
        slope * math.cos(uphill),
        slope * math.sin(uphill),
        *(_mean_factor(links, masses, factors) for links in GROUPS.values()),
        *conditions.mass_offset,
    )


def _mean_factor(links: Sequence[str], masses: Mapping[str, float], factors: Mapping[str, float]) -> float:
    """Factor on the mass of several links together."""
    return sum(masses[link] * factors[link] for link in links) / sum(masses[link] for link in links)


def _numbers_of(push: DrawnPush | None) -> tuple[float, float, float, float]:
    """Force, sine, cosine and beginning of a push; zeros without one."""
    if push is None:
        return 0.0, 0.0, 0.0, 0.0
    x, y, z = push.force
    newtons = math.hypot(x, y, z)
    return newtons, newtons and y / newtons, newtons and x / newtons, push.begin
