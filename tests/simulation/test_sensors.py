"""The model of real sensors against hand-made readings: what it adds, what it slows down, what it leaves alone."""

import math
from typing import Any

import numpy as np
import pytest
from laboratory import BuildSimulation, Laboratory
from scipy.spatial.transform import Rotation

from sarah.robot.filters import LowPass
from sarah.robot.reading import GRAVITY, SensorReading
from sarah.simulation.physics import PHYSICS
from sarah.simulation.randomisation import SensorConditions
from sarah.simulation.sensors import ImperfectSensors
from sarah.simulation.simulator import rotate_to_body

DT = 0.01
JOINTS = (0.01, 0.02, 0.03, 0.04, 0.05, 0.06)
TRUTH = SensorReading((1.0, -2.0, 9.0), (0.1, -0.2, 0.3), (70.0, 71.0, 72.0, 73.0), JOINTS)
STILL = SensorReading((0.0,) * 3, (0.0,) * 3, (75.0,) * 4, (0.0,) * 6)
ROOT = math.sqrt(50.0)
"""Root of half the control rate of 100 Hz, in root Hz: a sample's deviation is the noise's density times this."""
NOISE = {f"{name}_noise_density": x / ROOT for name, x in (("acceleration", 0.2), ("angular_rate", 0.02), ("pad", 3.0))}
DEVIATIONS = np.array([0.2] * 3 + [0.02] * 3 + [3.0] * 4)


def sensors(**settings: Any) -> ImperfectSensors:
    return ImperfectSensors(SensorConditions(**settings), DT)


def noisy_signals(reading: SensorReading) -> list[float]:
    return [*reading.acceleration, *reading.angular_rate, *reading.pressures]


def test_perfect_sensors_read_the_truth() -> None:
    perfect = sensors()
    for factor in (1.0, 1e9, 0.1):
        x, y, z = TRUTH.acceleration
        truth = TRUTH._replace(acceleration=(factor * x, factor * y, factor * z))
        assert perfect(truth) == truth


@pytest.mark.parametrize("ticks", [0, 1, 3])
def test_all_signals_come_late_by_the_delay(ticks: int) -> None:
    delayed = sensors(delay_seconds=ticks * DT)
    truths = [SensorReading._make(tuple(n + signal for signal in signals) for signals in TRUTH) for n in range(8)]
    seen = [delayed(truth) for truth in truths]
    assert seen == [truths[0]] * ticks + truths[: 8 - ticks]


@pytest.mark.parametrize("control_rate", [50, 80, 400])
def test_the_delay_is_the_same_time_at_every_control_rate(control_rate: int) -> None:
    """Between two ticks it lies between their readings."""
    delayed = ImperfectSensors(SensorConditions(delay_seconds=0.0175), 1.0 / control_rate)
    for tick in range(control_rate):
        seen = delayed(TRUTH._replace(joints=(tick / control_rate,) * 6))
    assert (control_rate - 1) / control_rate - seen.joints[0] == pytest.approx(0.0175)


@pytest.mark.parametrize("control_rate", [50, 200])
def test_noise_behind_a_filter_is_the_same_at_every_control_rate(control_rate: int) -> None:
    """White noise of density d behind a low-pass of time constant T has the variance d^2 / (4 T)."""
    noisy = ImperfectSensors(SensorConditions(acceleration_noise_density=0.03), 1.0 / control_rate)
    filters, values = [LowPass(0.2, 1.0 / control_rate) for _ in range(3)], []
    for _ in range(150 * control_rate):
        values.append([f(a) for f, a in zip(filters, noisy(STILL).acceleration, strict=True)])
    assert np.std(values) == pytest.approx(0.03 / math.sqrt(4 * 0.2), rel=0.08)


def test_constant_errors_are_added_to_what_an_askew_sensor_reads() -> None:
    askew = sensors(imu_tilt=(0.1, 0.0), acceleration_bias=(0.5, -0.3, 0.2), pad_gains=(0.8, 0.9, 1.1, 1.2))
    level = STILL._replace(acceleration=(0.0, 0.0, GRAVITY), angular_rate=(0.0, 0.0, 2.0))
    seen = askew(level)
    assert seen.acceleration == pytest.approx((0.5, GRAVITY * math.sin(0.1) - 0.3, GRAVITY * math.cos(0.1) + 0.2))
    assert seen.angular_rate == pytest.approx((0.0, 2.0 * math.sin(0.1), 2.0 * math.cos(0.1)))
    assert seen.pressures == pytest.approx((60.0, 67.5, 82.5, 90.0)) and seen.joints == STILL.joints
    to_the_side = sensors(imu_tilt=(0.0, 0.1))(level)
    assert to_the_side.acceleration == pytest.approx((-GRAVITY * math.sin(0.1), 0.0, GRAVITY * math.cos(0.1)))
    biased = sensors(angular_rate_bias=(0.01, -0.02, 0.03))(level)
    assert biased.angular_rate == pytest.approx((0.01, -0.02, 2.03))


@pytest.mark.parametrize("tilt", [(0.3, -0.4), (-0.02, -0.05), (0.0, 2.0)])
def test_a_sensor_turned_about_any_axis_sees_the_other_way_round(tilt: tuple[float, float]) -> None:
    seen, turn = sensors(imu_tilt=tilt)(TRUTH), Rotation.from_rotvec([*tilt, 0.0])
    assert seen.acceleration == pytest.approx(turn.inv().apply(TRUTH.acceleration))
    assert seen.angular_rate == pytest.approx(turn.inv().apply(TRUTH.angular_rate))


@pytest.mark.parametrize("bandwidth", [5.0, 40.0])
def test_inertial_signals_follow_a_step_at_their_bandwidth(bandwidth: float) -> None:
    limited = sensors(imu_bandwidth=bandwidth)
    level = STILL._replace(acceleration=(0.0, 0.0, GRAVITY))
    assert limited(level) == limited(level) == level
    for tick in range(1, 5):
        seen = limited(TRUTH)
        share = 1.0 - math.exp(-2.0 * math.pi * bandwidth * tick * DT)
        acceleration = [g + share * (a - g) for g, a in zip(level.acceleration, TRUTH.acceleration, strict=True)]
        assert seen.acceleration == pytest.approx(acceleration, rel=1e-9)
        assert seen.angular_rate == pytest.approx([share * rate for rate in TRUTH.angular_rate], rel=1e-9)
        assert (seen.pressures, seen.joints) == (TRUTH.pressures, TRUTH.joints)


def test_noise_is_that_of_numpys_generator_with_the_seed() -> None:
    noisy = sensors(**NOISE, seed=7)
    drawn = np.random.default_rng(7).standard_normal((1500, 10)) * DEVIATIONS
    for noise in drawn:
        seen = noisy(TRUTH)
        assert noisy_signals(seen) == pytest.approx(noisy_signals(TRUTH) + noise, rel=1e-12)
        assert seen.joints == TRUTH.joints


def test_noise_is_added_behind_the_band_limit_and_the_delay() -> None:
    slow = sensors(imu_bandwidth=1.0, delay_seconds=2 * DT, **NOISE)
    noise = np.array([noisy_signals(slow(STILL)) for _ in range(5000)]) - noisy_signals(STILL)
    assert noise.std(axis=0) == pytest.approx(DEVIATIONS, rel=0.05)


def test_unloaded_pads_read_no_negative_load() -> None:
    """Half of the noise is cut off: what is left of deviation s has the mean s / sqrt(2 pi)."""
    noisy = sensors(pad_noise_density=3.0 / ROOT)
    pads = np.array([noisy(STILL._replace(pressures=(0.0,) * 4)).pressures for _ in range(20_000)])
    assert pads.min() == 0.0 and (pads == 0.0).mean(axis=0) == pytest.approx([0.5] * 4, abs=0.02)
    assert pads.mean(axis=0) == pytest.approx([3.0 / math.sqrt(2.0 * math.pi)] * 4, rel=0.04)


def test_accelerometer_reads_a_push_on_every_axis(lab: Laboratory, build: BuildSimulation) -> None:
    simulation, dt = build(), PHYSICS["standard"].control_dt
    lab.place(simulation, pitch=math.radians(1.0))
    velocity = simulation.torso_state().velocity
    for _ in range(5):
        simulation.push((90.0, -50.0, 60.0))
        simulation.advance()
        torso = simulation.torso_state()
        x, y, z = ((now - then) / dt for now, then in zip(torso.velocity, velocity, strict=True))
        expected = rotate_to_body(torso.orientation, (x, y, z + GRAVITY))
        assert simulation.read().acceleration == pytest.approx(expected, abs=1e-6)
        assert math.hypot(*expected) > 3.0
        velocity = torso.velocity
