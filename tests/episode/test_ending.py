"""How an episode ends."""

import math
from typing import Any

import numpy as np
import pytest

from sarah.control.constants import ControllerConstants
from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import Phase
from sarah.episode.ending import TERMINATIONS, ending_words, paper_ending
from sarah.episode.episode import Episode, simulate
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tick import Tick
from sarah.robot.reading import SensorReading, Side, Vector
from sarah.simulation.physics import PHYSICS
from sarah.simulation.simulator import TorsoState

SHORT = EpisodeConfig(time_limit=6.0)
AT_REST = SensorReading((0.0, 0.0, 9.81), (0.0,) * 3, (75.0,) * 4, (0.0,) * 6)


def ending(state: TorsoState, start: Vector, steps: int, time: float, vertical: Vector = (0.0, 0.0, 1.0)) -> str | None:
    """How an episode ends in which a tick has brought the torso there."""
    nobody: Any = None  # the endings do not ask the simulator
    return paper_ending(
        Tick(time, start, state, steps, 3.0, Phase.SHIFT, Side.LEFT, AT_REST, AT_REST, nobody, vertical),
        EpisodeConfig(),
    )


def test_robot_that_does_not_step_is_stopped_after_5_seconds() -> None:
    """With conditions that no rocking meets and the slowest time-outs it makes no two steps in time."""
    config = EpisodeConfig(controller=ControllerConstants(rate_scale=10.0))
    result = simulate(EpisodeSpec((2.0, 2.0, 2.0, 2.0, 2.0), seed=0, config=config))
    assert result.termination == "no_oscillation"
    assert result.duration == 5.0
    assert result.score < 0.01


@pytest.mark.parametrize(
    ("state", "steps", "time", "expected"),
    [
        (TorsoState((0.0, 0.0, 0.84), (0, 0, 0, 1), (0, 0, 0), (0, 0, 0)), 9, 10.0, None),
        (TorsoState((0.251, 0.0, 0.84), (0, 0, 0, 1), (0, 0, 0), (0, 0, 0)), 9, 10.0, "left_box"),
        (TorsoState((0.0, -0.251, 0.84), (0, 0, 0, 1), (0, 0, 0), (0, 0, 0)), 9, 10.0, "left_box"),
        (TorsoState((0.0, 0.0, 0.58), (0, 0, 0, 1), (0, 0, 0), (0, 0, 0)), 9, 10.0, "left_box"),
        (TorsoState((0.0, 0.0, 0.84), (0.4, 0, 0, 0.917), (0, 0, 0), (0, 0, 0)), 9, 10.0, "fell"),  # 47 degrees
        (TorsoState((0.0, 0.0, 0.84), (0.37, 0, 0, 0.929), (0, 0, 0), (0, 0, 0)), 9, 10.0, None),  # 43 degrees
        (TorsoState((0.0, 0.0, 0.84), (0, 0, 0, 1), (0, 0, 0), (0, 0, 0)), 1, 4.99, None),
        (TorsoState((0.0, 0.0, 0.84), (0, 0, 0, 1), (0, 0, 0), (0, 0, 0)), 1, 5.0, "no_oscillation"),
        (TorsoState((0.0, 0.0, 0.84), (0, 0, 0, 1), (0, 0, 0), (0, 0, 0)), 9, 30.0, None),
    ],
)
def test_stop_criteria(state: TorsoState, steps: int, time: float, expected: str | None) -> None:
    start = (0.0, 0.0, 0.84)
    assert ending(state, start, steps, time) == expected
    assert expected is None or expected in TERMINATIONS


def standing(position: tuple[float, float, float], degrees: float = 0.0) -> TorsoState:
    """A torso at rest, tilted about x."""
    half = math.radians(degrees) / 2
    return TorsoState(position, (math.sin(half), 0.0, 0.0, math.cos(half)), (0.0,) * 3, (0.0,) * 3)


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_criteria_of_the_box_it_ends_25_cm_from_the_start(axis: int, sign: float) -> None:
    """Wherever the episode began. The numbers are multiples of 1/16 m, and exact."""
    start = (0.5, -0.75, 1.0)
    for moved, expected in ((0.1875, None), (0.25, None), (0.26, "left_box")):
        position = list(start)
        position[axis] += sign * moved
        assert ending(standing(tuple(position)), start, 9, 10.0) == expected


@pytest.mark.parametrize(("degrees", "expected"), [(44.5, None), (45.5, "fell"), (-44.5, None), (-45.5, "fell")])
def test_criteria_of_a_fall_it_is_a_tilt_beyond_45_degrees(degrees: float, expected: str | None) -> None:
    start = (0.0, 0.0, 0.84)
    assert ending(standing(start, degrees), start, 9, 10.0) == expected


@pytest.mark.parametrize(
    ("degrees", "expected"), [(0.0, None), (24.5, None), (25.5, "fell"), (-64.5, None), (-65.5, "fell")]
)
def test_criteria_of_a_fall_on_a_slope_the_tilt_is_from_gravitys_vertical(degrees: float, expected: str | None) -> None:
    """Where 20 degrees lead uphill in front, a torso along the ground's normal already leans backward by as much."""
    start, slope = (0.0, 0.0, 0.84), math.radians(20.0)
    vertical = (0.0, math.sin(slope), math.cos(slope))
    assert ending(standing(start, degrees), start, 9, 10.0, vertical) == expected


@pytest.mark.parametrize(
    ("steps", "time", "expected"),
    [
        (1, 4.994, None),
        (1, 4.995, None),
        (1, 4.996, "no_oscillation"),
        (2, 5.0, None),  # one with each leg
    ],
)
def test_criteria_of_time_count_from_half_a_tick_before(steps: int, time: float, expected: str | None) -> None:
    """A sum of ticks of 10 ms is rounded, so 5 s are met by less than 5 ms."""
    start = (0.0, 0.0, 0.84)
    assert ending(standing(start), start, steps, time) == expected


@pytest.mark.parametrize("rate", [100, 130, 170])
def test_the_time_limit_is_met_to_half_a_tick(rate: int) -> None:
    """Whatever the rounding of a sum of ticks."""
    physics = PHYSICS["standard"].at_control_rate(rate)
    result = simulate(EpisodeSpec(PAPER_STEPPING, 0, config=EpisodeConfig(time_limit=3.0, physics=physics)))
    assert result.termination == "time_limit" and abs(result.duration - 3.0) <= 0.5 / rate


def test_words_of_an_own_ending_are_its_name() -> None:
    assert ending_words("far_away") == "far away" and ending_words("fell") == "fell"


def test_diverging_physics_ends_with_a_finite_return(monkeypatch: pytest.MonkeyPatch) -> None:
    with Episode(SHORT, seed=0) as episode:
        episode.stand()
        healthy = episode.robot.simulation.torso_state
        calls = 0

        def diverging() -> TorsoState:
            nonlocal calls
            calls += 1
            state = healthy()
            return state._replace(position=(float("nan"),) * 3) if calls > 100 else state

        monkeypatch.setattr(episode.robot.simulation, "torso_state", diverging)
        result = episode.run(PAPER_STEPPING)
    assert result.termination == "diverged" and not result.survived
    assert np.isfinite([result.score, result.episode_return, *result.final_position]).all()
