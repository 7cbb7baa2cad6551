"""Any readings, any parameters: the controller never leaves its limits, sticks, or stops giving numbers."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sarah.control.constants import STANDARD_CONSTANTS as CONSTANTS
from sarah.control.hip_law import BalanceParameters
from sarah.control.pattern_generator import PatternGenerator, Phase, SteppingParameters
from sarah.robot.description import ACTUATED_JOINTS, describe_robot
from sarah.robot.reading import SensorReading

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
    largest_moves = [CONSTANTS.hip_speed * dt] * 4 + [CONSTANTS.leg_speed * dt] * 2
    generator = PatternGenerator(SteppingParameters(*p), BalanceParameters(*v), dt)
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
