"""Any readings, any parameters: the controller never leaves its limits, sticks, or stops giving numbers."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sarah.control.constants import STANDARD_CONSTANTS as CONSTANTS
from sarah.control.constants import ControllerConstants
from sarah.control.hip_law import BalanceParameters
from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import LONGEST_GAP, PatternGenerator, Phase, SteppingParameters
from sarah.robot.description import describe_robot
from sarah.robot.reading import ACTUATED_JOINTS, SensorReading

STANDING = SensorReading((0.0, 0.0, 9.81), (0.0,) * 3, (75.0,) * 4, (0.0,) * 6)  # type: ignore[arg-type]
LIMITS = [describe_robot().limits[name] for name in ACTUATED_JOINTS]
NEVER_FALLEN = ControllerConstants(least_upright=-20.0, largest_blow=10.0)
"""No reading counts as a fall, so the generator goes on whatever it reads."""
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
SECONDS = st.none() | st.sampled_from([0.01, 0.02, 0.013, 0.0, 0.004, -1.0, math.nan, math.inf]) | st.floats()
CHANGE = (
    st.none() | st.builds(SteppingParameters, *[st.floats()] * 5) | st.builds(BalanceParameters, *[st.floats()] * 4)
)
RANGE = st.tuples(st.floats(-0.5, 0.0), st.floats(0.0, 0.5))


@settings(max_examples=150, derandomize=True)
@given(p=P, v=V, held=HELD, control_rate=st.sampled_from([50, 100, 1000]))
def test_pattern_generator_keeps_to_limits_and_rates_and_never_sticks(
    p: tuple[float, ...], v: tuple[float, ...], held: list[tuple[SensorReading, int]], control_rate: int
) -> None:
    dt = 1.0 / control_rate
    largest_moves = [CONSTANTS.hip_speed * dt] * 4 + [CONSTANTS.leg_speed * dt] * 2
    generator = PatternGenerator(SteppingParameters(*p), BalanceParameters(*v), dt, constants=NEVER_FALLEN)
    before, in_phase, entered = generator.targets, 0, {generator.phase}
    silence = [(STANDING, round(12.0 / dt) if control_rate == 50 else 1)]
    for reading, ticks in held + silence:
        for _ in range(ticks):
            change = generator.tick(reading)
            in_phase = 0 if change else in_phase + 1
            entered.add(generator.phase)
            if generator.phase is not Phase.STAND:
                assert in_phase * dt <= generator.time_out(generator.phase) + 2 * dt
            targets = generator.targets
            for now, then, (low, high), move in zip(targets, before, LIMITS, largest_moves, strict=True):
                assert low <= now <= high and abs(now - then) <= move * (1 + 1e-9)
            before = targets
    assert math.isfinite(generator.tilt) and math.isfinite(generator.rate)
    assert control_rate != 50 or entered == set(Phase)


@settings(max_examples=50, derandomize=True)
@given(
    limits=st.tuples(*[RANGE] * 6),
    ticks=st.lists(st.tuples(READING, SECONDS, CHANGE, st.integers(1, 120)), max_size=12),
    constants=st.sampled_from([CONSTANTS, NEVER_FALLEN]),
)
def test_any_readings_times_and_new_parameters_keep_targets_finite_slow_and_within_limits(
    limits: tuple[tuple[float, float], ...],
    ticks: list[tuple[SensorReading, float | None, SteppingParameters | BalanceParameters | None, int]],
    constants: ControllerConstants,
) -> None:
    generator = PatternGenerator(SteppingParameters(*PAPER_STEPPING), dt=0.01, limits=limits, constants=constants)
    speeds = [constants.hip_speed] * 4 + [constants.leg_speed] * 2
    before = generator.targets
    for reading, seconds, change, repetitions in [*ticks, (STANDING, None, None, 150), *ticks]:
        try:
            if isinstance(change, BalanceParameters):
                generator.set_parameters(balance=change)
            else:
                generator.set_parameters(change)
        except ValueError:  # not finite
            pass
        counts = seconds is not None and seconds >= 0.0
        longest = 0.01 + (min(seconds, LONGEST_GAP) if counts and seconds is not None else 0.0)
        for _ in range(repetitions):
            generator.tick(reading, seconds)
            for now, then, (low, high), speed in zip(generator.targets, before, limits, speeds, strict=True):
                assert low <= now <= high and abs(now - then) <= speed * longest * (1 + 1e-9)
            before = generator.targets


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, 1e300])
def test_a_sensor_that_drops_out_does_not_stop_the_stepping_by_sensors(bad: float) -> None:
    disturbed, alone = (PatternGenerator(SteppingParameters(0.4, 1.3, 0.1, 1.0, 1.0)) for _ in range(2))
    for generator in (disturbed, alone):
        generator.tick(STANDING)
    assert disturbed.tick(STANDING._replace(angular_rate=(0.0, bad, 0.0))) == alone.tick(STANDING)
    for _ in range(400):
        assert disturbed.tick(STANDING) == alone.tick(STANDING)
        assert disturbed.targets == alone.targets and disturbed.rate == alone.rate
