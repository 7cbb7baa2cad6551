"""Step detection, equation 2, vibration and actuators' work against hand-computed values and hand-made motion."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sarah.control.pattern_generator import Phase, PhaseChange
from sarah.episode.gait import GaitRecord
from sarah.episode.motion import MotionRecord, power_within
from sarah.episode.reward import RewardSettings, highest_return, reward_rate
from sarah.robot.reading import Side

STEP = PhaseChange(Phase.LAND, by_sensors=True, is_step=True)
PRINTED = RewardSettings(reward_form="printed")


def swinging(height: float) -> Any:
    generator = SimpleNamespace(phase=Phase.LIFT, swing=Side.LEFT)
    return SimpleNamespace(generator=generator, simulation=SimpleNamespace(sole_height={Side.LEFT: height}.get))


def record_of_steps(ticks: list[int]) -> GaitRecord:
    gait = GaitRecord(100)
    for tick in ticks:
        gait.phase_change(tick, STEP)
    return gait


def test_steps_per_second_counts_the_last_two_seconds() -> None:
    gait = record_of_steps([50, 100, 150, 200, 250, 300])
    assert gait.steps_per_second(320) == 4 / 2.0  # those at 150, 200, 250 and 300
    assert gait.steps_per_second(351) == 3 / 2.0
    assert gait.steps_per_second(900) == 0.0 and gait.steps == 6
    early = record_of_steps([10, 20])
    assert early.steps_per_second(25) == 2 / 0.5  # at least half a second
    assert early.steps_per_second(80) == 2 / 0.8  # the elapsed time
    for tick in (0, 7, 1234):
        one = record_of_steps([tick])
        assert sum(one.steps_per_second(now) > 0 for now in range(tick + 1, tick + 400)) == 200


def test_a_small_robots_steps_are_counted_over_shorter_times() -> None:
    quick = GaitRecord(100, time_scale=0.5)
    for tick in (50, 100, 150):
        quick.phase_change(tick, STEP)
    assert quick.steps_per_second(160) == 2 / 1.0  # those at 100 and 150
    early = GaitRecord(100, time_scale=0.5)
    early.phase_change(5, STEP)
    assert early.steps_per_second(10) == 1 / 0.25


def test_duration_and_steps_per_second_are_those_of_the_ticks() -> None:
    gait = GaitRecord(100)
    assert (gait.metrics(1.0).duration, gait.metrics(1.0).steps_per_second) == (1.0, 0.0)
    for tick in range(300):
        gait.decided(swinging(0.0), STEP if tick in (50, 150) else None, None)
    metrics = gait.metrics(1.0)
    assert (metrics.duration, metrics.steps) == (4.0, 2)
    assert metrics.steps_per_second == pytest.approx(2 / 3.0)
    assert gait.metrics(0.1234567894).duration == 3.123456789  # whole nanoseconds


def test_clearance_is_the_median_of_each_steps_highest() -> None:
    gait = GaitRecord(100)
    for heights in ((0.001, 0.010, 0.004), (0.020,), (0.012, 0.011)):
        for height in heights:
            gait.sensed(swinging(height))
        gait.phase_change(100, STEP)
    assert gait.metrics(0.0).sole_clearance == 0.012


@pytest.mark.parametrize("highest", [[], [-0.00001], [0.030, -0.00001, -0.00002]])
def test_a_foot_that_stays_in_the_floors_give_clears_nothing(highest: list[float]) -> None:
    gait = GaitRecord(100)
    for height in highest:
        gait.sensed(swinging(height))
        gait.phase_change(100, STEP)
    assert gait.metrics(0.0).sole_clearance == 0.0


@pytest.mark.parametrize(
    ("phase", "own", "other"),
    [(Phase.SHIFT, "shifts_by_sensors", "lifts_by_sensors"), (Phase.LIFT, "lifts_by_sensors", "shifts_by_sensors")],
)
def test_share_by_sensors_counts_its_own_phase_only(phase: Phase, own: str, other: str) -> None:
    gait, shares = GaitRecord(100), []
    for by_sensors in (True, False, False, True, True):
        for change in (PhaseChange(phase, by_sensors), STEP, PhaseChange(Phase.STAND, by_sensors=False)):
            gait.phase_change(0, change)
        metrics = gait.metrics(0.0)
        shares.append(getattr(metrics, own))
        assert getattr(metrics, other) == 0.0
    assert shares == [1.0, 1 / 2, 1 / 3, 2 / 4, 3 / 5]


@pytest.mark.parametrize(
    ("place", "height", "steps", "symmetric", "printed"),
    [
        ((0.0, 0.0), 0.84, 3.0, 0.25 * 0.84, 0.25 * 0.84),
        ((0.1, 0.2), 0.8, 3.0, 0.4 * 0.3 * 0.8, 0.4 * 0.3 * 0.8),
        ((-0.1, -0.2), 0.8, 4.0, 0.4 * 0.3 * 0.5 * 0.8, 0.6 * 0.7 * 0.5 * 0.8),  # as printed it rewards drifting
        ((0.0, 0.0), 1.0, 2.0, 0.25 * 0.5, 0.25 * 0.5),
        ((0.0, 0.0), 1.0, 5.0, 0.25 * 2.0**-16, 0.25 * 2.0**-16),
        ((0.6, 0.0), 1.0, 3.0, 0.0, -0.1 * 0.5),
    ],
)
def test_equation_2(place: tuple[float, float], height: float, steps: float, symmetric: float, printed: float) -> None:
    assert reward_rate(*place, height, steps) == pytest.approx(symmetric)
    assert reward_rate(*place, height, steps, PRINTED) == pytest.approx(printed)


def test_another_rewarded_frequency_counts_by_the_ratio() -> None:
    settings = RewardSettings(step_frequency=6.0, reward_half_width=0.25)
    assert [reward_rate(0.1, 0.0, 0.4, steps, settings) for steps in (6.0, 8.0, 4.0)] == pytest.approx(
        [0.15 * 0.25 * share * 0.4 for share in (1.0, 0.5, 0.5)]
    )


@given(x=st.floats(-1, 1), y=st.floats(-1, 1), height=st.floats(0, 0.84), frequency=st.floats(0, 100))
def test_no_symmetric_reward_is_above_the_ceiling(x: float, y: float, height: float, frequency: float) -> None:
    """That of a robot 0.84 m tall that steps in place for 29 s, at 0.5 * 0.5 * 2^0 * 0.84 a second, is 6.09."""
    assert 0.0 <= reward_rate(x, y, height, frequency) <= highest_return(0.84, 1.0)
    assert highest_return(0.84, 29.0) == pytest.approx(6.09)


RATE = 100


def sine(hertz: float, amplitude: float, seconds: float = 10.0) -> np.ndarray:
    time = np.arange(round(seconds * RATE)) / RATE
    return amplitude * np.sin(2 * np.pi * hertz * time)


def moving(*motion: tuple[float, ...], up: float = 9.81) -> Any:
    """A robot whose actuators have these speeds and efforts, and whose torso is accelerated upward."""
    truth = SimpleNamespace(acceleration=(0.0, 0.0, up))
    return SimpleNamespace(truth=truth, simulation=SimpleNamespace(actuator_motion=lambda: motion))


def burst(second: int) -> np.ndarray:
    """A second of a fast sine in eleven of rest."""
    signal = np.zeros((1100, 1))
    signal[100 * second : 100 * second + 100, 0] = sine(40.0, 6.0, 1.0)
    return signal


@pytest.mark.parametrize(
    ("signals", "power"),
    [
        (np.stack([sine(35.0, 3.0), sine(25.0, 1.0)], axis=1), 4.5 + 0.5),
        (np.stack([9.81 + sine(1.5, 5.0), sine(10.0, 2.0)], axis=1), 0.0),  # gravity and slow motion
        (np.where(np.arange(1001) % 2, 4.0, -4.0)[:, None], 16.0),  # chatter at half the control rate
        *((burst(second), pytest.approx(18.0 / 11.0, rel=0.1)) for second in (1, 5, 9)),
        (np.ones((10, 3)), 0.0),  # too short for a spectrum
    ],
)
def test_power_of_fast_motion_is_half_its_amplitude_squared(signals: np.ndarray, power: Any) -> None:
    expected = pytest.approx(power, rel=0.01, abs=1e-5) if isinstance(power, float) else power
    assert power_within(signals, RATE, (20.0, 50.0)) == expected


def test_actuators_work_and_peaks() -> None:
    record = MotionRecord(RATE)
    record.sensed(moving((0.5, 0.0, -2.0, 0.0, 0.3, 0.0), (10.0, 5.0, 4.0, 0.0, -100.0, 90.0)))
    record.sensed(moving((0.0,) * 6, (0.0,) * 6))
    motion = record.metrics()
    assert motion.actuator_power == pytest.approx((5.0 + 8.0 + 30.0) / 2)
    assert motion.peak_hip_rate == 2.0 and motion.peak_leg_speed == 0.3
    for tick in range(RATE):
        record.sensed(moving((0.0,) * 6, (0.0,) * 6, up=9.81 + 4.0 * (-1) ** tick))
    assert record.metrics().vibration == pytest.approx(16.0, rel=0.05)
