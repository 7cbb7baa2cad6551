"""The hip law against hand-made readings: which way the hips go, how far and how fast."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sarah.control.constants import STANDARD_CONSTANTS as CONSTANTS
from sarah.control.constants import ControllerConstants
from sarah.control.hip_law import BalanceParameters, HipLaw
from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import PatternGenerator, SteppingParameters
from sarah.episode.episode import simulate
from sarah.episode.push import Push
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BalanceConfig
from sarah.robot.reading import SensorReading, Side

DT = 0.01


def reading(lateral: float = 0.0, rate_x: float = 0.0) -> SensorReading:
    return SensorReading((lateral, 0.0, 9.81), (rate_x, 0.0, 0.0), (75.0,) * 4, (0.0,) * 6)


def after(law: HipLaw, steady: SensorReading, ticks: int, swing: Side = Side.LEFT) -> HipLaw:
    for _ in range(ticks):
        law.sense(steady)
        law.tick(swing)
    return law


def law(v1: float = 0.0, v2: float = 0.0, v3: float = 0.0, v4: float = 0.0) -> HipLaw:
    return HipLaw(BalanceParameters(v1, v2, v3, v4), DT)


def test_abduction_settles_where_the_law_says() -> None:
    """A push to the right reads positive, and both feet then go to the right: a negative angle."""
    settled = after(law(v1=1.5, v2=0.4), reading(lateral=2.0), ticks=300)
    assert settled.stable_x == pytest.approx(2.0, rel=1e-3)
    assert settled.abduction == pytest.approx(-0.05 * (1.5 * 2.0 + 0.4), rel=1e-3)


def test_pitch_is_the_rate_integrated_and_forgets() -> None:
    turned, memory = after(law(), reading(rate_x=0.5), ticks=20), CONSTANTS.pitch_time_constant
    assert turned.pitch == pytest.approx(0.5 * memory * (1 - math.exp(-0.2 / memory)), rel=0.01)
    assert after(turned, reading(), ticks=100).pitch < 0.04


def test_pitch_of_a_steady_rate_is_the_rate_times_its_time_constant() -> None:
    """It is 1 s, unless another is given."""
    locked = BalanceParameters(0.0, 0.0, 0.0, 0.0)
    for leaky, seconds in ((law(), 1.0), (HipLaw(locked, DT, ControllerConstants(pitch_time_constant=0.5)), 0.5)):
        assert after(leaky, reading(rate_x=0.4), ticks=2000).pitch == pytest.approx(0.4 * seconds)


def test_abduction_goes_to_its_target_at_6_rad_per_second() -> None:
    """0.1 rad: a tick of 0.06 rad, and one of 0.04. Before the first tick and at the target it does not move."""
    moved = law(v2=-2.0)
    abductions, rates = [moved.abduction], [moved.abduction_rate]
    for _ in range(3):
        after(moved, reading(), ticks=1)
        abductions.append(moved.abduction)
        rates.append(moved.abduction_rate)
    assert abductions == pytest.approx([0.0, 0.06, 0.1, 0.1])
    assert rates == pytest.approx([0.0, 6.0, 4.0, 0.0])


def test_the_hips_own_low_pass_takes_three_tenths_of_a_second() -> None:
    assert after(law(), reading(lateral=2.0), ticks=30).stable_x == pytest.approx(2.0 * (1.0 - math.exp(-1.0)))


def test_extreme_readings_count_as_20_metres_per_second_squared_and_10_radians_per_second() -> None:
    for sign in (1.0, -1.0):
        extreme = after(law(), reading(lateral=1000.0 * sign, rate_x=1000.0 * sign), ticks=1)
        assert extreme.stable_x == pytest.approx(sign * 20.0 * (1.0 - math.exp(-0.01 / 0.3)))
        assert extreme.pitch == pytest.approx(sign * 10.0 * 0.01)


def test_hips_turn_by_no_more_than_three_tenths_of_a_radian() -> None:
    turned = after(law(v1=2.0, v3=2.0), reading(lateral=15.0, rate_x=5.0), ticks=100)
    assert turned.abduction == -0.3 and turned.flexion[Side.LEFT] == 0.3


def test_only_the_swing_leg_turns_with_the_fall() -> None:
    falling = after(law(v3=1.0), reading(rate_x=-0.5), ticks=20, swing=Side.RIGHT)
    assert falling.flexion[Side.RIGHT] == pytest.approx(2.5 * falling.pitch)
    assert falling.flexion[Side.RIGHT] < 0 == falling.flexion[Side.LEFT]
    landed = after(falling, reading(), ticks=10, swing=Side.LEFT)
    assert landed.flexion[Side.RIGHT] == 0.0 and landed.flexion[Side.LEFT] < 0


def test_v4_flexes_both_legs_alike() -> None:
    flexed = after(law(v4=1.5), reading(), ticks=50)
    assert flexed.flexion == {Side.LEFT: pytest.approx(0.03), Side.RIGHT: pytest.approx(0.03)}


def test_zeros_leave_the_hips_locked() -> None:
    still = after(law(), reading(lateral=8.0, rate_x=3.0), ticks=50)
    assert still.abduction == 0.0 and set(still.flexion.values()) == {0.0}


def test_pattern_generator_sends_the_hips_targets() -> None:
    generator = PatternGenerator(SteppingParameters(*PAPER_STEPPING), dt=DT, hips=law(1.0, 0.0, 1.0, 0.5))
    for _ in range(5):
        generator.tick(reading(lateral=-3.0, rate_x=-0.4))
    left_abduction, right_abduction, left_flexion, right_flexion, *_ = generator.targets
    assert left_abduction == right_abduction > 0
    assert generator.swing is Side.LEFT and left_flexion < right_flexion


@given(
    parameters=st.tuples(*[st.floats(-2.0, 2.0)] * 4),
    signals=st.lists(st.tuples(st.floats(-1e6, 1e6), st.floats(-1e4, 1e4), st.sampled_from(list(Side))), max_size=200),
)
def test_any_readings_keep_hips_bounded_and_slow(
    parameters: tuple[float, ...], signals: list[tuple[float, float, Side]]
) -> None:
    moved = law(*parameters)
    for lateral, rate, swing in signals:
        before = (moved.abduction, *moved.flexion.values())
        after(moved, reading(lateral, rate), 1, swing)
        now = (moved.abduction, *moved.flexion.values())
        assert all(abs(value) <= CONSTANTS.largest_hip_angle for value in now)
        assert all(abs(a - b) <= CONSTANTS.hip_speed * DT + 1e-12 for a, b in zip(now, before, strict=True))


def test_papers_p1_to_p5_go_on_stepping_with_the_hip_law() -> None:
    """Pushed to the right, so hard that a few of eight fall."""
    push = Push(newtons=(100.0, 100.0), degrees=(0.0, 0.0))
    episode = BalanceConfig(time_limit=8.0, stepping=PAPER_STEPPING, push=push)
    results = [simulate(EpisodeSpec((0.8, 0.0, 0.0, 0.0), seed, "balance", episode)) for seed in range(8)]
    assert sum(result.survived for result in results) >= 5
    assert all(result.shifts_by_sensors > 0.9 and result.steps_per_second > 2.0 for result in results)
