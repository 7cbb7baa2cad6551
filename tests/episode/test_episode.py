"""One episode: the paper's parameters, clocks, control rates, any settings, no physics at all, and its trace."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from laboratory import CONTROL_DT, NoPhysics

from sarah import PHYSICS, EpisodeConfig, EpisodeResult, EpisodeSpec, Physics, Push, Randomisation, Terrain
from sarah.control.constants import ControllerConstants
from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import PhaseChange
from sarah.envs.sarah_env import observation_from
from sarah.episode.ending import TERMINATIONS
from sarah.episode.episode import Episode, simulate
from sarah.episode.reward import highest_return, reward_rate
from sarah.episode.robot_settings import conditions_of
from sarah.episode.running_robot import RunningRobot
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.episode.workers import begin_episode
from sarah.ranges import ranges_of, types_of
from sarah.robot.description import describe_robot
from sarah.robot.reading import Vector

SHORT = EpisodeConfig(time_limit=6.0)


def test_papers_parameters_step_in_place_for_30_seconds(paper_episode: EpisodeResult) -> None:
    result = paper_episode
    assert result.termination == "time_limit" and result.survived and result.duration == 30.0
    assert result.score > 0.78 and 2.3 < result.steps_per_second < 3.5
    assert result.drift < 0.06 and result.sole_clearance > 0.010
    assert result.shifts_by_sensors > 0.9 and result.lifts_by_sensors > 0.9


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


class Pushed(NoPhysics):
    """A simulator in which a push does nothing but to be noted."""

    def __init__(self, *_: object) -> None:
        super().__init__()
        self.forces: list[Vector] = []

    def push(self, force: Vector) -> None:
        self.forces.append(force)


def test_push_lasts_as_long_as_it_says() -> None:
    push = Push(newtons=(80.0, 80.0), degrees=(0.0, 0.0), at_seconds=(2.0, 2.0), duration=0.15)
    episode = Episode(BalanceConfig(push=push), 0, BALANCE, build=Pushed, record_trace=True)
    episode.stand()
    trace = episode.run((1.0, 0.0, 1.0, 0.0)).trace
    assert episode.robot.simulation.forces == [(80.0, 0.0, 0.0)] * 15  # type: ignore[attr-defined]
    assert trace is not None
    assert trace.time[(trace.push == (80.0, 0.0, 0.0)).all(axis=1)] == pytest.approx(np.arange(2.0, 2.145, CONTROL_DT))


class Diary:
    """Observer that writes down time, number of commands so far, and push."""

    def __init__(self) -> None:
        self.entries: list[tuple[float, int, Vector | None]] = []

    def sensed(self, robot: RunningRobot) -> None:
        self.decided(robot, None, None)

    def decided(self, robot: RunningRobot, change: PhaseChange | None, force: Vector | None) -> None:
        simulation: Any = robot.simulation
        self.entries.append((simulation.time, len(simulation.targets), force))


def test_an_observer_sees_a_tick_before_anything_moves() -> None:
    diary: Any
    diary, robot = Diary(), RunningRobot(EpisodeConfig(), 0, build=Pushed)
    robot.observers = (diary,)
    robot.tick()
    robot.tick((50.0, 0.0, 0.0))
    times, commands, forces = zip(*diary.entries, strict=True)
    assert times == pytest.approx((0.0, 0.0, 0.01, 0.01))
    assert commands == (0, 1, 1, 2)
    assert forces == (None, None, None, (50.0, 0.0, 0.0))
    robot.termination = "fell"
    robot.tick()
    assert robot.simulation.time == pytest.approx(0.02) and len(diary.entries) == 4


def test_a_with_block_closes_the_world_after_an_error_too() -> None:
    with pytest.raises(ZeroDivisionError), Episode(EpisodeConfig(), 0, build=NoPhysics) as episode:
        raise ZeroDivisionError
    assert isinstance(episode.robot.simulation, NoPhysics) and episode.robot.simulation.closed


def test_return_is_equation_2_integrated_over_the_trace(paper_episode: EpisodeResult) -> None:
    trace: Any = paper_episode.trace
    # A row has the position before its tick, and the reward is that of the one after it. The robot starts at (0, 0).
    moved = [*trace.position[1:], paper_episode.final_position]
    rewards = [reward_rate(x, y, z, f) for (x, y, z), f in zip(moved, trace.steps_per_second, strict=True)]
    assert sum(rewards) * CONTROL_DT == pytest.approx(paper_episode.episode_return, rel=1e-12)
    ceiling = highest_return(describe_robot().standing_height, 29.0)
    assert paper_episode.score == pytest.approx(paper_episode.episode_return / ceiling)
    assert trace.score[0] == 0.0 and (np.diff(trace.score) >= 0.0).all()
    assert trace.score[-1] == pytest.approx(paper_episode.score, rel=0.001)


def test_trace_has_a_row_for_every_tick(paper_episode: EpisodeResult) -> None:
    trace: Any = paper_episode.trace
    assert len(trace) == 2900 and {len(values) for values in vars(trace).values()} == {2900}
    assert np.allclose(np.diff(trace.time), CONTROL_DT) and not trace.push.any()
    assert set(trace.phase) == {"shift", "lift", "land"}
    assert trace.joints.shape == (2900, 6) and trace.ankles.shape == (2900, 4)
    assert [trace.tick_at(time) for time in (0.0, 1.0, 1.013, 2.0, 99.0)] == [0, 0, 1, 100, 2899]
    assert all(trace.tick_at(time) == tick for tick, time in enumerate(trace.time))


def test_every_push_is_shown_while_it_acts_and_a_moment(paper_episode: EpisodeResult) -> None:
    trace: Any = paper_episode.trace
    forces = np.zeros((len(trace), 3))
    forces[100:110], forces[300:450], forces[450:455] = (5.0, 0.0, 0.0), (0.0, 7.0, 0.0), (0.0, -7.0, 0.0)
    pushed = replace(trace, push=forces)
    assert pushed.pushes() == [(100, 110), (300, 450), (450, 455)]
    shown = pushed.shown_pushes()
    assert [shown.count(force) for force in ((5.0, 0.0, 0.0), (0.0, 7.0, 0.0), (0.0, -7.0, 0.0))] == [60, 150, 60]
    assert len(shown) == len(trace) and shown[99] is None and shown[100] == shown[159] and shown[160] is None


P = st.tuples(*[st.floats(0.0, 2.0)] * 5)
V = st.tuples(*[st.floats(-2.0, 2.0)] * 4)


def legal(kind: type, **others: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    """Settings with anything from end to end of what is allowed, the ends above all."""
    drawn: dict[str, st.SearchStrategy[Any]] = {}
    for name, within in ranges_of(kind).items():
        number = st.sampled_from([within.low, within.high]) | st.floats(within.low, within.high)
        ends = st.tuples(number, number).map(lambda ends: tuple(sorted(ends)))
        drawn[name] = number if types_of(kind)[name] is float else ends
    return st.builds(kind, **{**drawn, **others})


CONFIG = st.builds(
    BalanceConfig,
    physics=st.sampled_from([Physics(50, 1, 50), Physics(100, 1), Physics(300, 200), Physics(1000, 1, 1000)]),
    randomisation=legal(Randomisation),
    terrain=legal(Terrain, cell=st.sampled_from([(0.02, 0.02), (0.02, 0.1), (0.1, 0.1)]), reach=st.just(0.7)),
    controller=legal(ControllerConstants),
    time_limit=st.sampled_from([1.1, 1.5]),
    reward_form=st.sampled_from(["symmetric", "printed"]),
    stepping=P,
    push=legal(Push, at_seconds=st.just((1.0, 1.05)), duration=st.just(10.0)),
    dimensions=st.sampled_from([{}, {"ankle_damping": 3.0}, {"contact_radius": 0.0013}, {"leg_effort": 1e4}]),
)


@settings(max_examples=12, derandomize=True)
@given(config=CONFIG, v=V, seed=st.integers(0, 2**32 - 1))
def test_extreme_but_legal_configurations_give_numbers(config: BalanceConfig, v: tuple[float, ...], seed: int) -> None:
    spec = EpisodeSpec(v, seed, "balance", config)
    result = simulate(spec)
    assert result.termination in TERMINATIONS
    for name, value in result.fields().items():
        for number in value if isinstance(value, tuple) else (value,):
            assert isinstance(number, str) or math.isfinite(number), name
    assert (abs(observation_from(begin_episode(spec), spec.config.scale)) <= 10.0).all()
