"""Robots of other sizes do what the default one does, on another scale of time."""

import math
from dataclasses import replace

import pytest
from laboratory import need

from sarah.envs.sarah_env import observation_from
from sarah.episode.episode import simulate
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.result import EpisodeResult
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.workers import begin_episode
from sarah.robot.dimensions import dimensions_alike
from sarah.simulation.engines import Engine
from sarah.simulation.randomisation import Randomisation

PARAMETERS = PARAMETER_SETS["stepping"].spec.parameters


def stepping(engine: Engine, length: float, mass: float) -> EpisodeResult:
    """A robot of some size without errors of the sensors, for as many steps as any other."""
    time = math.sqrt(length)
    config = EpisodeConfig(
        engine=engine, dimensions=dimensions_alike(length, mass), step_frequency=3.0 / time, time_limit=1.0 + 8.0 * time
    )
    config = replace(config, randomisation=replace(config.randomisation, enabled=False))
    return simulate(EpisodeSpec(PARAMETERS, 0, config=config))


@pytest.mark.parametrize("engine", ["pybullet", "mujoco"])
def test_a_robot_alike_steps_alike(engine: Engine) -> None:
    """The control rate stays, which is all that is not alike."""
    need(engine)
    default, other = stepping(engine, 1.0, 1.0), stepping(engine, 0.3125, 4 / 30)
    assert other.survived and other.score == pytest.approx(default.score, abs=0.05)
    assert other.steps_per_second * math.sqrt(0.3125) == pytest.approx(default.steps_per_second, rel=0.12)
    assert other.sole_clearance / 0.3125 == pytest.approx(default.sole_clearance, rel=0.25)
    assert other.shifts_by_sensors > 0.9 and other.lifts_by_sensors > 0.9


def test_what_an_agent_sees_of_a_robot_alike_is_alike() -> None:
    seen = []
    for length, mass in ((1.0, 1.0), (0.3125, 4 / 30), (4.0, 20.0)):
        config = EpisodeConfig(dimensions=dimensions_alike(length, mass), randomisation=Randomisation(enabled=False))
        seen.append(observation_from(begin_episode(EpisodeSpec(PARAMETERS, 0, config=config)), config.scale))
    assert all(other == pytest.approx(seen[0], abs=0.1) for other in seen[1:])
