"""Episodes on rough ground and on ground that slips."""

import pytest
from laboratory import need

from sarah.episode.episode import simulate
from sarah.episode.result import EpisodeResult
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks.balance import TRAINED_STEPPING
from sarah.simulation.engines import Engine
from sarah.simulation.terrain import Terrain

ENGINES = pytest.mark.parametrize("engine", ["pybullet", "mujoco"])


def step_on(engine: Engine, terrain: Terrain, seed: int = 3, seconds: float = 5.0) -> EpisodeResult:
    need(engine)
    config = EpisodeConfig(engine=engine, time_limit=seconds, terrain=terrain)
    return simulate(EpisodeSpec(TRAINED_STEPPING, seed, config=config))


@ENGINES
def test_robot_steps_on_bumps_and_slower_than_on_the_plane(engine: Engine) -> None:
    plane, bumps = (step_on(engine, Terrain(roughness=(height, height))) for height in (0.0, 0.01))
    assert bumps.survived and 1.5 < bumps.steps_per_second < plane.steps_per_second
    assert bumps.shifts_by_sensors > 0.8 and 0.02 < bumps.sole_clearance < 0.04


@ENGINES
def test_an_episode_on_bumps_repeats_whatever_was_before(engine: Engine) -> None:
    terrain = Terrain(roughness=(0.0, 0.02), cell=(0.03, 0.06), friction_left=(0.2, 0.4))
    first = step_on(engine, terrain, seconds=1.5)
    step_on(engine, terrain, seed=4, seconds=1.5)
    assert step_on(engine, terrain, seconds=1.5) == first
