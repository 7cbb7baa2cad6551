"""The hip law against hand-made readings: which way the hips go, how far and how fast."""

import math
from dataclasses import astuple
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sarah import ControllerConstants
from sarah.control.hip_law import LOCKED_HIPS, BalanceParameters, HipLaw
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


def law(v1: float = 0.0, v2: float = 0.0, v3: float = 0.0, v4: float = 0.0, **constants: float) -> HipLaw:
    """The law; a large ``largest_servo_error`` lets readings stay behind the targets."""
    return HipLaw(BalanceParameters(v1, v2, v3, v4), DT, ControllerConstants(**constants))


DEAD_BAND, TIPS = 0.03, 0.2
"""A fall below which the flexion does not react, in rad; and a rate about y with which a robot leans by 0.25 rad in the
end: by 0.2 rad that it has turned, and by 0.2 / 4 rad that it soon will."""
LEFT, RIGHT = Side.LEFT, Side.RIGHT
LOCKED = dict(zip(("v1", "v2", "v3", "v4"), astuple(LOCKED_HIPS), strict=True))
STEADY: dict[str, tuple[dict[str, float], dict[str, Any], dict[str, Any]]] = {
    "abduction is V1's and V2's": ({"v1": 1.5, "v2": 0.4}, {"lateral": 2.0}, {"abduction": -0.05 * (1.5 * 2.0 + 0.4)}),
    "a torso has pitched": ({}, {"rate_x": 0.4}, {"pitch": 0.4}),
    "the right leg carries": ({}, {"left": 40.0, "right": 250.0, "flexion": (-0.2, 0.1)}, {"fall": 0.1 - DEAD_BAND}),
    "the left leg carries": ({}, {"left": 250.0, "right": 40.0, "flexion": (0.1, -0.2)}, {"fall": 0.1 - DEAD_BAND}),
    "pitch, its rate, and no V4": (
        {"v4": 1.0},
        {"rate_x": 0.2, "flexion": (0.02, 0.02)},
        {"fall": 0.25 - DEAD_BAND},
    ),
    "V3 on top of V4": (
        {"v3": 1.0, "v4": 1.0},
        {"left": 0.0, "flexion": (0.0, 0.12)},
        {"flexion": {LEFT: 0.02 - 0.6 * (0.1 - DEAD_BAND), RIGHT: 0.02}},
    ),
    "V4 flexes both alike": ({"v4": 1.5}, {}, {"flexion": {LEFT: 0.03, RIGHT: 0.03}}),
    "locked hips": (
        LOCKED,
        {"lateral": 8.0, "rate_x": 3.0, "left": 0.0},
        {"abduction": 0.0, "flexion": {LEFT: 0.0, RIGHT: 0.0}},
    ),
    **{
        f"tips to the {side}, V1 = {v1}": ({"v1": v1}, {f"{side.other}": 0.0, "rate_y": side.value * TIPS}, spread)
        for v1 in (0.25, 0.5)
        for side in Side
        for spread in [{"abductions": {LEFT: 0.2 * v1, RIGHT: -0.2 * v1}, "abduction": 0.0, "sway": 0.0}]
    },
    **{
        f"does not tip over, V1 = {v1}, {rate} rad/s": ({"v1": v1}, {"left": 0.0, "rate_y": rate}, {"spread": 0.0})
        for v1, rate in ((0.0, TIPS), (-1.0, TIPS), (-1.0, -TIPS), (1.0, -TIPS), (1.0, 0.11))
    },
}
"""Parameters, a reading that stays, and what comes of it."""


@pytest.mark.parametrize("case", STEADY)
def test_a_steady_reading_moves_the_hips_where_the_law_says(case: str) -> None:
    parameters, steady, expected = STEADY[case]
    settled = after(law(**parameters), reading(**steady), ticks=2000)
    for name, value in expected.items():
        assert getattr(settled, name) == pytest.approx(value), name


@pytest.mark.parametrize(
    ("left", "right", "largest", "expected"),
    [(0.05, 0.5, 0.3, -0.05), (0.5, 0.05, 0.3, -0.05), (0.5, 0.5, 0.04, -0.04), (0.5, 0.5, 0.3, -0.1)],
)
def test_a_constant_abduction_is_no_sway_whatever_limits_it(
    left: float, right: float, largest: float, expected: float
) -> None:
    constants = ControllerConstants(largest_hip_angle=largest)
    limits = [(-left, left), (-right, right), *[(-0.01, 0.01)] * 4]
    constant = HipLaw(BalanceParameters(0.0, 2.0, 0.0, 0.0), DT, constants, limits)
    after(constant, reading(), ticks=50)
    assert constant.abduction == pytest.approx(expected) and constant.sway == pytest.approx(0.0)


def test_the_filters_have_their_time_constants() -> None:
    assert after(law(), reading(lateral=2.0), ticks=30).stable_x == pytest.approx(2.0 * (1.0 - math.exp(-1.0)))
    leaky = HipLaw(BalanceParameters(0.0, 0.0, 0.0, 0.0), DT, ControllerConstants(lean_time_constant=0.5))
    assert after(leaky, reading(rate_x=0.4), ticks=2000).pitch == pytest.approx(0.4 * 0.5)


def test_abduction_goes_to_its_target_at_6_rad_per_second() -> None:
    moved = law(v2=-2.0)
    motion = [(moved.abduction, moved.abduction_rate)]
    for _ in range(3):
        after(moved, reading(), ticks=1)
        motion.append((moved.abduction, moved.abduction_rate))
    assert np.array(motion) == pytest.approx(np.array([(0.0, 0.0), (0.06, 6.0), (0.1, 4.0), (0.1, 0.0)]))


def test_hips_keep_to_their_limits() -> None:
    narrow = ControllerConstants(largest_hip_angle=0.02, hip_speed=1.0)
    hips, before = HipLaw(BalanceParameters(2.0, 2.0, 2.0, -2.0), DT, narrow), 0.0
    for _ in range(50):
        after(hips, reading(lateral=9.0, rate_x=2.0, left=0.0), ticks=1)
        assert abs(hips.abduction) <= 0.02 and abs(hips.abduction - before) <= 0.01 + 1e-12
        before = hips.abduction
    assert hips.abduction == -0.02 and hips.flexion[Side.LEFT] == -0.02
    turned = after(law(v1=2.0, v3=2.0), reading(lateral=15.0, rate_x=5.0, left=0.0), ticks=100)
    assert turned.abduction == turned.flexion[Side.LEFT] == -0.3


@pytest.mark.parametrize(("limit", "limited"), [(0.3, set()), (0.29, {0, 1, 2, 3})])
def test_a_target_at_a_joints_limit_is_not_limited(limit: float, limited: set[int]) -> None:
    for v2, v4 in ((2.0, 2.0), (-2.0, -2.0)):
        constants = ControllerConstants(abduction_scale=1.0, flexion_scale=1.0)
        hips = HipLaw(BalanceParameters(0.0, v2, 0.0, v4), DT, constants, [(-limit, limit)] * 6)
        assert after(hips, reading(), ticks=1).limited == limited


@pytest.mark.parametrize("dt", [0.01, 0.0025])
def test_several_periods_at_once_are_as_many_ticks(dt: float) -> None:
    at_once, one_by_one = (HipLaw(BalanceParameters(1.0, 1.0, 1.0, 1.0), dt) for _ in range(2))
    for hips in (at_once, one_by_one):
        hips.sense(reading())
    tipping = reading(lateral=3.0, left=0.0, rate_x=5.0, rate_y=RIGHT.value * 5.0)
    at_once.sense(tipping, periods=3)
    at_once.tick(periods=3)
    for _ in range(3):
        one_by_one.sense(tipping)
    for _ in range(3):
        one_by_one.tick()
    assert at_once.loads == one_by_one.loads
    assert at_once.spread == pytest.approx(one_by_one.spread) == pytest.approx(3 * 1.5 * dt)
    for side in Side:
        assert at_once.abductions[side] == pytest.approx(one_by_one.abductions[side]) != 0.0
        assert at_once.flexion[side] == pytest.approx(one_by_one.flexion[side]) != 0.0


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


@pytest.mark.parametrize("side", Side)
def test_outward_lean_of_one_tick_by_hand(side: Side) -> None:
    """As above, about the other axis, and without dead band and second low-pass."""
    hips = law()
    assert hips.outward_lean == 0.0
    left, right, abduction = (150.0, 0.0, (0.04, 0.0)) if side is LEFT else (0.0, 150.0, (0.0, 0.04))
    after(hips, reading(left=left, right=right), ticks=1)
    hips.sense(reading(rate_y=1.0, left=left, right=right, abduction=abduction))
    assert hips.outward_lean == pytest.approx(side.value * 0.4043, abs=1e-4)


@pytest.mark.parametrize(("dt", "averaged"), [(0.0025, 4), (0.01, 1), (0.02, 1)])
def test_loads_are_means_over_a_hundredth_of_a_second(dt: float, averaged: int) -> None:
    hips = HipLaw(LOCKED_HIPS, dt)
    assert hips.loads == {LEFT: 0.0, RIGHT: 0.0}
    for tick in range(6):
        hips.sense(reading(left=100.0 * tick, right=200.0 - tick))
    assert hips.loads[LEFT] == pytest.approx(np.mean([100.0 * tick for tick in range(6)][-averaged:]))
    assert hips.loads[RIGHT] == pytest.approx(np.mean([200.0 - tick for tick in range(6)][-averaged:]))


@settings(max_examples=30)
@given(lean=st.floats(-0.2, 0.2), v3=st.floats(-1.0, 1.0))
def test_foot_in_the_air_steps_to_the_side_of_the_fall(lean: float, v3: float) -> None:
    stepping = after(law(v3=v3, largest_servo_error=1.0), reading(left=29.0, flexion=(0.0, lean)), ticks=200)
    beyond = math.copysign(max(0.0, abs(lean) - DEAD_BAND), lean)
    assert stepping.flexion[Side.LEFT] == pytest.approx(-0.6 * v3 * beyond, abs=1e-9)
    assert stepping.flexion[Side.RIGHT] == 0.0


def test_loaded_legs_do_not_follow_the_fall() -> None:
    hips = law(v3=1.0, largest_servo_error=1.0)
    for left, low, high in ((31.0, 0.0, 0.0), (29.0, -1.0, -0.05), (31.0, 0.0, 0.0)):  # it lifts its foot, and lands
        after(hips, reading(left=left, right=250.0, flexion=(0.0, 0.2)), ticks=50)
        assert low <= hips.flexion[Side.LEFT] <= high and hips.flexion[Side.RIGHT] == 0.0


def test_an_outlier_of_gyroscope_or_joint_is_soon_forgotten() -> None:
    hit = after(law(v3=1.0), reading(left=0.0), ticks=5)
    after(hit, reading(left=0.0, rate_x=10.0, flexion=(0.0, 1e5)), ticks=1)
    assert abs(after(hit, reading(left=0.0), ticks=100).fall) < 0.05


@pytest.mark.parametrize(("loads", "abduction"), [((0.0, 150.0), (0.0, 0.2)), ((150.0, 0.0), (-0.2, 0.0))])
def test_a_leg_that_gives_way_outward_tips_and_v2_does_not(
    loads: tuple[float, float], abduction: tuple[float, float]
) -> None:
    """The foot of the leg that carries has gone 0.2 rad inward: 2 (0.2 - 0.15) rad. In the air it counts on."""
    tipping = after(law(v1=1.0, largest_servo_error=1.0), reading(0.0, 0.0, *loads, abduction=abduction), ticks=100)
    assert tipping.spread == pytest.approx(0.1)
    assert after(tipping, reading(left=0.0, right=0.0, abduction=abduction), ticks=100).spread == pytest.approx(0.1)
    assert after(law(v1=1.0, v2=-2.0), reading(left=0.0, abduction=(0.1, 0.1)), ticks=100).spread == 0.0


def test_legs_spread_and_close_at_their_speeds() -> None:
    tipped = law(v1=1.0, largest_servo_error=1.0)
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
    fall = after(law(v3=1.0), reading(left=0.0, flexion=(0.0, stuck)), ticks=100).fall
    assert fall == pytest.approx(math.copysign(0.1 - DEAD_BAND, stuck))  # a servo is 0.1 rad from its target at most


def test_pattern_generator_sends_the_hips_targets() -> None:
    generator = PatternGenerator(SteppingParameters(*PAPER_STEPPING), BalanceParameters(1.0, 0.0, 1.0, 0.5), DT)
    for _ in range(101):
        generator.tick(reading())
    for _ in range(10):
        generator.tick(reading(lateral=-3.0, rate_x=-0.8, left=0.0))
    left_abduction, right_abduction, left_flexion, right_flexion, *_ = generator.targets
    assert left_abduction == right_abduction > 0
    assert left_flexion > right_flexion == pytest.approx(0.01)  # it falls forward, and the left foot goes there
