"""Commands say where the fast physics is known to mislead."""

from dataclasses import replace
from pathlib import Path

import pytest
from laboratory import NEEDS_PYBULLET
from terminal import run

from sarah.episode.accuracy import physics_warning
from sarah.episode.settings import EpisodeConfig
from sarah.episode.tasks import BALANCE, STEPPING, BalanceConfig
from sarah.robot.dimensions import default_dimensions
from sarah.simulation.engines import Engine
from sarah.simulation.physics import PHYSICS
from sarah.simulation.randomisation import Randomisation
from sarah.simulation.terrain import Terrain

LOW, PAPER = (0.02, 0.5, 0.6, 1.0, 1.0), (0.4, 1.3, 0.1, 1.0, 1.0)
LATE = EpisodeConfig(engine="pybullet", randomisation=Randomisation(delay_seconds=0.02))


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
    ],
)
def test_a_low_p1_with_late_signals_at_coarse_physics_is_doubted(
    parameters: tuple[float, ...], config: EpisodeConfig, warns: bool
) -> None:
    assert (physics_warning(STEPPING, parameters, config) is not None) == warns


@NEEDS_PYBULLET
@pytest.mark.parametrize(
    ("balance", "delay_seconds", "warns"),
    [
        ((1.0, 0.0, 1.0, 0.0), 0.010, True),
        ((1.0, 0.0, 1.0, 0.0), 0.0, True),
        ((0.0, 0.0, 0.0, 0.0), 0.010, False),
        ((0.0, 0.0, 0.0, 0.0), 0.020, True),
    ],
)
def test_hips_that_move_are_doubted_with_any_delay(
    balance: tuple[float, ...], delay_seconds: float, warns: bool
) -> None:
    randomisation = Randomisation(delay_seconds=delay_seconds)
    config = BalanceConfig(engine="pybullet", stepping=LOW, randomisation=randomisation)
    assert (physics_warning(BALANCE, balance, config) is not None) == warns


@NEEDS_PYBULLET
@pytest.mark.parametrize(("rate", "roughness", "warns"), [(100, 0.01, True), (200, 0.01, False), (100, 0.0, False)])
def test_bumps_at_a_low_physics_rate_are_doubted(rate: int, roughness: float, warns: bool) -> None:
    physics = replace(PHYSICS["standard"], rate=rate)
    config = EpisodeConfig(engine="pybullet", physics=physics, terrain=Terrain(roughness=(roughness, roughness)))
    assert (physics_warning(STEPPING, PAPER, config) is not None) == warns


@NEEDS_PYBULLET
@pytest.mark.parametrize(
    ("share", "engine", "warns"), [(0.1, "pybullet", True), (0.1, "mujoco", False), (1.0, "pybullet", False)]
)
def test_light_feet_are_doubted_in_pybullet(share: float, engine: Engine, warns: bool) -> None:
    dimensions = {name: share * default_dimensions()[name] for name in ("forefoot_mass", "hindfoot_mass")}
    config = EpisodeConfig(engine=engine, dimensions=dimensions)
    assert (physics_warning(STEPPING, PAPER, config) is not None) == warns


@NEEDS_PYBULLET
def test_eval_says_it(tmp_path: Path) -> None:
    arguments = ("sarah-eval", ",".join(map(str, LOW)), "--episodes", "1", "--episode.time-limit", "2")
    assert (
        "--physics reference" in run(*arguments, "--episode.randomisation.delay-seconds", "0.02", cwd=tmp_path).stdout
    )
    assert "--physics reference" not in run(*arguments, cwd=tmp_path).stdout
