"""Commands say where the fast physics is known to mislead."""

from dataclasses import replace

import pytest
from laboratory import NEEDS_PYBULLET

from sarah.episode.accuracy import physics_warning
from sarah.episode.settings import EpisodeConfig
from sarah.episode.tasks import BALANCE, STEPPING, BalanceConfig
from sarah.robot.dimensions import default_dimensions
from sarah.simulation.physics import PHYSICS
from sarah.simulation.randomisation import Randomisation
from sarah.simulation.terrain import Terrain

LOW, PAPER = (0.02, 0.5, 0.6, 1.0, 1.0), (0.4, 1.3, 0.1, 1.0, 1.0)
LATE = EpisodeConfig(engine="pybullet", randomisation=Randomisation(delay_seconds=0.02))
PUNCTUAL = BalanceConfig(engine="pybullet", stepping=LOW, randomisation=Randomisation(delay_seconds=0.01))
BUMPS = EpisodeConfig(engine="pybullet", terrain=Terrain(roughness=(0.01, 0.01)))
LIGHT_FEET = {name: 0.1 * default_dimensions()[name] for name in ("forefoot_mass", "hindfoot_mass")}


@NEEDS_PYBULLET
@pytest.mark.parametrize(
    ("parameters", "config", "warns"),
    [
        (LOW, LATE, True),
        (PAPER, LATE, False),
        (LOW, EpisodeConfig(engine="pybullet"), False),  # 10 ms
        (LOW, replace(LATE, physics=PHYSICS["reference"]), False),
        (LOW, replace(LATE, randomisation=Randomisation(False, delay_seconds=0.02)), False),
        (LOW, replace(LATE, engine="mujoco"), False),
        ((1.0, 0.0, 1.0, 0.0), PUNCTUAL, True),  # hips that move are doubted with any delay
        ((0.0, 0.0, 0.0, 0.0), PUNCTUAL, False),
        (PAPER, replace(BUMPS, physics=replace(PHYSICS["standard"], rate=100)), True),
        (PAPER, replace(BUMPS, physics=replace(PHYSICS["standard"], rate=200)), False),
        (PAPER, EpisodeConfig(engine="pybullet", physics=replace(PHYSICS["standard"], rate=100)), False),
        (PAPER, EpisodeConfig(engine="pybullet", dimensions=LIGHT_FEET), True),
        (PAPER, EpisodeConfig(engine="mujoco", dimensions=LIGHT_FEET), False),
    ],
)
def test_where_physics_misleads_is_said(parameters: tuple[float, ...], config: EpisodeConfig, warns: bool) -> None:
    task = BALANCE if isinstance(config, BalanceConfig) else STEPPING
    assert (physics_warning(task, parameters, config) is not None) == warns
