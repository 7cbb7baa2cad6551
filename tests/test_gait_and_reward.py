"""Step detection and equation 2 against hand-computed values."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sarah.gait import GaitRecord
from sarah.pattern_generator import Phase, PhaseChange
from sarah.reward import highest_return, reward_rate

STEP = PhaseChange(Phase.LAND, by_sensors=True, is_step=True)


def record_of_steps(times: list[float]) -> GaitRecord:
    gait = GaitRecord()
    for time in times:
        gait.phase_change(time, STEP)
    return gait


def test_steps_per_second_counts_the_last_two_seconds() -> None:
    gait = record_of_steps([0.5, 1.0, 1.5, 2.0, 2.5, 3.0])
    assert gait.steps_per_second(3.2) == 4 / 2.0  # 1.5, 2.0, 2.5 and 3.0
    assert gait.steps_per_second(3.5) == 3 / 2.0
    assert gait.steps_per_second(9.0) == 0.0
    assert gait.steps == 6


def test_steps_per_second_starts_with_the_elapsed_time() -> None:
    gait = record_of_steps([0.1, 0.2])
    assert gait.steps_per_second(0.25) == 2 / 0.5  # at least half a second
    assert gait.steps_per_second(0.8) == 2 / 0.8


def test_clearance_is_the_median_of_each_steps_highest() -> None:
    gait = GaitRecord()
    for heights in ((0.001, 0.010, 0.004), (0.020,), (0.012, 0.011)):
        for height in heights:
            gait.swing(height)
        gait.phase_change(1.0, STEP)
    assert gait.sole_clearance == 0.012
    assert GaitRecord().sole_clearance == 0.0


def test_shares_of_phases_that_sensors_ended() -> None:
    gait = GaitRecord()
    for by_sensors in (True, True, True, False):
        gait.phase_change(0.0, PhaseChange(Phase.SHIFT, by_sensors))
    gait.phase_change(0.0, PhaseChange(Phase.LIFT, by_sensors=False))
    gait.phase_change(0.0, PhaseChange(Phase.STAND, by_sensors=False))
    assert gait.event_driven(Phase.SHIFT) == 0.75
    assert gait.event_driven(Phase.LIFT) == 0.0
    assert gait.event_driven(Phase.LAND) == 0.0


@pytest.mark.parametrize(
    ("x", "y", "height", "frequency", "expected"),
    [
        (0.0, 0.0, 0.84, 3.0, 0.25 * 0.84),
        (0.1, -0.2, 0.8, 3.0, 0.4 * 0.3 * 0.8),
        (-0.1, 0.2, 0.8, 3.0, 0.4 * 0.3 * 0.8),
        (0.0, 0.0, 1.0, 4.0, 0.25 * 0.5),
        (0.0, 0.0, 1.0, 2.0, 0.25 * 0.5),
        (0.0, 0.0, 1.0, 5.0, 0.25 * 2.0**-16),
        (0.6, 0.0, 1.0, 3.0, 0.0),
    ],
)
def test_equation_2_symmetric(x: float, y: float, height: float, frequency: float, expected: float) -> None:
    assert reward_rate(x, y, height, frequency) == pytest.approx(expected)


def test_equation_2_as_printed_rewards_drifting_to_one_side() -> None:
    assert reward_rate(0.1, 0.2, 0.8, 3.0, "printed") == pytest.approx(0.4 * 0.3 * 0.8)
    assert reward_rate(-0.1, -0.2, 0.8, 3.0, "printed") == pytest.approx(0.6 * 0.7 * 0.8)


@given(x=st.floats(-1, 1), y=st.floats(-1, 1), height=st.floats(0, 0.84), frequency=st.floats(0, 100))
def test_no_symmetric_reward_is_above_the_ceiling(x: float, y: float, height: float, frequency: float) -> None:
    assert 0.0 <= reward_rate(x, y, height, frequency) <= highest_return(0.84, 1.0)
