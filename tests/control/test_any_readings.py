"""Any readings, any parameters: the controller never leaves its limits, sticks, or stops giving numbers."""

import math
from contextlib import suppress

from hypothesis import given, settings
from hypothesis import strategies as st

from sarah.control.constants import STANDARD_CONSTANTS as CONSTANTS
from sarah.control.constants import ControllerConstants
from sarah.control.hip_law import BalanceParameters
from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import LONGEST_GAP, PatternGenerator, SteppingParameters
from sarah.robot.reading import SensorReading

STANDING = SensorReading((0.0, 0.0, 9.81), (0.0,) * 3, (75.0,) * 4, (0.0,) * 6)
NEVER_FALLEN = ControllerConstants(least_upright=-20.0, largest_blow=10.0)
"""No reading counts as a fall, so the generator goes on whatever it reads."""
SIGNAL = st.floats() | st.floats(-30.0, 30.0) | st.floats(0.0, 500.0)
READING = st.builds(SensorReading, *(st.tuples(*[SIGNAL] * count) for count in (3, 3, 4, 6)))
SECONDS = st.none() | st.sampled_from([0.01, 0.02, 0.013, 0.0, 0.004, -1.0, math.nan, math.inf]) | st.floats()
CHANGE = (
    st.none() | st.builds(SteppingParameters, *[st.floats()] * 5) | st.builds(BalanceParameters, *[st.floats()] * 4)
)
RANGE = st.tuples(st.floats(-0.5, 0.0), st.floats(0.0, 0.5))


@settings(max_examples=20, derandomize=True)
@given(
    limits=st.tuples(*[RANGE] * 6),
    ticks=st.lists(st.tuples(READING, SECONDS, CHANGE, st.integers(1, 120)), max_size=12),
    constants=st.sampled_from([CONSTANTS, NEVER_FALLEN]),
)
def test_targets_are_slow_and_within_limits_whatever_comes(
    limits: tuple[tuple[float, float], ...],
    ticks: list[tuple[SensorReading, float | None, SteppingParameters | BalanceParameters | None, int]],
    constants: ControllerConstants,
) -> None:
    generator = PatternGenerator(SteppingParameters(*PAPER_STEPPING), dt=0.01, limits=limits, constants=constants)
    speeds = [constants.hip_speed] * 4 + [constants.leg_speed] * 2
    before = generator.targets
    for reading, seconds, change, repetitions in [*ticks, (STANDING, None, None, 150), *ticks]:
        with suppress(ValueError):  # not finite
            if isinstance(change, BalanceParameters):
                generator.set_parameters(balance=change)
            else:
                generator.set_parameters(change)
        counts = seconds is not None and seconds >= 0.0
        longest = 0.01 + (min(seconds, LONGEST_GAP) if counts and seconds is not None else 0.0)
        for _ in range(repetitions):
            generator.tick(reading, seconds)
            for now, then, (low, high), speed in zip(generator.targets, before, limits, speeds, strict=True):
                assert low <= now <= high and abs(now - then) <= speed * longest * (1 + 1e-9)
            before = generator.targets
