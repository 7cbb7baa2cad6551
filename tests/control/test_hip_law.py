"""The hip law against hand-made readings: which way the hips go, how far and how fast."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sarah.control.constants import ControllerConstants
from sarah.control.hip_law import BalanceParameters, HipLaw
from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import PatternGenerator, SteppingParameters
from sarah.robot.reading import SensorReading, Side

DT = 0.01


def reading(
    lateral: float = 0.0,
    rate_x: float = 0.0,
    left: float = 150.0,
    right: float = 150.0,
    flexion: tuple[float, float] = (0.0, 0.0),
    rate_y: float = 0.0,
    abduction: tuple[float, float] = (0.0, 0.0),
) -> SensorReading:
    """A reading with a lateral acceleration, rates about x and y, and load, flexion and abduction of both legs."""
    pads = (left / 2, left / 2, right / 2, right / 2)
    return SensorReading((lateral, 0.0, 9.81), (rate_x, rate_y, 0.0), pads, (*abduction, *flexion, 0.0, 0.0))


def after(law: HipLaw, steady: SensorReading, ticks: int) -> HipLaw:
    for _ in range(ticks):
        law.sense(steady)
        law.tick()
    return law


def law(v1: float = 0.0, v2: float = 0.0, v3: float = 0.0, v4: float = 0.0, servo_error: float = 0.1) -> HipLaw:
    """The law; a larger ``servo_error`` lets readings stay behind the targets."""
    return HipLaw(BalanceParameters(v1, v2, v3, v4), DT, ControllerConstants(largest_servo_error=servo_error))


def test_abduction_settles_where_the_law_says() -> None:
    settled = after(law(v1=1.5, v2=0.4), reading(lateral=2.0), ticks=300)
    assert settled.stable_x == pytest.approx(2.0, rel=1e-3)
    assert settled.abduction == pytest.approx(-0.05 * (1.5 * 2.0 + 0.4), rel=1e-3)
    # The hips' own low-pass takes three tenths of a second
    assert after(law(), reading(lateral=2.0), ticks=30).stable_x == pytest.approx(2.0 * (1.0 - math.exp(-1.0)))


@pytest.mark.parametrize(("limits", "largest", "expected"), [(0.05, 0.3, -0.05), (0.5, 0.04, -0.04), (0.5, 0.3, -0.1)])
def test_a_constant_abduction_is_no_sway_whatever_limits_it(limits: float, largest: float, expected: float) -> None:
    constants = ControllerConstants(largest_hip_angle=largest)
    constant = HipLaw(BalanceParameters(0.0, 2.0, 0.0, 0.0), DT, constants, [(-limits, limits)] * 6)
    after(constant, reading(), ticks=50)
    assert constant.abduction == pytest.approx(expected) and constant.sway == pytest.approx(0.0)


def test_pitch_is_a_steady_rate_times_its_time_constant() -> None:
    locked = BalanceParameters(0.0, 0.0, 0.0, 0.0)
    for leaky, seconds in ((law(), 1.0), (HipLaw(locked, DT, ControllerConstants(lean_time_constant=0.5)), 0.5)):
        assert after(leaky, reading(rate_x=0.4), ticks=2000).pitch == pytest.approx(0.4 * seconds)


def test_abduction_goes_to_its_target_at_6_rad_per_second() -> None:
    moved = law(v2=-2.0)
    motion = [(moved.abduction, moved.abduction_rate)]
    for _ in range(3):
        after(moved, reading(), ticks=1)
        motion.append((moved.abduction, moved.abduction_rate))
    assert np.array(motion) == pytest.approx(np.array([(0.0, 0.0), (0.06, 6.0), (0.1, 4.0), (0.1, 0.0)]))


def test_hips_keep_to_their_limits() -> None:
    """Those that are given, or three tenths of a radian."""
    narrow = ControllerConstants(largest_hip_angle=0.02, hip_speed=1.0)
    hips, before = HipLaw(BalanceParameters(2.0, 2.0, 2.0, -2.0), DT, narrow), 0.0
    for _ in range(50):
        after(hips, reading(lateral=9.0, rate_x=2.0, left=0.0), ticks=1)
        assert abs(hips.abduction) <= 0.02 and abs(hips.abduction - before) <= 0.01 + 1e-12
        before = hips.abduction
    assert hips.abduction == -0.02 and hips.flexion[Side.LEFT] == -0.02
    turned = after(law(v1=2.0, v3=2.0), reading(lateral=15.0, rate_x=5.0, left=0.0), ticks=100)
    assert turned.abduction == turned.flexion[Side.LEFT] == -0.3


LEANS, DEAD_BAND = 0.1, 0.03


@pytest.mark.parametrize(("loads", "flexion"), [((40.0, 250.0), (-0.2, LEANS)), ((250.0, 40.0), (LEANS, -0.2))])
def test_fall_is_the_carrying_legs_lean_beyond_the_dead_band(loads: Any, flexion: Any) -> None:
    assert after(law(), reading(left=loads[0], right=loads[1], flexion=flexion), ticks=100).fall == pytest.approx(
        LEANS - DEAD_BAND
    )


def test_fall_counts_pitch_and_rate_and_not_v4() -> None:
    """A torso that turns at a steady 0.2 rad/s has pitched by 0.2 rad in the end, and leans on by 0.2 / 4 rad.

    The hips have moved by V4's 0.02 rad, which leans nobody.
    """
    turning = after(law(v4=1.0), reading(rate_x=0.2, flexion=(0.02, 0.02)), ticks=2000)
    assert turning.fall == pytest.approx(0.2 + 0.2 / 4.0 - DEAD_BAND)


def test_fall_of_one_tick_by_hand() -> None:
    """The joint of the leg that carries moves by 0.04 rad in a tick, which is 4 rad/s, and the torso turns at 1 rad/s.

    Pitch 0.01 rad, joint 0.04 rad, low-passed rate 5 (1 - exp(-1/3)) = 1.4173 rad/s, a quarter of it 0.3543 rad. The
    sum of 0.4043 rad less 0.03 rad, once more through the low-pass: 0.1061 rad.
    """
    moved = after(law(v3=1.0), reading(left=0.0), ticks=1)
    moved.sense(reading(rate_x=1.0, left=0.0, flexion=(0.0, 0.04)))
    assert moved.pitch == pytest.approx(0.01)
    assert moved.fall == pytest.approx(0.1061, abs=1e-4)
    moved.tick()
    assert moved.flexion == {Side.LEFT: pytest.approx(-0.06), Side.RIGHT: 0.0}  # 6 rad/s, towards -0.6 x 0.1061


@settings(max_examples=20)
@given(rate=st.floats(-0.012, 0.012), v3=st.floats(-2.0, 2.0))
def test_small_leans_are_no_fall(rate: float, v3: float) -> None:
    assert set(after(law(v3=v3), reading(rate_x=rate, left=0.0), ticks=300).flexion.values()) == {0.0}


@settings(max_examples=30)
@given(lean=st.floats(-0.2, 0.2), v3=st.floats(-1.0, 1.0))
def test_foot_in_the_air_steps_to_the_side_of_the_fall(lean: float, v3: float) -> None:
    stepping = after(law(v3=v3, servo_error=1.0), reading(left=29.0, flexion=(0.0, lean)), ticks=200)
    beyond = math.copysign(max(0.0, abs(lean) - DEAD_BAND), lean)
    assert stepping.flexion[Side.LEFT] == pytest.approx(-0.6 * v3 * beyond, abs=1e-9)
    assert stepping.flexion[Side.RIGHT] == 0.0


def test_loaded_legs_do_not_follow_the_fall() -> None:
    falling = reading(left=31.0, right=250.0, flexion=(0.0, 0.2))
    assert set(after(law(v3=1.0, servo_error=1.0), falling, ticks=50).flexion.values()) == {0.0}
    in_the_air = after(law(v3=1.0, servo_error=1.0), reading(left=29.0, right=250.0, flexion=(0.0, 0.2)), ticks=50)
    assert in_the_air.flexion[Side.LEFT] < -0.05
    assert set(after(in_the_air, falling, ticks=10).flexion.values()) == {0.0}  # it has landed


def test_an_outlier_of_gyroscope_or_joint_is_soon_forgotten() -> None:
    hit = after(law(v3=1.0), reading(left=0.0), ticks=5)
    after(hit, reading(left=0.0, rate_x=10.0, flexion=(0.0, 1e5)), ticks=1)
    assert abs(after(hit, reading(left=0.0), ticks=100).fall) < 0.05


TIPS = 0.2
"""Rate about y in rad/s at which the torso has turned by 0.2 rad in the end, and leans on by 0.2 / 4 rad."""


@pytest.mark.parametrize("v1", [0.25, 0.5])
@pytest.mark.parametrize(("side", "loads"), [(Side.RIGHT, (0.0, 300.0)), (Side.LEFT, (300.0, 0.0))])
def test_a_robot_that_tips_over_its_outer_edge_spreads_its_legs(side: Side, loads: Any, v1: float) -> None:
    """Both legs outward, by 2 V1 (0.25 - 0.15) rad; it tips to the right at a positive rate."""
    tipping = reading(left=loads[0], right=loads[1], rate_y=side.value * TIPS)
    spread = after(law(v1=v1), tipping, ticks=2000)
    assert spread.abductions == {Side.LEFT: pytest.approx(0.2 * v1), Side.RIGHT: pytest.approx(-0.2 * v1)}
    assert spread.abduction == spread.sway == 0.0


@pytest.mark.parametrize(("v1", "rate"), [(0.0, TIPS), (-1.0, TIPS), (1.0, -TIPS), (1.0, 0.11)])
def test_who_does_not_tip_over_does_not_spread(v1: float, rate: float) -> None:
    """Nor who has locked hips; back over the foot, and as far as steps lean, it does not tip over."""
    still = after(law(v1=v1), reading(left=0.0, rate_y=rate), ticks=2000)
    assert set(still.abductions.values()) == {0.0}


def test_a_leg_that_gives_way_outward_tips_and_v2_does_not() -> None:
    """The right leg carries, and its foot has gone 0.2 rad to the left: 2 (0.2 - 0.15) rad. In the air it counts on."""
    tipping = after(law(v1=1.0, servo_error=1.0), reading(left=0.0, abduction=(0.0, 0.2)), ticks=100)
    assert tipping.spread == pytest.approx(0.1)
    assert after(tipping, reading(left=0.0, right=0.0, abduction=(0.0, 0.2)), ticks=100).spread == pytest.approx(0.1)
    assert after(law(v1=1.0, v2=-2.0), reading(left=0.0, abduction=(0.1, 0.1)), ticks=100).spread == 0.0


def test_legs_spread_and_close_at_their_speeds() -> None:
    tipped = law(v1=1.0, servo_error=1.0)
    tipping = reading(left=0.0, abduction=(0.0, 0.3))
    spreads = [after(tipped, tipping, ticks=1).spread for _ in range(3)]
    assert spreads == pytest.approx([0.015, 0.03, 0.045])
    closing = [after(tipped, reading(), ticks=1).spread for _ in range(30)]
    assert max(before - now for before, now in pairwise(closing)) == pytest.approx(0.01)
    assert closing[-1] == 0.0


@pytest.mark.parametrize("stuck", [-0.3, 1e5])
def test_a_stuck_position_of_a_hip_joint_moves_no_leg(stuck: float) -> None:
    for abduction in ((stuck, 0.0), (0.0, stuck)):
        for loads in ((0.0, 300.0), (300.0, 0.0)):
            still = after(law(v1=1.0), reading(0.0, 0.0, *loads, abduction=abduction), ticks=100)
            assert set(still.abductions.values()) == {0.0}
    assert abs(after(law(v3=1.0), reading(left=0.0, flexion=(0.0, stuck)), ticks=100).fall) < 0.1


def test_v4_flexes_both_legs_alike() -> None:
    flexed = after(law(v4=1.5), reading(), ticks=50)
    assert flexed.flexion == {Side.LEFT: pytest.approx(0.03), Side.RIGHT: pytest.approx(0.03)}
    locked = after(law(), reading(lateral=8.0, rate_x=3.0), ticks=50)
    assert locked.abduction == 0.0 and set(locked.flexion.values()) == {0.0}


def test_pattern_generator_sends_the_hips_targets() -> None:
    generator = PatternGenerator(SteppingParameters(*PAPER_STEPPING), BalanceParameters(1.0, 0.0, 1.0, 0.5), DT)
    for _ in range(101):
        generator.tick(reading())
    for _ in range(10):
        generator.tick(reading(lateral=-3.0, rate_x=-0.8, left=0.0))
    left_abduction, right_abduction, left_flexion, right_flexion, *_ = generator.targets
    assert left_abduction == right_abduction > 0
    assert left_flexion > right_flexion == pytest.approx(0.01)  # it falls forward, and the left foot goes there
