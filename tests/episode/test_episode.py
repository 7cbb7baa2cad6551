"""One episode: the paper's parameters, clocks, other control rates, and a simulator without physics."""

from dataclasses import replace

import numpy as np
import pytest
from laboratory import NoPhysics

from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.episode import Episode, simulate
from sarah.episode.result import EpisodeResult
from sarah.episode.robot_settings import conditions_of
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.simulation.physics import PHYSICS
from sarah.simulation.randomisation import Randomisation

SHORT = EpisodeConfig(time_limit=6.0)


def test_papers_parameters_step_in_place_for_30_seconds(paper_episode: EpisodeResult) -> None:
    result = paper_episode
    assert result.termination == "time_limit" and result.survived
    assert result.duration == 30.0
    assert result.score > 0.78
    assert 2.3 < result.steps_per_second < 3.5
    assert result.drift < 0.06
    assert result.sole_clearance > 0.010
    assert result.shifts_by_sensors > 0.9 and result.lifts_by_sensors > 0.9


@pytest.mark.parametrize(
    "parameters",
    [
        (0.1, 2.0, 2.0, 0.0, 0.0),  # a high P2 leaves most SHIFTs to their time-out
        (1.3, 1.0, 1.0, 0.0, 0.0),  # and a high P1 every LIFT
    ],
)
def test_stepping_by_the_fastest_time_outs_does_not_pay(
    parameters: tuple[float, ...], paper_episode: EpisodeResult
) -> None:
    result = simulate(EpisodeSpec(parameters, 0, config=EpisodeConfig(time_limit=10.0)))
    assert result.steps > 0
    assert min(result.shifts_by_sensors, result.lifts_by_sensors) < 0.5
    assert result.score < 0.5 * paper_episode.score


def test_noise_of_the_pads_makes_no_steps_at_a_high_control_rate() -> None:
    """A single sample at 1 kHz has three times the noise of one at 100 Hz."""
    results = []
    for rate in (100, 1000):
        config = EpisodeConfig(physics=PHYSICS["standard"].at_control_rate(rate), time_limit=5.0)
        results.append(simulate(EpisodeSpec(PAPER_STEPPING, 0, config=config), record_trace=True))
        trace = results[-1].trace
        assert trace is not None and np.allclose(np.diff(trace.time), 1.0 / rate)
    assert results[1].steps_per_second == pytest.approx(results[0].steps_per_second, rel=0.1)
    assert results[1].score == pytest.approx(results[0].score, rel=0.1)


def test_episode_runs_on_any_simulator() -> None:
    """Where nothing moves, the feet never leave the floor: time-outs only, no step, no oscillation."""
    perfect = EpisodeConfig(randomisation=Randomisation(enabled=False))
    episode = Episode(perfect, seed=0, build=NoPhysics)
    reading = episode.stand()
    assert episode.robot.simulation.time == pytest.approx(1.0) and reading.pressures == (75.0,) * 4
    result = episode.run(PAPER_STEPPING)
    assert result.termination == "no_oscillation" and result.duration == 5.0
    assert result.steps == 0 and result.shifts_by_sensors == 0.0
    assert result.final_position == (0.0, 0.0, 0.84)


def test_an_episode_takes_given_conditions_not_those_drawn() -> None:
    drawn = conditions_of(SHORT, 0)
    biased = replace(drawn, sensors=replace(drawn.sensors, angular_rate_bias=(5.0, 0.0, 0.0)))
    episodes = {bias: Episode(SHORT, 0, build=NoPhysics, conditions=given) for bias, given in ((0, None), (5, biased))}
    rates = {bias: episode.stand().angular_rate[0] for bias, episode in episodes.items()}
    assert rates[5] - rates[0] == pytest.approx(5.0 - drawn.sensors.angular_rate_bias[0])
