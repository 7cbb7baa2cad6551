"""Episodes on slopes: what a slope changes, and what it leaves alone."""

import dataclasses
import math

import pytest
from laboratory import NoPhysics, need, turned

import sarah
from sarah.episode.episode import Episode, simulate
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks.balance import TRAINED_STEPPING
from sarah.robot.description import RobotDescription
from sarah.scenery.ground import LEVEL
from sarah.simulation.engines import Engine
from sarah.simulation.physics import Physics
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
    episode = Episode(config, seed, build=Leaning)
    assert isinstance(episode.robot.simulation, Leaning)
    return episode.robot.simulation.conditions


def test_slope_changes_nothing_else_that_the_seed_draws() -> None:
    level, slope = conditions_of(EpisodeConfig()), conditions_of(EpisodeConfig(terrain=UPHILL_IN_FRONT))
    assert level.ground == LEVEL and slope.ground == draw_ground(UPHILL_IN_FRONT, 3) != LEVEL
    assert dataclasses.replace(slope, ground=LEVEL) == level


def test_slope_is_no_matter_of_randomisation() -> None:
    config = EpisodeConfig(terrain=Terrain((0.0, 10.0)), randomisation=Randomisation(enabled=False))
    assert conditions_of(config, 1).ground != conditions_of(config, 2).ground


@pytest.mark.parametrize("strength", [1.0, 0.165])
def test_tilt_of_a_tick_is_from_gravitys_vertical(strength: float) -> None:
    tilts = []

    def reward(tick: sarah.Tick, config: EpisodeConfig) -> float:
        tilts.append(math.degrees(tick.tilt))
        return 1.0

    task = dataclasses.replace(sarah.STEPPING, name="watched", reward=reward, best_reward=1.0)
    config = EpisodeConfig(terrain=UPHILL_IN_FRONT)
    conditions = conditions_of(config, 0)
    x, y, z = conditions.ground.gravity
    ground = dataclasses.replace(conditions.ground, gravity=(strength * x, strength * y, strength * z))
    other = dataclasses.replace(conditions, ground=ground)
    episode = Episode(config, 0, task, build=Leaning, conditions=other)
    episode.stand()
    episode.start(TRAINED_STEPPING)
    episode.tick()
    assert tilts == pytest.approx([20.0])


@pytest.mark.parametrize("engine", ["pybullet", "mujoco"])
def test_robot_steps_on_a_gentle_slope_and_slides_on_a_steep_one(engine: Engine) -> None:
    need(engine)
    gentle, steep = (
        simulate(EpisodeSpec(TRAINED_STEPPING, 0, config=EpisodeConfig(engine=engine, time_limit=5.0, terrain=terrain)))
        for terrain in (Terrain((3.0, 3.0), (90.0, 90.0)), UPHILL_IN_FRONT)
    )
    assert gentle.survived and gentle.score > 0.7
    assert steep.termination == "left_box" and steep.final_position[1] < -0.25
