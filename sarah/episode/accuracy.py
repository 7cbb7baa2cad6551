"""Where the fast settings of PyBullet are known to mislead (docs/explanation/physics.md)."""

from __future__ import annotations

from typing import Any

from sarah.control.hip_law import LOCKED_HIPS
from sarah.episode.settings import EpisodeConfig
from sarah.episode.task_answers import controller_of
from sarah.episode.tasks import Task
from sarah.robot.dimensions import all_dimensions
from sarah.robot.scale import MASS
from sarah.simulation.physics import PHYSICS

LOW_P1 = 0.1
"""P1 below which LIFT ends at the first sign of rocking back, in rad/s."""
LOWEST_ROUGH_RATE = 200
"""Physics steps per second below which PyBullet's feet get through bumps, in Hz."""
LATE_SECONDS = 0.015
"""Delay of the signals from which a robot with a low P1 and locked hips steps too fast, in s."""

LIGHT_FOOT = 0.015
"""Share of the robot's mass below which a foot is so light that PyBullet's solver does not hold it."""


def physics_warning(task: Task[Any], parameters: tuple[float, ...], config: EpisodeConfig) -> str | None:
    """Sentence that says why a score at this physics can be far off; ``None`` where none is known to be.

    :param task: task that owns the parameters
    :param parameters: values of the task's parameters, in order
    :param config: settings of the episodes
    """
    stepping, balance = controller_of(task, parameters, config)
    hips_move = balance not in (None, LOCKED_HIPS)
    is_coarse = config.engine == "pybullet" and config.physics.rate < PHYSICS["reference"].at_scale(config.scale).rate
    is_late = config.randomisation.enabled and config.randomisation.delay_seconds >= LATE_SECONDS
    if is_coarse and stepping.P1 < LOW_P1 and (is_late or hips_move):
        return f"with P1 below {LOW_P1:g} the score can be far off here: check it with --physics reference"
    if config.engine == "pybullet" and config.terrain.roughness[1] > 0.0 and config.physics.rate < LOWEST_ROUGH_RATE:
        return f"below {LOWEST_ROUGH_RATE} Hz PyBullet's feet sink into bumps: take more steps per second"
    if config.engine == "pybullet" and _foot_share(config) < LIGHT_FOOT:
        return f"PyBullet errs with feet below {LIGHT_FOOT:.1%} of the robot's mass: check it with --engine mujoco"
    return None


def _foot_share(config: EpisodeConfig) -> float:
    """Mass of a foot as a share of the robot's."""
    dimensions = all_dimensions(config.dimensions)
    return (dimensions["forefoot_mass"] + dimensions["hindfoot_mass"]) / (config.scale.mass * MASS)
