"""How an episode ends, also where an engine returns no numbers any more: as diverged, with a finite return."""

import math
from contextlib import nullcontext
from dataclasses import replace
from typing import Any

import pytest
from laboratory import COARSE_PHYSICS, RESULT, NoPhysics

from sarah import PHYSICS, EpisodeConfig, Evaluation, Tick
from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import STAND_SECONDS, Phase
from sarah.envs.sarah_env import observation_from
from sarah.episode.ending import TERMINATIONS, ending_words, is_ending, paper_ending
from sarah.episode.episode import Episode
from sarah.errors import SimulationError
from sarah.robot.reading import SensorReading, Side, Vector
from sarah.robot.scale import Scale
from sarah.simulation.simulator import TorsoState

START = (0.5, -0.75, 1.0)
AT_REST = SensorReading((0.0, 0.0, 9.81), (0.0,) * 3, (75.0,) * 4, (0.0,) * 6)


def ending(
    position: Vector = START, degrees: float = 0.0, steps: int = 9, time: float = 10.0, slope: float = 0.0
) -> Any:
    """How an episode ends in which a tick has brought the torso there, at rest and tilted about x."""
    half, uphill = math.radians(degrees) / 2, math.radians(slope)
    torso = TorsoState(position, (math.sin(half), 0.0, 0.0, math.cos(half)), (0.0,) * 3, (0.0,) * 3)
    nobody: Any = None  # the endings do not ask the simulator
    vertical = (0.0, math.sin(uphill), math.cos(uphill))
    tick = Tick(time, START, torso, steps, 3.0, Phase.SHIFT, Side.LEFT, AT_REST, AT_REST, nobody, vertical)
    return paper_ending(tick, EpisodeConfig())


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_criteria_of_the_box_it_ends_25_cm_from_the_start(axis: int, sign: float) -> None:
    """The numbers are multiples of 1/16 m, and exact."""
    for moved, expected in ((0.1875, None), (0.25, None), (0.26, "left_box")):
        x, y, z = (place + sign * moved * (index == axis) for index, place in enumerate(START))
        assert ending((x, y, z)) == expected


@pytest.mark.parametrize(("slope", "forward", "backward"), [(0.0, 45.0, -45.0), (20.0, 25.0, -65.0)])
def test_criteria_of_a_fall_it_is_a_tilt_beyond_45_degrees(slope: float, forward: float, backward: float) -> None:
    """Where 20 degrees lead uphill in front, a torso along the ground's normal already leans backward by as much."""
    tilts = (forward - 0.5, forward + 0.5, backward + 0.5, backward - 0.5)
    assert [ending(degrees=degrees, slope=slope) for degrees in tilts] == [None, "fell", None, "fell"]


def test_criteria_of_time_count_from_half_a_tick_before() -> None:
    """A sum of ticks of 10 ms is rounded, so 5 s are met by less than 5 ms. Two steps are one with each leg."""
    assert [ending(steps=1, time=time) for time in (4.994, 4.995, 4.996)] == [None, None, "no_oscillation"]
    assert [ending(steps=steps, time=time) for steps, time in ((2, 5.0), (9, 30.0))] == [None, None]


def test_criteria_of_a_name_ask_for_a_short_identifier() -> None:
    assert all(map(is_ending, ["fell", "x" * 40]))
    assert not any(map(is_ending, ["x" * 41, "far away", "", 3, None]))


@pytest.mark.parametrize("rate", [100, 130, 170])
def test_the_time_limit_is_met_to_half_a_tick(rate: int) -> None:
    config = EpisodeConfig(time_limit=3.0, physics=PHYSICS["standard"].at_control_rate(rate))
    episode = Episode(config, 0, build=NoPhysics)
    episode.stand()
    result = episode.run(PAPER_STEPPING)
    assert result.termination == "time_limit" and abs(result.duration - 3.0) <= 0.5 / rate


def test_words_of_an_own_ending_are_its_name() -> None:
    assert ending_words("far_away") == "far away" and ending_words("fell") == TERMINATIONS["fell"]


NOT_A_NUMBER = TorsoState((math.nan, 0.0, 0.8), (0.0, 0.0, 0.0, 1.0), (0.0,) * 3, (0.0,) * 3)


def spoilt(seconds: float, parts: dict[str, object], monkeypatch: pytest.MonkeyPatch, trace: bool = False) -> Episode:
    """An episode in which what the engine returns is replaced from some time on."""
    episode = Episode(EpisodeConfig(time_limit=3.0, physics=COARSE_PHYSICS), 0, record_trace=trace)
    simulation = episode.robot.simulation
    for name, value in parts.items():
        original = getattr(simulation, name)
        monkeypatch.setattr(simulation, name, lambda o=original, v=value: v if simulation.time > seconds else o())
    return episode


@pytest.mark.parametrize(
    ("seconds", "parts"),
    [
        (0.5, {"torso_state": NOT_A_NUMBER, "read": AT_REST._replace(acceleration=(math.nan, 0.0, 0.0))}),
        (1.5, {"read": AT_REST._replace(pressures=(math.inf, 0.0, 0.0, 0.0))}),
        (1.5, {"torso_state": NOT_A_NUMBER._replace(position=(1e9, 0.0, 0.8))}),
        (1.5, {"torso_state": NOT_A_NUMBER._replace(position=(0.0, 0.0, 0.8), velocity=(0.0, -1e5, 0.0))}),
    ],
)
def test_diverging_physics_ends_with_a_finite_reward(seconds: float, parts: Any, monkeypatch: Any) -> None:
    with spoilt(seconds, parts, monkeypatch) as episode:
        observation = observation_from(episode.stand(), Scale())
        result = episode.run((0.4, 1.3, 0.1, 1.0, 1.0))
        last = observation_from(episode.robot.last_reading, Scale())
    assert result.termination == "diverged" and 0.0 <= result.episode_return < 1.0 and not result.survived
    assert result.duration <= max(seconds, 1.0) + 0.05
    assert all(map(math.isfinite, (*observation, *last, *result.final_position)))
    assert Evaluation((result, RESULT)).diverged == 1


@pytest.mark.parametrize("seconds", [0.5, 1.5])
def test_who_diverges_while_standing_leaves_nothing_to_show(seconds: float, monkeypatch: pytest.MonkeyPatch) -> None:
    diverging: dict[str, object] = {"read": AT_REST._replace(joints=(1e30, 0.0, 0.0, 0.0, 0.0, 0.0))}
    stands = pytest.raises(SimulationError, match=r"nothing to show: .* diverged while the robot stood")
    with spoilt(seconds, diverging, monkeypatch, trace=True) as episode:
        episode.stand()
        with stands if seconds < STAND_SECONDS else nullcontext():
            trace = episode.run((0.4, 1.3, 0.1, 1.0, 1.0)).trace
            assert trace is not None and len(trace) > 1


def test_results_that_are_no_numbers_are_named() -> None:
    for name, value in (("vibration", math.nan), ("final_position", (0.0, math.inf, 0.8))):
        with pytest.raises(SimulationError, match=f"{name} of an episode must be finite"):
            replace(RESULT, **dict[str, Any]({name: value}))
