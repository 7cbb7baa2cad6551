"""The state machine against hand-made readings: what ends each phase, and what the legs are told."""

import copy
import math

import pytest
from hand_made import DT, LOADED, OVER_RIGHT, ROCKING_BACK, UNLOADED, reading, rocking, started, stood
from hypothesis import given, settings
from hypothesis import strategies as st

from sarah import BalanceParameters, ControllerConstants
from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import STAND_SECONDS, PatternGenerator, Phase, PhaseChange, SteppingParameters
from sarah.robot.reading import SensorReading, Side


def tick_until_change(generator: PatternGenerator, steady: SensorReading, limit: int = 200) -> tuple[PhaseChange, int]:
    for ticks in range(1, limit):
        change = generator.tick(steady)
        if change is not None:
            return change, ticks
    raise AssertionError(f"no phase change in {limit} ticks")


@pytest.mark.parametrize("lateral", [15.0, -1000.0])
def test_lateral_acceleration_counts_up_to_20(lateral: float) -> None:
    """One tick of a low-pass of 0.1 s covers 1 - exp(-0.1) of the way; the baseline of 8 s takes its share before."""
    generator = started()
    generator.tick(reading(lateral=lateral))
    clipped = max(-20.0, min(20.0, lateral))
    assert generator.stable_x == pytest.approx(clipped * math.exp(-DT / 8.0) * (1.0 - math.exp(-0.1)))


def test_rate_follows_within_a_hundredth_of_a_second() -> None:
    generator = started()
    for expected in (1.0 - math.exp(-1.0), 1.0 - math.exp(-2.0)):
        generator.tick(reading(rate=0.5))
        assert generator.rate == pytest.approx(0.5 * expected, rel=0.01)  # the baseline takes less than 1 %


def test_shift_ends_when_the_robot_leans_over_the_stance_leg() -> None:
    """stable_x reaches -3 (1 - exp(-t / 0.1)); it passes P2 = 1.3 after t = -0.1 ln(1 - 1.3 / 3) = 0.057 s."""
    assert tick_until_change(started(), OVER_RIGHT) == (PhaseChange(Phase.SHIFT, by_sensors=True), 6)


@pytest.mark.parametrize(
    ("tilt", "rate", "load"),
    [(-1.2, 0.3, 150.0), (3.0, 0.3, 150.0), (-3.0, 0.00098, 150.0), (-3.0, 0.3, 29.0)],
    ids=["below P2 = 1.3", "leaning the other way", "below 0.01 P3 = 0.001", "stance foot not loaded"],
)
def test_shift_waits_for_tilt_rate_and_load(tilt: float, rate: float, load: float) -> None:
    change = tick_until_change(started(), reading(tilt, rate, right=load))
    assert change == (PhaseChange(Phase.SHIFT, by_sensors=False), 100)


def test_each_condition_holds_just_beyond_its_threshold() -> None:
    """P1 = 0.4, P2 = 1.3, 0.01 P3 = 0.001 and 30 N, each surpassed by a few per cent, and none of them met.

    The baselines all but stand still: they would follow signals that are held as long as here.
    """
    held = ControllerConstants(baseline_time_constant=10_000.0)
    beyond, met = started(constants=held), started(constants=held)
    cases = (beyond, -1.31, 0.0011, 30.1, -0.41), (met, -1.3, 0.001, 30.0, -0.4)
    for generator, tilt, rate, load, rate_back in cases:
        shift, lift = reading(tilt, rate, left=UNLOADED, right=load), reading(rate=rate_back, left=UNLOADED)
        for steady in (shift, lift, reading(left=load)):
            assert tick_until_change(generator, steady)[0].by_sensors == (generator is beyond)


def test_phases_last_their_time_to_the_nearest_tick() -> None:
    tick = 1 / 64
    for ticks, expected in ((2.4, 2), (2.5, 2), (2.6, 3)):
        constants = ControllerConstants(minimum_phase_seconds=ticks * tick, time_out_seconds=ticks * tick)
        for steady in (reading(), reading(lateral=-3.0, rate=0.3)):  # ended by the time-out, or by the sensors
            generator = PatternGenerator(SteppingParameters(0.0, 0.0, 0.0, 0.0, 0.0), dt=tick, constants=constants)
            assert tick_until_change(stood(generator), steady)[1] == expected


@pytest.mark.parametrize(("load", "changes"), [(30.0, [100, 200, 300, 400]), (30.5, [100, 200, 300, 304])])
def test_a_tick_is_10_ms_and_over_30_newtons_load_a_foot(load: float, changes: list[int]) -> None:
    generator = PatternGenerator(SteppingParameters(*PAPER_STEPPING))
    assert [tick for tick in range(401) if generator.tick(reading(left=load))] == changes
    assert STAND_SECONDS == 1.0


@pytest.mark.parametrize(("rate", "standing"), [(100.0, 100), (149.6, 150), (149.4, 149)])
def test_it_stands_for_a_second_to_the_nearest_tick(rate: float, standing: int) -> None:
    generator = PatternGenerator(SteppingParameters(*PAPER_STEPPING), dt=1.0 / rate)
    assert next(tick for tick in range(200) if generator.tick(reading())) == standing


def test_it_stands_for_a_second_and_no_foot_is_loaded_at_first() -> None:
    constants = ControllerConstants(time_out_seconds=0.1, pad_threshold=0.0)
    generator = PatternGenerator(SteppingParameters(0.0, 0.0, 0.0, 0.0, 0.0), constants=constants)
    nothing = SensorReading((math.nan,) * 3, (math.nan,) * 3, (math.nan,) * 4, (math.nan,) * 6)
    assert [generator.tick(nothing) for _ in range(100)] == [None] * 100 and generator.targets == (0.0,) * 6
    changes = [generator.tick(nothing) for _ in range(1 + 6 * 10)]
    assert changes[0] == PhaseChange(Phase.STAND, by_sensors=False, is_step=False)
    assert [change.ended for change in changes[10::10] if change] == [Phase.SHIFT, Phase.LIFT, Phase.LAND] * 2
    assert not any(change.by_sensors for change in changes if change)


def lifted(parameters: tuple[float, ...] = PAPER_STEPPING) -> PatternGenerator:
    generator = started(parameters)
    tick_until_change(generator, OVER_RIGHT)
    assert generator.phase is Phase.LIFT
    return generator


def test_only_a_foot_off_the_floor_in_lift_or_land_makes_a_step() -> None:
    """Neither one that left it in SHIFT, nor one that did so a step ago."""
    over_left = reading(lateral=3.0, rate=-0.3, left=2 * LOADED, right=UNLOADED)
    steadies = (
        *(OVER_RIGHT, reading(rate=-0.6), reading()),  # left off in SHIFT only
        *(over_left, reading(rate=0.6, right=UNLOADED), reading()),  # right off in SHIFT and LIFT
        *(reading(lateral=-3.0, rate=0.3), reading(rate=-0.6), reading()),  # left never off
        *(reading(lateral=3.0, rate=-0.3), reading(rate=0.6), reading(right=UNLOADED)),  # right off in LAND, for good
    )
    generator = started()
    changes = [tick_until_change(generator, steady)[0] for steady in steadies]
    assert [change.is_step for change in changes if change.ended is Phase.LAND] == [False, True, False, False]
    assert all(change.by_sensors for change in changes[:-1]) and not changes[-1].by_sensors


def test_lift_and_land_time_out_after_p4_and_p5() -> None:
    generator = lifted((0.4, 1.3, 0.1, 0.5, 0.2))
    lift = tick_until_change(generator, reading(left=UNLOADED))
    assert lift == (PhaseChange(Phase.LIFT, by_sensors=False), 75)  # 0.5 (1 + 0.5) s
    land = tick_until_change(generator, reading(left=UNLOADED))
    assert land == (PhaseChange(Phase.LAND, by_sensors=False, is_step=False), 60)
    assert tick_until_change(lifted((0.0, 0.0, 0.0, 0.0, 0.0)), ROCKING_BACK)[1] == 4
    faster = PatternGenerator(SteppingParameters(0.0, 0.0, 0.0, 0.0, 0.0), dt=0.001)
    assert tick_until_change(stood(faster), OVER_RIGHT)[1] == 40


@settings(max_examples=20)
@given(parameters=st.tuples(*[st.floats(0.0, 2.0)] * 5), steady=st.tuples(st.floats(-20, 20), st.floats(-5, 5)))
def test_no_phase_outlasts_its_time_out(parameters: tuple[float, ...], steady: tuple[float, float]) -> None:
    generator = started(parameters)
    for _ in range(6):
        phase = generator.phase
        _, ticks = tick_until_change(generator, reading(*steady))
        assert ticks * DT <= generator.time_out(phase) + DT


def test_legs_push_lift_and_straighten_at_the_leg_speed() -> None:
    generator = started()
    assert generator.stance is Side.RIGHT and generator.swing is Side.LEFT
    assert generator.targets == (0.0, 0.0, 0.0, 0.0, pytest.approx(-0.008), 0.0)
    tick_until_change(generator, OVER_RIGHT)
    lengths = [generator.targets[4]]
    for seconds in (2 * DT, DT, DT):
        generator.tick(reading(left=UNLOADED), seconds)
        lengths.append(generator.targets[4])
    assert lengths == pytest.approx([0.002, 0.022, 0.030, 0.030])
    assert generator.targets[5] == 0.0
    tick_until_change(generator, ROCKING_BACK)
    assert generator.targets[4:] == pytest.approx((0.020, 0.0))
    for length in (0.010, 0.0, 0.0):
        generator.tick(reading(left=UNLOADED))
        assert generator.targets[4:] == pytest.approx((length, 0.0))


def test_abduction_counts_as_tilt_and_rate_to_its_side() -> None:
    generator = stood(PatternGenerator(SteppingParameters(*PAPER_STEPPING), BalanceParameters(1.0, 0.0, 0.0, 0.0), DT))
    hips = generator.hips
    for _ in range(10):
        generator.tick(reading(lateral=-3.0))
    # Both feet to the left: the legs lean over the right one more than the torso does.
    assert hips.abduction > 0.0 and hips.abduction_rate > 0.0 and generator.stance is Side.RIGHT
    tilt = 150.0 * hips.abduction - generator.stable_x
    rate = 0.2 * hips.abduction_rate
    assert generator.tilt == pytest.approx(tilt) and generator.rate == pytest.approx(rate)
    generator.stance = Side.LEFT
    assert generator.tilt == pytest.approx(-tilt) and generator.rate == pytest.approx(-rate)


def test_offsets_that_were_there_while_standing_change_no_step() -> None:
    level, askew = (PatternGenerator(SteppingParameters(*PAPER_STEPPING), dt=DT) for _ in range(2))
    stood(level)
    stood(askew, reading(lateral=-1.2, rate=-0.12))
    for tick in range(300):
        seen = rocking(tick)
        (x, y, z), (wx, wy, wz) = seen.acceleration, seen.angular_rate
        off = seen._replace(acceleration=(x - 1.2, y, z), angular_rate=(wx, wy - 0.12, wz))
        assert askew.tick(off) == level.tick(seen)
        assert askew.tilt == pytest.approx(level.tilt) and askew.rate == pytest.approx(level.rate)


def test_a_copied_generator_has_filters_of_its_own() -> None:
    generator, alone = started(), started()
    other = copy.copy(generator)
    for tick in range(100):
        other.tick(rocking(7 * tick))
    for tick in range(100):
        assert (generator.tick(rocking(tick)), generator.targets) == (alone.tick(rocking(tick)), alone.targets)
