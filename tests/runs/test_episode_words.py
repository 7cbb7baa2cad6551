"""What is told of an episode beside its picture."""

import dataclasses

import pytest

from sarah.episode.episode import simulate
from sarah.episode.push import Push
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.episode.trace import Trace
from sarah.robot.dimensions import dimensions_alike
from sarah.runs.episode_words import differences, told_of
from sarah.simulation.terrain import Terrain, draw_terrain

SPEC = EpisodeSpec((1.0, 0.0, 1.0, 0.0), 5, BALANCE, BalanceConfig(time_limit=1.5, push=Push(40.0, 90.0, 1.2)))
USUAL = dataclasses.replace(SPEC, config=dataclasses.replace(BALANCE.episode, push=Push(0.0)))


@pytest.fixture(scope="module")
def trace() -> Trace:
    found = simulate(SPEC, record_trace=True).trace
    assert found is not None
    return found


@pytest.fixture(scope="module")
def still(trace: Trace) -> Trace:
    return dataclasses.replace(trace, push=0.0 * trace.push)


def test_the_pushes_of_the_trace_are_told(trace: Trace, still: Trace) -> None:
    assert told_of(SPEC, trace) == ["push of 40 N forward at 1.20 s", "time_limit 1.5"]
    assert told_of(SPEC, still) == ["time_limit 1.5"]  # it ended before its push


DIMENSIONS = dimensions_alike(1.1, 1.0)


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        ({}, []),
        ({"payload": 5.0}, ["payload 5"]),
        ({"dimensions": {"torso_width": 0.3, "hip_mass": 1.5}}, ["dimensions torso_width 0.3, hip_mass 1.5"]),
        (USUAL.config.for_robot(DIMENSIONS).__dict__, [f"{len(DIMENSIONS)} dimensions of its own"]),
        ({"stepping": (0.4, 1.3, 0.1, 1.0, 1.0)}, ["P1 to P5 0.40, 1.30, 0.10, 1.00, 1.00"]),
        ({"terrain": Terrain(friction_left=0.2)}, ["terrain.friction_left 0.2"]),
        ({"terrain": Terrain(roughness=0.01, reach=0.9)}, ["terrain.roughness 0.01", "terrain.reach 0.9"]),
    ],
)
def test_settings_that_differ_are_told(settings: dict[str, object], told: list[str], still: Trace) -> None:
    changed = dataclasses.replace(USUAL, config=dataclasses.replace(USUAL.config, **settings))
    assert told_of(changed, still) == told
    assert told_of(EpisodeSpec((0.4, 1.3, 0.1, 1.0, 1.0), 0), still) == []


def test_what_an_option_changes_has_both_values() -> None:
    changed = dataclasses.replace(USUAL.config, payload=3.0, stepping=(0.5, 1.0, 0.0, 1.0, 1.0))
    other = dataclasses.replace(USUAL.config, stepping=(0.5, 1.0, 0.0, 1.0, 0.75))
    stepping = "stepping 0.5, 1, 0, 1, 1 instead of 0.5, 1, 0, 1, 0.75"
    assert list(differences(changed, other)) == ["payload 3 instead of 0", stepping]


def test_the_ground_is_told_as_the_seed_draws_it(still: Trace) -> None:
    ranges = Terrain(slope_degrees=(2.0, 8.0), roughness=(0.0, 0.02))
    spec = EpisodeSpec((0.4, 1.3, 0.1, 1.0, 1.0), 5, config=EpisodeConfig(terrain=ranges))
    drawn = draw_terrain(ranges, 5)
    names = ("slope_degrees", "direction_degrees", "roughness")
    assert told_of(spec, still) == [f"terrain.{name} {getattr(drawn, name)[0]:.3g}" for name in names]
