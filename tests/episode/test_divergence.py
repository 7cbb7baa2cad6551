"""An engine that returns no numbers any more: the episode ends as diverged, with a finite return."""

import dataclasses
import math
from contextlib import nullcontext

import pytest
from laboratory import COARSE_PHYSICS, RESULT

from sarah.control.pattern_generator import STAND_SECONDS
from sarah.envs.sarah_env import observation_from
from sarah.episode.episode import Episode
from sarah.episode.evaluation import Evaluation
from sarah.episode.settings import EpisodeConfig
from sarah.errors import SimulationError
from sarah.robot.reading import SensorReading
from sarah.robot.scale import Scale
from sarah.simulation.simulator import TorsoState

STANDING = SensorReading((0.0, 0.0, 9.81), (0.0,) * 3, (75.0,) * 4, (0.0,) * 6)  # type: ignore[arg-type]
NOT_A_NUMBER = TorsoState((math.nan, 0.0, 0.8), (0.0, 0.0, 0.0, 1.0), (0.0,) * 3, (0.0,) * 3)  # type: ignore[arg-type]


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
        (0.5, {"torso_state": NOT_A_NUMBER, "read": STANDING._replace(acceleration=(math.nan, 0.0, 0.0))}),
        (1.5, {"read": STANDING._replace(pressures=(math.inf, 0.0, 0.0, 0.0))}),
        (1.5, {"torso_state": NOT_A_NUMBER._replace(position=(1e9, 0.0, 0.8))}),
        (1.5, {"torso_state": NOT_A_NUMBER._replace(position=(0.0, 0.0, 0.8), velocity=(0.0, -1e5, 0.0))}),
    ],
)
def test_diverging_physics_ends_with_a_finite_reward(
    seconds: float, parts: dict[str, object], monkeypatch: pytest.MonkeyPatch
) -> None:
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
    diverging = {"read": STANDING._replace(joints=(1e30, 0.0, 0.0, 0.0, 0.0, 0.0))}
    stands = pytest.raises(SimulationError, match=r"nothing to show: .* diverged while the robot stood")
    with spoilt(seconds, diverging, monkeypatch, trace=True) as episode:
        episode.stand()
        with stands if seconds < STAND_SECONDS else nullcontext():
            trace = episode.run((0.4, 1.3, 0.1, 1.0, 1.0)).trace
            assert trace is not None and len(trace) > 1


def test_results_that_are_no_numbers_are_named() -> None:
    for name, value in (("vibration", math.nan), ("final_position", (0.0, math.inf, 0.8))):
        with pytest.raises(SimulationError, match=f"{name} of an episode must be finite"):
            dataclasses.replace(RESULT, **{name: value})
