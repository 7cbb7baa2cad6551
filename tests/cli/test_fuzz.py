"""Any readings, any parameters, any legal configuration: nothing breaks out, sticks, or stops being a number."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sarah.control.hip_law import HIP_SPEED, BalanceParameters, HipLaw
from sarah.control.pattern_generator import LEG_SPEED, STAND_SECONDS, PatternGenerator, Phase, SteppingParameters
from sarah.envs.sarah_env import observation_from
from sarah.episode.ending import TERMINATIONS
from sarah.episode.episode import Episode, simulate
from sarah.episode.push import PLAUSIBLE as PLAUSIBLE_PUSH
from sarah.episode.push import Push
from sarah.episode.result import EpisodeResult
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, STEPPING
from sarah.episode.workers import stand
from sarah.errors import ConfigurationError, SimulationError
from sarah.robot.description import ACTUATED_JOINTS, describe_robot
from sarah.robot.reading import SensorReading
from sarah.simulation.physics import Physics
from sarah.simulation.randomisation import PLAUSIBLE, Randomisation
from sarah.simulation.simulator import TorsoState

STANDING = SensorReading((0.0, 0.0, 9.81), (0.0,) * 3, (75.0,) * 4, (0.0,) * 6)  # type: ignore[arg-type]
# Legal boxes from end to end, and any float at all: tiny, huge, infinite, or no number.
P = st.tuples(*[st.floats(0.0, 2.0)] * 5)
V = st.tuples(*[st.floats(-2.0, 2.0)] * 4)
SIGNAL = st.floats() | st.floats(-30.0, 30.0) | st.floats(0.0, 500.0)
READING = st.builds(
    SensorReading,
    st.tuples(*[SIGNAL] * 3),
    st.tuples(*[SIGNAL] * 3),
    st.tuples(*[SIGNAL] * 4),
    st.tuples(*[SIGNAL] * 6),
)
HELD = st.lists(st.tuples(READING, st.integers(1, 60)), min_size=1, max_size=6)


@settings(max_examples=300, deadline=None, derandomize=True)
@given(p=P, v=V, held=HELD, control_rate=st.sampled_from([50, 100, 1000]))
def test_pattern_generator_keeps_to_limits_and_rates_and_never_sticks(
    p: tuple[float, ...], v: tuple[float, ...], held: list[tuple[SensorReading, int]], control_rate: int
) -> None:
    dt = 1.0 / control_rate
    limits = [describe_robot().limits[name] for name in ACTUATED_JOINTS]
    largest_moves = [HIP_SPEED * dt] * 4 + [LEG_SPEED * dt] * 2
    generator = PatternGenerator(SteppingParameters(*p), dt=dt, hips=HipLaw(BalanceParameters(*v), dt))
    before, in_phase, entered = generator.targets, 0, {generator.phase}
    silence = [(STANDING, round(12.0 / dt) if control_rate == 50 else 1)]
    for reading, ticks in held + silence:
        for _ in range(ticks):
            change = generator.tick(reading)
            in_phase = 0 if change else in_phase + 1
            entered.add(generator.phase)
            assert in_phase * dt <= generator.time_out(generator.phase) + 2 * dt
            targets = generator.targets
            for now, then, (low, high), move in zip(targets, before, limits, largest_moves, strict=True):
                assert low <= now <= high and abs(now - then) <= move * (1 + 1e-9)
            before = targets
    assert math.isfinite(generator.tilt) and math.isfinite(generator.rate)
    assert control_rate != 50 or entered == set(Phase)


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, 1e300])
def test_a_sensor_that_drops_out_does_not_stop_the_stepping_by_sensors(bad: float) -> None:
    disturbed, alone = (PatternGenerator(SteppingParameters(0.4, 1.3, 0.1, 1.0, 1.0)) for _ in range(2))
    for generator in (disturbed, alone):
        generator.tick(STANDING)
    disturbed.sense(STANDING._replace(angular_rate=(0.0, bad, 0.0)))
    for _ in range(300):
        assert disturbed.tick(STANDING) == alone.tick(STANDING)
        assert disturbed.targets == alone.targets and disturbed.rate == alone.rate


def plausible(name: str) -> st.SearchStrategy[float]:
    """Anything from end to end of what is allowed, the ends above all."""
    low, high, _ = {**PLAUSIBLE, **PLAUSIBLE_PUSH}[name]
    return st.sampled_from([low, high]) | st.floats(low, high)


def plausible_range(name: str) -> st.SearchStrategy[tuple[float, ...]]:
    return st.tuples(plausible(name), plausible(name)).map(lambda ends: tuple(sorted(ends)))


SINGLE = ("mass_deviation", "acceleration_noise", "angular_rate_noise", "imu_bandwidth", "pad_noise", "start_speed")
CONFIG = st.builds(
    EpisodeConfig,
    physics=st.sampled_from([Physics(50, 1, 50), Physics(100, 1), Physics(300, 200), Physics(2000, 1, 1000)]),
    randomisation=st.builds(
        Randomisation,
        friction=plausible_range("friction"),
        actuator_bandwidth=plausible_range("actuator_bandwidth"),
        pad_threshold=plausible_range("pad_threshold"),
        delay_ticks=st.sampled_from([0, 1, 100]),
        **{name: plausible(name) for name in SINGLE},
    ),
    time_limit=st.sampled_from([1.1, 1.5]),
    reward_form=st.sampled_from(["symmetric", "printed"]),
    stepping=P,
    push=st.builds(Push, newtons=plausible_range("newtons"), at_seconds=st.just((1.0, 1.05)), duration=st.just(10.0)),
    dimensions=st.sampled_from([{}, {"ankle_damping": 3.0}, {"contact_radius": 0.0013}, {"leg_effort": 1e4}]),
)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(config=CONFIG, v=V, seed=st.integers(0, 2**32 - 1))
def test_extreme_but_legal_configurations_give_numbers(config: EpisodeConfig, v: tuple[float, ...], seed: int) -> None:
    spec = EpisodeSpec(v, seed, "balance", config)
    result = simulate(spec)
    assert result.termination in TERMINATIONS
    for name, value in result.fields().items():
        for number in value if isinstance(value, tuple) else (value,):
            assert isinstance(number, str) or math.isfinite(number), name
    assert (abs(observation_from(stand(spec))) <= 10.0).all()


NOT_A_NUMBER = TorsoState((math.nan, 0.0, 0.8), (0.0, 0.0, 0.0, 1.0), (0.0,) * 3, (0.0,) * 3)  # type: ignore[arg-type]


def spoilt(
    seconds: float, parts: dict[str, object], monkeypatch: pytest.MonkeyPatch, record_trace: bool = False
) -> Episode:
    """An episode in which what the engine returns is replaced from some time on."""
    episode = Episode(EpisodeConfig(time_limit=3.0), 0, record_trace=record_trace)
    for name, value in parts.items():
        original = getattr(episode.simulation, name)
        monkeypatch.setattr(
            episode.simulation,
            name,
            lambda original=original, value=value: value if episode.simulation.time > seconds else original(),
        )
    return episode


@pytest.mark.parametrize("seconds", [0.5, 1.5])
@pytest.mark.parametrize(
    "parts",
    [
        {"torso_state": NOT_A_NUMBER, "read": STANDING._replace(acceleration=(math.nan, 0.0, 0.0))},
        {"read": STANDING._replace(pressures=(math.inf, 0.0, 0.0, 0.0))},
        {"read": STANDING._replace(joints=(1e30, 0.0, 0.0, 0.0, 0.0, 0.0))},
        {"torso_state": NOT_A_NUMBER._replace(position=(1e9, 0.0, 0.8))},
        {"torso_state": NOT_A_NUMBER._replace(position=(0.0, 0.0, 0.8), velocity=(0.0, -1e5, 0.0))},
    ],
)
def test_a_diverging_simulation_ends_as_diverged_with_a_finite_reward(
    parts: dict[str, object], seconds: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    episode = spoilt(seconds, parts, monkeypatch)
    observation = observation_from(episode.stand())
    result = episode.run((0.4, 1.3, 0.1, 1.0, 1.0))
    episode.close()
    assert result.termination == "diverged" and 0.0 <= result.episode_return < 1.0
    assert result.duration <= max(seconds, 1.0) + 0.05
    assert all(map(math.isfinite, (*observation, *observation_from(episode.last_reading), *result.final_position)))
    assert (
        Evaluation([result, simulate(EpisodeSpec((1.0,) * 5, 0, config=EpisodeConfig(time_limit=1.1)))]).diverged == 1
    )


def test_who_diverges_while_standing_leaves_nothing_to_show(monkeypatch: pytest.MonkeyPatch) -> None:
    diverging = {"read": STANDING._replace(joints=(1e30, 0.0, 0.0, 0.0, 0.0, 0.0))}
    for seconds in (0.5, 1.5):
        episode = spoilt(seconds, diverging, monkeypatch, record_trace=True)
        episode.stand()
        if seconds > STAND_SECONDS:
            trace = episode.run((0.4, 1.3, 0.1, 1.0, 1.0)).trace
            assert trace is not None and len(trace) > 1
        else:
            with pytest.raises(SimulationError, match="nothing to show: the simulation diverged while the robot stood"):
                episode.run((0.4, 1.3, 0.1, 1.0, 1.0))
        episode.close()


def test_results_that_are_no_numbers_are_named() -> None:
    result = simulate(EpisodeSpec((1.0,) * 5, 0, config=EpisodeConfig(time_limit=1.1)))
    for name, value in (("vibration", math.nan), ("final_position", (0.0, math.inf, 0.8))):
        with pytest.raises(SimulationError, match=f"{name} of an episode must be finite"):
            EpisodeResult(**{**result.fields(), name: value})


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 2.1, -0.1, "1", None, True, 10**400])
def test_parameters_that_cannot_be_are_named(value: object) -> None:
    with pytest.raises(ConfigurationError, match=r"parameter P4 must be between 0 and 2, not"):
        EpisodeSpec((1.0, 1.0, 1.0, value, 1.0), 0)  # type: ignore[arg-type]
    assert STEPPING.checked((0, 2, 1, 1, 1)) == (0.0, 2.0, 1.0, 1.0, 1.0) and BALANCE.low == -2.0


def test_observations_that_cannot_be_are_named() -> None:
    with pytest.raises(SimulationError, match=r"an observation must be finite, not .*nan"):
        observation_from(STANDING._replace(joints=(math.nan,) * 6))  # type: ignore[arg-type]
