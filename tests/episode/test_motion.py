"""Vibration and actuators' work against hand-made motion."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from sarah.episode.motion import MotionRecord, power_within

RATE = 100


def sine(hertz: float, amplitude: float, seconds: float = 10.0) -> np.ndarray:
    time = np.arange(round(seconds * RATE)) / RATE
    return amplitude * np.sin(2 * np.pi * hertz * time)


def moving(*motion: tuple[float, ...]) -> Any:
    """A robot whose actuators have these speeds and efforts."""
    truth = SimpleNamespace(acceleration=(0.0, 0.0, 9.81))
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
