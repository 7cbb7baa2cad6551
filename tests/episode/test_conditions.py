"""Other grounds and other robots: slopes, bumps, sizes and a payload, what they change and what they leave alone."""

import dataclasses
import math
from contextlib import closing
from typing import cast

import pytest
from laboratory import NoPhysics, turned

import sarah
from sarah import EpisodeConfig, EpisodeResult, EpisodeSpec, Physics
from sarah.envs.sarah_env import observation_from
from sarah.episode.episode import Episode, simulate
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.running_robot import RunningRobot
from sarah.episode.tasks.balance import TRAINED_STEPPING
from sarah.episode.workers import begin_episode
from sarah.robot.description import RobotDescription
from sarah.robot.dimensions import dimensions_alike
from sarah.robot.reading import GRAVITY
from sarah.scenery.ground import LEVEL
from sarah.simulation.engines import Engine
from sarah.simulation.randomisation import Conditions, Randomisation
from sarah.simulation.simulator import TorsoState
from sarah.simulation.terrain import Terrain, draw_ground

UPHILL_IN_FRONT = Terrain((20.0, 20.0), (90.0, 90.0))


class Leaning(NoPhysics):
    """A simulator whose robot leans backward all the time; it keeps the conditions that it was built with."""

    degrees = 0.0

    def __init__(self, robot: RobotDescription, physics: Physics, conditions: Conditions) -> None:
        super().__init__()
        self.conditions = conditions

    def torso_state(self) -> TorsoState:
        return super().torso_state()._replace(orientation=turned(0.0, math.radians(self.degrees)))


def conditions_of(config: EpisodeConfig, seed: int = 3) -> Conditions:
    return cast(Leaning, Episode(config, seed, build=Leaning).robot.simulation).conditions


def test_slope_changes_nothing_else_that_the_seed_draws() -> None:
    """And it is no matter of randomisation."""
    level, slope = conditions_of(EpisodeConfig()), conditions_of(EpisodeConfig(terrain=UPHILL_IN_FRONT))
    assert level.ground == LEVEL and slope.ground == draw_ground(UPHILL_IN_FRONT, 3) != LEVEL
    assert dataclasses.replace(slope, ground=LEVEL) == level
    config = EpisodeConfig(terrain=Terrain((0.0, 10.0)), randomisation=Randomisation(enabled=False))
    assert conditions_of(config, 1).ground != conditions_of(config, 2).ground


@pytest.mark.parametrize("strength", [1.0, 0.165])
def test_tilt_of_a_tick_is_from_gravitys_vertical(strength: float) -> None:
    tilts = []

    def reward(tick: sarah.Tick, config: EpisodeConfig) -> float:
        tilts.append(math.degrees(tick.tilt))
        return 1.0

    config = EpisodeConfig(terrain=UPHILL_IN_FRONT)
    conditions = conditions_of(config, 0)
    x, y, z = (strength * component for component in conditions.ground.gravity)
    other = dataclasses.replace(conditions, ground=dataclasses.replace(conditions.ground, gravity=(x, y, z)))
    task = dataclasses.replace(sarah.STEPPING, name="watched", reward=reward, best_reward=1.0)
    episode = Episode(config, 0, task, build=Leaning, conditions=other)
    episode.stand()
    episode.start(TRAINED_STEPPING)
    episode.tick()
    assert tilts == pytest.approx([20.0])


def step_on(engine: Engine, terrain: Terrain, seed: int = 3, seconds: float = 5.0) -> EpisodeResult:
    config = EpisodeConfig(engine=engine, time_limit=seconds, terrain=terrain)
    return simulate(EpisodeSpec(TRAINED_STEPPING, seed, config=config))


def test_robot_steps_on_bumps_and_slower_than_on_the_plane(engine: Engine) -> None:
    plane, bumps = (step_on(engine, Terrain(roughness=(height, height))) for height in (0.0, 0.01))
    assert bumps.survived and 1.5 < bumps.steps_per_second < plane.steps_per_second
    assert bumps.shifts_by_sensors > 0.8 and 0.02 < bumps.sole_clearance < 0.04


def test_an_episode_on_bumps_repeats_whatever_was_before(engine: Engine) -> None:
    terrain = Terrain(roughness=(0.0, 0.02), cell=(0.03, 0.06), friction_left=(0.2, 0.4))
    first = step_on(engine, terrain, seconds=1.5)
    step_on(engine, terrain, seed=4, seconds=1.5)
    assert step_on(engine, terrain, seconds=1.5) == first


PARAMETERS = PARAMETER_SETS["stepping"].spec.parameters


def stepping(engine: Engine, length: float, mass: float) -> EpisodeResult:
    """A robot of some size without errors of the sensors, for as many steps as any other."""
    time, dimensions = math.sqrt(length), dimensions_alike(length, mass)
    config = EpisodeConfig(engine=engine, dimensions=dimensions, step_frequency=3.0 / time, time_limit=1.0 + 8.0 * time)
    config = dataclasses.replace(config, randomisation=dataclasses.replace(config.randomisation, enabled=False))
    return simulate(EpisodeSpec(PARAMETERS, 0, config=config))


def test_a_robot_alike_steps_alike(engine: Engine) -> None:
    """The control rate stays, which is all that is not alike."""
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


def test_the_feet_carry_a_payload(engine: Engine) -> None:
    def load(payload: float) -> float:
        perfect, dimensions = Randomisation(enabled=False), {"torso_mass": 6.0, "hip_mass": 2.0}
        config = EpisodeConfig(engine=engine, randomisation=perfect, payload=payload, dimensions=dimensions)
        with closing(RunningRobot(config, 0)) as robot:
            return sum(robot.stand().pressures)

    assert load(6.0) - load(0.0) == pytest.approx(6.0 * GRAVITY, rel=0.05)


def test_a_payload_adds_to_what_the_seed_draws() -> None:
    without, carrying = (conditions_of(EpisodeConfig(payload=mass)).mass_factors for mass in (0.0, 4.0))
    assert {**carrying, "torso": carrying["torso"] - 4.0 / 8.0} == pytest.approx(without)
