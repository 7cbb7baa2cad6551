"""Episodes on rough ground and on ground that slips."""

import dataclasses
from statistics import mean

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


def step_on(engine: Engine, terrain: Terrain, seed: int = 3) -> EpisodeResult:
    need(engine)
    config = EpisodeConfig(engine=engine, time_limit=6.0, terrain=terrain)
    return simulate(EpisodeSpec(TRAINED_STEPPING, seed, config=config))


@ENGINES
def test_bumps_of_no_height_score_as_the_plane_does(engine: Engine) -> None:
    flat, plane = (
        mean(step_on(engine, terrain, seed).score for seed in range(3))
        for terrain in (Terrain(roughness=(1e-9, 1e-9)), Terrain())
    )
    assert flat == pytest.approx(plane, abs=0.02)


@ENGINES
def test_robot_steps_on_bumps_and_slower_than_on_the_plane(engine: Engine) -> None:
    plane, bumps = (step_on(engine, Terrain(roughness=(height, height))) for height in (0.0, 0.01))
    assert bumps.survived and 1.5 < bumps.steps_per_second < plane.steps_per_second
    assert bumps.shifts_by_sensors > 0.8 and 0.02 < bumps.sole_clearance < 0.04


@ENGINES
def test_an_episode_on_bumps_repeats_whatever_was_simulated_before(engine: Engine) -> None:
    terrain = Terrain(roughness=(0.0, 0.02), cell=(0.03, 0.06), friction_left=(0.2, 0.4))
    first = step_on(engine, terrain)
    step_on(engine, Terrain())
    step_on(engine, terrain, seed=4)
    assert step_on(engine, terrain) == first


@ENGINES
def test_even_ground_is_simulated_as_if_there_were_no_bumps_and_no_texture(engine: Engine) -> None:
    """To the last byte, whatever the size of the cells would be."""
    assert step_on(engine, Terrain(cell=(0.03, 0.03))) == step_on(engine, Terrain())


@ENGINES
def test_friction_under_both_feet_is_the_friction_of_the_randomisation(engine: Engine) -> None:
    terrain = Terrain(friction_left=(0.4, 0.4), friction_right=(0.4, 0.4))
    need(engine)
    config = EpisodeConfig(engine=engine, time_limit=4.0)
    randomisation = dataclasses.replace(config.randomisation, friction=(0.4, 0.4))
    drawn = dataclasses.replace(config, randomisation=randomisation)
    textured = dataclasses.replace(config, terrain=terrain)
    assert simulate(EpisodeSpec(TRAINED_STEPPING, 1, config=drawn)) == simulate(
        EpisodeSpec(TRAINED_STEPPING, 1, config=textured)
    )
