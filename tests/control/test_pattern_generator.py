"""The state machine against hand-made readings: what ends each phase, and what the legs are told."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sarah.control.baselines import Baselines
from sarah.control.constants import STANDARD_CONSTANTS as CONSTANTS
from sarah.control.constants import ControllerConstants
from sarah.control.hip_law import BalanceParameters, HipLaw
from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import (
    STAND_SECONDS,
    PatternGenerator,
    Phase,
    PhaseChange,
    SteppingParameters,
)
from sarah.episode.tasks import STEPPING
from sarah.errors import ConfigurationError
from sarah.robot.filters import LowPass
from sarah.robot.reading import SensorReading, Side

DT = 0.01
LOADED, UNLOADED = 75.0, 0.0


def reading(lateral: float = 0.0, rate: float = 0.0, left: float = LOADED, right: float = LOADED) -> SensorReading:
    """A reading with a lateral acceleration, a rate about y, and a load on each foot."""
    pads = (left / 2, left / 2, right / 2, right / 2)
    return SensorReading((lateral, 0.0, 9.81), (0.0, rate, 0.0), pads, (0.0,) * 6)


def started(
    parameters: tuple[float, ...] = PAPER_STEPPING, constants: ControllerConstants = CONSTANTS
) -> PatternGenerator:
    """A pattern generator that has stood level, and has just entered its first SHIFT."""
    return stood(PatternGenerator(SteppingParameters(*parameters), dt=DT, constants=constants))


def stood(generator: PatternGenerator, steady: SensorReading | None = None) -> PatternGenerator:
    """The same pattern generator, after it has stood."""
    while generator.phase is Phase.STAND:
        generator.tick(steady or reading())
    assert generator.phase is Phase.SHIFT
    return generator


def tick_until_change(generator: PatternGenerator, steady: SensorReading, limit: int = 200) -> tuple[PhaseChange, int]:
    for ticks in range(1, limit):
        change = generator.tick(steady)
        if change is not None:
            return change, ticks
    raise AssertionError(f"no phase change in {limit} ticks")


# Over the right leg the body leans right: lateral acceleration negative, rate about y positive.
OVER_RIGHT = reading(lateral=-3.0, rate=0.3, left=UNLOADED, right=2 * LOADED)
ROCKING_BACK = reading(rate=-0.6, left=UNLOADED, right=2 * LOADED)


def test_right_leg_is_the_first_stance_leg() -> None:
    generator = started()
    assert generator.stance is Side.RIGHT and generator.swing is Side.LEFT


def test_low_pass_follows_a_step_with_its_time_constant() -> None:
    low_pass = LowPass(CONSTANTS.tilt_time_constant, DT)
    for _ in range(10):  # one time constant
        low_pass(1.0)
    assert low_pass.value == pytest.approx(1.0 - math.exp(-1.0))


def test_tilt_and_rate_are_positive_towards_the_stance_leg() -> None:
    generator = started()
    generator.tick(OVER_RIGHT)
    assert generator.tilt > 0 and generator.rate > 0
    generator.stance = Side.LEFT
    assert generator.tilt < 0 and generator.rate < 0


@pytest.mark.parametrize("lateral", [15.0, 1000.0, -1000.0])
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
    change, ticks = tick_until_change(started(), OVER_RIGHT)
    assert change == PhaseChange(Phase.SHIFT, by_sensors=True)
    assert ticks == 6


@pytest.mark.parametrize(
    "steady",
    [
        reading(lateral=-1.2, rate=0.3, right=2 * LOADED),  # tilt below P2 = 1.3
        reading(lateral=3.0, rate=0.3, right=2 * LOADED),  # leaning the other way
        reading(lateral=-3.0, rate=0.00098, right=2 * LOADED),  # rate below 0.01 P3 = 0.001
        reading(lateral=-3.0, rate=0.3, right=29.0),  # stance foot not loaded
    ],
)
def test_shift_waits_for_tilt_rate_and_load(steady: SensorReading) -> None:
    """Until its time-out of 0.5 (1 + P5) = 1 s."""
    change, ticks = tick_until_change(started(), steady)
    assert change == PhaseChange(Phase.SHIFT, by_sensors=False)
    assert ticks == 100


def test_each_condition_holds_just_beyond_its_threshold() -> None:
    """P1 = 0.4, P2 = 1.3, 0.01 P3 = 0.001 and 30 N, each surpassed by a few per cent, and none of them met.

    The baselines all but stand still: they would follow signals that are held as long as here.
    """
    held = ControllerConstants(baseline_time_constant=10_000.0)
    beyond, met = started(constants=held), started(constants=held)
    cases = (beyond, -1.31, 0.0011, 30.1, -0.41), (met, -1.3, 0.001, 30.0, -0.4)
    for generator, tilt, rate, load, rate_back in cases:
        by_sensors = [
            tick_until_change(generator, steady)[0].by_sensors
            for steady in (
                reading(tilt, rate, left=UNLOADED, right=load),
                reading(rate=rate_back, left=UNLOADED),
                reading(left=load),
            )
        ]
        assert by_sensors == [generator is beyond] * 3


@pytest.mark.parametrize(
    "at_rest",
    [
        reading(rate=0.3),  # no tilt
        reading(lateral=-3.0),  # no rate
    ],
)
def test_zeros_as_thresholds_still_ask_for_some_tilt_and_rate(at_rest: SensorReading) -> None:
    """So a robot at rest steps by time-outs, of 0.5 s here."""
    generator = started((0.0, 0.0, 0.0, 0.0, 0.0))
    assert tick_until_change(generator, at_rest) == (PhaseChange(Phase.SHIFT, by_sensors=False), 50)
    generator = PatternGenerator(SteppingParameters(0.0, 0.0, 0.0, 0.0, 0.0))
    changes = [change for _ in range(202) if (change := generator.tick(reading()))]
    assert [(change.ended, change.by_sensors) for change in changes] == [
        (Phase.STAND, False),
        (Phase.SHIFT, False),
        (Phase.LIFT, False),
    ]


def test_phases_last_their_time_to_the_nearest_tick() -> None:
    """Half a tick is rounded down. Periods that are powers of two make the times exact."""
    tick = 1 / 64
    for ticks, expected in ((2.4, 2), (2.5, 2), (2.6, 3)):
        constants = ControllerConstants(minimum_phase_seconds=ticks * tick, time_out_seconds=ticks * tick)
        for steady in (reading(), reading(lateral=-3.0, rate=0.3)):  # ended by the time-out, or by the sensors
            generator = PatternGenerator(SteppingParameters(0.0, 0.0, 0.0, 0.0, 0.0), dt=tick, constants=constants)
            assert tick_until_change(stood(generator), steady)[1] == expected


@pytest.mark.parametrize(("load", "changes"), [(30.0, [100, 200, 300, 400]), (30.5, [100, 200, 300, 304])])
def test_by_default_a_tick_lasts_10_ms_and_more_than_30_newtons_load_a_foot(load: float, changes: list[int]) -> None:
    """At rest, with time-outs of 1 s: only the foot that has to land decides. LAND lasts at least 0.04 s."""
    generator = PatternGenerator(SteppingParameters(*PAPER_STEPPING))
    assert [tick for tick in range(401) if generator.tick(reading(left=load))] == changes
    assert STAND_SECONDS == 1.0


def test_it_stands_for_a_second_and_no_foot_is_loaded_before_a_reading() -> None:
    """A sensor that drops out before it has read anything leaves the time-outs: 0.1 s each."""
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


def test_lift_ends_when_the_robot_rocks_back_faster_than_p1() -> None:
    generator = lifted()
    for _ in range(10):
        assert generator.tick(reading(rate=-0.39, left=UNLOADED)) is None
    change, _ = tick_until_change(generator, ROCKING_BACK)
    assert change == PhaseChange(Phase.LIFT, by_sensors=True)


def test_lift_times_out_after_p4() -> None:
    parameters = (0.4, 1.3, 0.1, 0.5, 1.0)
    change, ticks = tick_until_change(lifted(parameters), reading(left=UNLOADED))
    assert change == PhaseChange(Phase.LIFT, by_sensors=False)
    assert ticks == 75  # 0.5 (1 + 0.5) s


def landing(parameters: tuple[float, ...] = PAPER_STEPPING) -> PatternGenerator:
    generator = lifted(parameters)
    tick_until_change(generator, ROCKING_BACK)
    assert generator.phase is Phase.LAND
    return generator


def test_landing_is_a_step_and_swaps_the_legs() -> None:
    generator = landing()
    for _ in range(10):
        assert generator.tick(reading(left=29.0)) is None
    change, _ = tick_until_change(generator, reading())
    assert change == PhaseChange(Phase.LAND, by_sensors=True, is_step=True)
    assert generator.phase is Phase.SHIFT and generator.stance is Side.LEFT


def test_land_times_out_after_p5_without_a_step() -> None:
    generator = landing((0.4, 1.3, 0.1, 1.0, 0.5))
    change, ticks = tick_until_change(generator, reading(left=UNLOADED))
    assert change == PhaseChange(Phase.LAND, by_sensors=False, is_step=False)
    assert ticks == 75


def test_a_foot_that_never_left_the_floor_makes_no_step() -> None:
    generator = started()
    both_loaded = reading(lateral=-3.0, rate=0.3)
    tick_until_change(generator, both_loaded)
    tick_until_change(generator, reading(rate=-0.6))
    change, _ = tick_until_change(generator, reading())
    assert change.ended is Phase.LAND and not change.is_step


def test_only_a_foot_that_is_off_the_floor_in_lift_or_land_makes_a_step() -> None:
    """Neither one that left it in SHIFT, nor one that did so a step ago."""
    over_left = reading(lateral=3.0, rate=-0.3, left=2 * LOADED, right=UNLOADED)
    back_from_left = reading(rate=0.6)
    generator = started()
    changes = [
        tick_until_change(generator, steady)[0]
        for steady in (
            *(OVER_RIGHT, reading(rate=-0.6), reading()),  # left off in SHIFT only
            *(over_left, reading(rate=0.6, right=UNLOADED), reading()),  # right off in SHIFT and LIFT
            *(reading(lateral=-3.0, rate=0.3), reading(rate=-0.6), reading()),  # left never off
            *(reading(lateral=3.0, rate=-0.3), back_from_left, reading(right=UNLOADED)),  # right off in LAND, for good
        )
    ]
    assert [change.is_step for change in changes if change.ended is Phase.LAND] == [False, True, False, False]
    assert all(change.by_sensors for change in changes[:-1]) and not changes[-1].by_sensors


def test_phases_last_at_least_their_minimum() -> None:
    generator = lifted((0.0, 0.0, 0.0, 0.0, 0.0))
    _, ticks = tick_until_change(generator, ROCKING_BACK)
    assert ticks == 4  # 0.04 s
    faster = PatternGenerator(SteppingParameters(0.0, 0.0, 0.0, 0.0, 0.0), dt=0.001)
    assert tick_until_change(stood(faster), OVER_RIGHT)[1] == 40


def test_legs_push_lift_and_straighten_at_the_leg_speed() -> None:
    """They push by 8 mm and lift by 30 mm, at 1 m/s."""
    generator = started()
    assert generator.targets == (0.0, 0.0, 0.0, 0.0, pytest.approx(-0.008), 0.0)
    tick_until_change(generator, OVER_RIGHT)
    lengths = [generator.targets[4]]
    for _ in range(4):
        generator.tick(reading(left=UNLOADED))
        lengths.append(generator.targets[4])
    assert lengths == pytest.approx([0.002, 0.012, 0.022, 0.030, 0.030])
    assert generator.targets[5] == 0.0
    tick_until_change(generator, ROCKING_BACK)
    assert generator.targets[4:] == pytest.approx((0.020, 0.0))


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ((0.4, 1.3, 0.1, 1.0), "must be 5 numbers"),
        ((0.4, 1.3, 0.1, 1.0, math.nan), "P5 must be between 0 and 2, not nan"),
        ((0.4, 1.3, 0.1, math.inf, 1.0), "P4 must be between 0 and 2, not inf"),
        ((-0.1, 1.3, 0.1, 1.0, 1.0), "P1 must be between 0 and 2, not -0.1"),
        ((0.4, 2.1, 0.1, 1.0, 1.0), "P2 must be between 0 and 2, not 2.1"),
    ],
)
def test_parameters_out_of_their_box_are_refused(values: tuple[float, ...], message: str) -> None:
    with pytest.raises(ConfigurationError, match=message):
        STEPPING.checked(values)


@given(
    parameters=st.tuples(*[st.floats(0.0, 2.0)] * 5),
    signals=st.lists(
        st.tuples(st.floats(-1e6, 1e6), st.floats(-100, 100), st.floats(0, 4000), st.floats(0, 4000)), max_size=300
    ),
)
def test_any_readings_keep_targets_bounded_and_slow(
    parameters: tuple[float, ...], signals: list[tuple[float, float, float, float]]
) -> None:
    generator = PatternGenerator(SteppingParameters(*parameters), dt=DT)
    before = generator.targets
    longest, shortest = -CONSTANTS.shift_extension, CONSTANTS.lift_retraction  # positive lengths retract
    for signal in signals:
        generator.tick(reading(*signal))
        targets = generator.targets
        assert targets[:4] == (0.0, 0.0, 0.0, 0.0)
        assert all(longest - 1e-12 <= length <= shortest + 1e-12 for length in targets[4:])
        assert all(abs(a - b) <= CONSTANTS.leg_speed * DT + 1e-12 for a, b in zip(targets, before, strict=True))
        assert abs(generator.stable_x) <= 2 * 20.0  # limit of the signal, and of its baseline
        before = targets


@given(parameters=st.tuples(*[st.floats(0.0, 2.0)] * 5), steady=st.tuples(st.floats(-20, 20), st.floats(-5, 5)))
def test_no_phase_outlasts_its_time_out(parameters: tuple[float, ...], steady: tuple[float, float]) -> None:
    generator = started(parameters)
    for _ in range(6):
        phase = generator.phase
        _, ticks = tick_until_change(generator, reading(*steady))
        assert ticks * DT <= generator.time_out(phase) + DT


def test_abduction_by_the_hip_law_counts_as_tilt_and_rate_to_its_side() -> None:
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


def test_constant_abduction_is_no_tilt() -> None:
    generator = stood(PatternGenerator(SteppingParameters(*PAPER_STEPPING), BalanceParameters(0.0, -2.0, 0.0, 0.0), DT))
    hips = generator.hips
    for _ in range(20):
        generator.tick(reading())
    assert hips.abduction == pytest.approx(0.1) and generator.tilt == pytest.approx(0.0)


@pytest.mark.parametrize("offset", [0.7, -1.2])
def test_offsets_that_were_there_while_standing_change_no_step(offset: float) -> None:
    """An askew accelerometer and a gyroscope's bias: the same signals, each with its constant."""
    level, askew = (PatternGenerator(SteppingParameters(*PAPER_STEPPING), dt=DT) for _ in range(2))
    for generator, constant in ((level, 0.0), (askew, offset)):
        stood(generator, reading(lateral=constant, rate=constant / 10))
    for tick in range(300):
        phase = 2.0 * math.pi * 1.5 * tick * DT
        lateral, rate = -3.0 * math.sin(phase), 0.5 * math.cos(phase)
        left, right = (LOADED, UNLOADED) if lateral > 0.0 else (UNLOADED, LOADED)
        change = level.tick(reading(lateral, rate, left, right))
        assert askew.tick(reading(lateral + offset, rate + offset / 10, left, right)) == change
        assert askew.tilt == pytest.approx(level.tilt) and askew.rate == pytest.approx(level.rate)


BALANCE = BalanceParameters(1.0, 0.0, 0.5, 0.0)


def rocking(tick: int, dt: float = DT) -> SensorReading:
    """A reading of a robot that rocks from foot to foot at 1.5 Hz, and falls a little forward and backward."""
    phase = 2.0 * math.pi * 1.5 * tick * dt
    lateral, rate = -3.0 * math.sin(phase), 0.5 * math.cos(phase)
    left, right = (LOADED, UNLOADED) if lateral > 0.0 else (UNLOADED, LOADED)
    at_the_feet = reading(lateral, rate, 2 * left, 2 * right)
    return at_the_feet._replace(
        angular_rate=(0.2 * math.sin(phase / 2.0), rate, 0.0),
        joints=(0.0, 0.0, 0.02 * math.sin(phase), -0.02 * math.sin(phase), 0.0, 0.0),
    )


def test_new_p1_to_p5_hold_from_the_next_tick_on() -> None:
    """A tilt of nearly 1.25 is not above P2 = 1.3, and above P2 = 1.1; the V that were given before stay."""
    v = BalanceParameters(0.0, 0.0, 0.5, 0.0)
    generator = stood(PatternGenerator(SteppingParameters(*PAPER_STEPPING), v, DT))
    for _ in range(50):
        assert generator.tick(reading(lateral=-1.25, rate=0.3)) is None
    generator.set_parameters(SteppingParameters(0.4, 1.1, 0.1, 1.0, 1.0))
    assert generator.tick(reading(lateral=-1.25, rate=0.3)) == PhaseChange(Phase.SHIFT, by_sensors=True)
    assert generator.hips.parameters == v


def test_new_v1_to_v4_come_at_the_speed_of_the_ramp_and_arrive() -> None:
    """4 per second are 0.04 in a tick: V1 goes by 1 in 25 ticks, and V4 by 1.5 in 38. P1 to P5 stay."""
    generator = stood(PatternGenerator(SteppingParameters(*PAPER_STEPPING), BALANCE, DT))
    goal = BalanceParameters(0.0, 0.0, 0.5, -1.5)
    generator.set_parameters(balance=goal)
    assert generator.hips.parameters == BALANCE
    for tick in range(1, 39):
        generator.tick(reading())
        v = generator.hips.parameters
        assert pytest.approx(max(0.0, 1.0 - 0.04 * tick)) == v.V1 and (v.V2, v.V3) == (0.0, 0.5)
        assert pytest.approx(max(-1.5, -0.04 * tick)) == v.V4
    assert v == goal and generator.parameters == SteppingParameters(*PAPER_STEPPING)


def test_while_the_robot_stands_new_parameters_hold_at_once() -> None:
    generator = PatternGenerator(SteppingParameters(0.0, 0.0, 0.0, 0.0, 0.0), dt=DT)
    generator.tick(reading())
    generator.set_parameters(SteppingParameters(*PAPER_STEPPING), BALANCE)
    assert generator.parameters == SteppingParameters(*PAPER_STEPPING) and generator.hips.parameters == BALANCE
    given = PatternGenerator(SteppingParameters(*PAPER_STEPPING), BALANCE, DT)
    given.tick(reading())
    for tick in range(300):
        assert generator.tick(rocking(tick)) == given.tick(rocking(tick)) and generator.targets == given.targets


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_parameters_that_are_not_finite_are_refused_and_none_changes(bad: float) -> None:
    generator = stood(PatternGenerator(SteppingParameters(*PAPER_STEPPING), BALANCE, DT))
    others = SteppingParameters(1.0, 1.0, 1.0, 1.0, 1.0), BalanceParameters(0.0, 0.0, 0.0, 0.0)
    for refused in (
        (SteppingParameters(0.4, bad, 0.1, 1.0, 1.0), others[1]),
        (others[0], BalanceParameters(1.0, 0.0, bad, 0.0)),
    ):
        with pytest.raises(ConfigurationError, match="parameters must be finite numbers, not"):
            generator.set_parameters(*refused)
        with pytest.raises(ConfigurationError, match="parameters must be finite numbers, not"):
            PatternGenerator(*refused)
    for _ in range(30):
        generator.tick(reading())
    assert generator.parameters == SteppingParameters(*PAPER_STEPPING) and generator.hips.parameters == BALANCE


def phase_ends(dt: float, every: int, told: bool) -> list[tuple[float, PhaseChange]]:
    """When phases end in 8 s of rocking after standing, by the ticks that take place: one in ``every``."""
    generator, ends = stood(PatternGenerator(SteppingParameters(*PAPER_STEPPING), BALANCE, dt)), []
    for tick in range(every, round(8.0 / dt) + 1, every):
        change = generator.tick(rocking(tick, dt), every * dt if told else None)
        if change is not None:
            ends.append((tick * dt, change))
    return ends


def test_who_is_told_that_every_second_tick_is_missed_steps_as_at_half_the_control_rate() -> None:
    """Phases end at the same times, and for the same reasons. Who is not told times out after twice the seconds."""
    missed, slow = phase_ends(DT, 2, told=True), phase_ends(2 * DT, 1, told=False)
    assert [change for _, change in missed] == [change for _, change in slow]
    assert [seconds for seconds, _ in missed] == pytest.approx([seconds for seconds, _ in slow])
    assert sum(change.is_step for _, change in missed) > 5
    assert phase_ends(DT, 2, told=False) != missed


@pytest.mark.parametrize("seconds", [0.02, 0.1, 1.0, math.inf])
def test_it_stands_for_a_second_of_readings_however_far_apart_they_are(seconds: float) -> None:
    generator = PatternGenerator(SteppingParameters(*PAPER_STEPPING), dt=DT)
    generator.tick(reading(), DT)
    for _ in range(100):
        assert generator.phase is Phase.STAND and generator.targets == (0.0,) * 6
        generator.tick(reading(), seconds)
    assert generator.phase is Phase.SHIFT


def test_a_reading_after_a_long_gap_weighs_no_more_in_a_mean_than_another() -> None:
    """Of 0 and 1 the mean is 0.5, which leaves 0.5 for the low-pass."""
    generator = PatternGenerator(SteppingParameters(*PAPER_STEPPING), dt=DT)
    generator.tick(reading())
    generator.tick(reading(lateral=1.0), 1.0)
    assert generator.stable_x == pytest.approx(0.5, rel=1e-3)


@pytest.mark.parametrize("field", ["acceleration", "angular_rate"])
def test_signals_that_come_late_while_it_stands_have_the_baselines_of_what_came(field: str) -> None:
    """The first half of the readings is lost, and the other half is constant: the hips find no push in it."""
    v = BalanceParameters(1.0, 0.0, 1.0, 0.0)
    generator = PatternGenerator(SteppingParameters(*PAPER_STEPPING), v, DT)
    constant = reading(lateral=0.7, rate=0.05, left=UNLOADED)
    lost = constant._replace(**{field: (math.nan,) * 3})
    for tick in range(200):
        generator.tick(lost if tick < 50 else constant)
    assert generator.targets[:4] == pytest.approx((0.0,) * 4, abs=1e-9)
    assert generator.tilt == pytest.approx(0.0) and generator.rate == pytest.approx(0.0)


def test_late_and_early_ticks_count_by_their_times() -> None:
    """A SHIFT that times out lasts a second in loops of 14 ms, of 1 ms, and of 16 and 4 ms in turn."""
    for times in ((0.014,), (0.001,), (0.016, 0.004)):
        generator, elapsed = started(), 0.0
        while generator.phase is Phase.SHIFT:
            for seconds in times:
                generator.tick(reading(), seconds)
                elapsed += seconds
        assert elapsed == pytest.approx(1.0, abs=0.016)


def test_an_early_tick_does_nothing() -> None:
    early, other = started(), started()
    assert early.tick(OVER_RIGHT, 0.004) is None
    assert early.tilt == other.tilt and early.targets == other.targets


@pytest.mark.parametrize(
    ("seconds", "ticks"),
    [(None, 1), (DT, 1), (0.03, 3), (1.0, 100), (60.0, 100), (math.inf, 100), (math.nan, 1), (-5, 1)],
)
def test_a_gap_counts_up_to_a_second_and_what_is_no_time_as_a_tick(seconds: float | None, ticks: int) -> None:
    late, punctual = started(), started()
    late.tick(OVER_RIGHT, seconds)
    for _ in range(ticks):
        punctual.tick(OVER_RIGHT)
    assert late.stable_x == pytest.approx(punctual.stable_x)
    assert late.rate == pytest.approx(punctual.rate, rel=0.01)


NARROW = ((-0.01, 0.3), (-0.02, 0.3), (-0.005, 0.005), (-0.8, 0.8), (-0.004, 0.02), (-0.05, 0.12))


def test_targets_stay_within_the_limits_and_the_joints_that_they_limit_are_named() -> None:
    """The robot is pushed to the right, so abduction is negative; V4 flexes by 0.02 rad, and the left leg swings."""
    v = BalanceParameters(2.0, 0.0, 0.0, 1.0)
    generator = stood(PatternGenerator(SteppingParameters(*PAPER_STEPPING), v, DT, limits=NARROW))
    assert generator.limited_joints == ("left_hip_flexion", "left_leg_length")
    named = set()
    for _ in range(400):
        generator.tick(reading(lateral=3.0))
        named |= set(generator.limited_joints)
        for target, (low, high) in zip(generator.targets, NARROW, strict=True):
            assert low <= target <= high
    assert named == {"left_hip_abduction", "right_hip_abduction", "left_hip_flexion", "left_leg_length"}
    assert generator.targets[:2] == (-0.01, -0.01)  # one abduction for both


def test_without_limits_no_joint_is_limited() -> None:
    generator = stood(PatternGenerator(SteppingParameters(*PAPER_STEPPING), BALANCE, DT))
    for tick in range(300):
        generator.tick(rocking(tick))
        assert generator.limited_joints == ()


@pytest.mark.parametrize(
    "limits", [NARROW[:5], ((0.1, 0.3), *NARROW[1:]), ((-0.1, math.nan), *NARROW[1:]), ((0.1, -0.1), *NARROW[1:])]
)
def test_limits_that_are_not_six_ranges_around_zero_are_refused(limits: tuple[tuple[float, float], ...]) -> None:
    with pytest.raises(ConfigurationError, match="limits must be 6 ranges around zero, not"):
        PatternGenerator(SteppingParameters(*PAPER_STEPPING), limits=limits)


@pytest.mark.parametrize("dt", [0.0, -0.01, math.nan, math.inf])
def test_control_periods_that_are_not_finite_and_above_zero_are_refused(dt: float) -> None:
    for make in (
        lambda: PatternGenerator(SteppingParameters(*PAPER_STEPPING), dt=dt),
        lambda: HipLaw(BALANCE, dt),
        lambda: Baselines(dt),
    ):
        with pytest.raises(ConfigurationError, match=f"dt must be finite and above zero, not {dt}"):
            make()


SIGNALS = [
    (field, index)
    for field, values in zip(SensorReading._fields, reading(), strict=True)
    for index in range(len(values))
]


@pytest.mark.parametrize(("field", "index"), SIGNALS)
def test_a_signal_that_is_not_finite_keeps_its_last_value_and_the_others_live(field: str, index: int) -> None:
    """The same as if that one signal were stuck."""

    def with_signal(whole: SensorReading, value: float) -> SensorReading:
        values = list(getattr(whole, field))
        values[index] = value
        return whole._replace(**{field: tuple(values)})

    lost, stuck = (stood(PatternGenerator(SteppingParameters(*PAPER_STEPPING), BALANCE, DT)) for _ in range(2))
    for generator in (lost, stuck):
        generator.tick(rocking(5))
    last = getattr(rocking(5), field)[index]
    moved = set()
    for tick in range(6, 300):
        bad = (math.nan, math.inf, -math.inf, 1e300)[tick % 4]
        assert lost.tick(with_signal(rocking(tick), bad)) == stuck.tick(with_signal(rocking(tick), last))
        assert lost.targets == stuck.targets and lost.tilt == stuck.tilt and lost.rate == stuck.rate
        moved.add(lost.targets)
    assert len(moved) > 20


def lying(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> SensorReading:
    """A reading of a robot that lies, with gravity's reaction along these axes, and whose feet carry nothing."""
    return reading(left=UNLOADED, right=UNLOADED)._replace(acceleration=(x, y, z))


@pytest.mark.parametrize(
    "fallen", [lying(x=9.81), lying(x=-9.81), lying(y=9.81), lying(y=-9.81), lying(z=-9.81), lying(y=9.0, z=4.0)]
)
def test_a_robot_that_lies_on_any_side_or_at_66_degrees_has_fallen_within_a_second_and_holds_still(
    fallen: SensorReading,
) -> None:
    generator = stood(PatternGenerator(SteppingParameters(*PAPER_STEPPING), BALANCE, DT))
    for tick in range(100):
        generator.tick(rocking(tick))
    assert not generator.has_fallen
    for _ in range(100):
        generator.tick(fallen)
    assert generator.has_fallen
    held = generator.targets
    generator.set_parameters(balance=BalanceParameters(-1.0, 1.0, 1.0, 1.0))
    for tick in range(300):  # also when it has been put up again: it then stands, and needs a new generator
        assert generator.tick(rocking(tick)) is None and generator.targets == held
    assert generator.has_fallen


def test_a_blow_or_a_long_gap_before_it_is_no_fall() -> None:
    """0.1 s of free fall, and a single reading of -20 m/s^2 after a second without readings."""
    generator = stood(PatternGenerator(SteppingParameters(*PAPER_STEPPING), BALANCE, DT))
    for _ in range(10):
        generator.tick(lying())
    for tick in range(100):
        generator.tick(rocking(tick))
    generator.tick(lying(z=-1e5), 60.0)
    generator.tick(reading())
    assert not generator.has_fallen


@pytest.mark.parametrize("dt", [0.001, 0.01, 0.02])
@pytest.mark.parametrize("up", [0.0, -9.81, 40.0, -40.0, -1e5])
def test_a_single_reading_after_a_second_without_any_is_no_fall(up: float, dt: float) -> None:
    """Nor does the low-pass remember it for long: a second one, a second later, is no fall either."""
    generator = stood(PatternGenerator(SteppingParameters(*PAPER_STEPPING), BALANCE, dt))
    for _ in range(2):
        generator.tick(lying(z=up), 1.0)
        for _ in range(round(1.0 / dt)):
            generator.tick(reading())
    assert not generator.has_fallen


@pytest.mark.parametrize(("every", "longest"), [(1, 0.4), (2, 0.4), (3, 0.4), (10, 1.3)])
def test_who_lies_is_recognised_though_most_ticks_are_missed(every: int, longest: float) -> None:
    generator, elapsed = started(), 0.0
    while not generator.has_fallen:
        generator.tick(lying(y=9.81), every * DT)
        elapsed += every * DT
    assert elapsed < longest
