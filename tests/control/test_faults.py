"""A pattern generator in operation: what keeps a robot whole, new parameters, late or missed ticks, any readings."""

import math
from contextlib import suppress
from typing import Any

import pytest
from hand_made import BALANCE, DT, OVER_RIGHT, UNLOADED, reading, rocking, started, stood
from hypothesis import given, settings
from hypothesis import strategies as st

from sarah.control.baselines import Baselines
from sarah.control.constants import STANDARD_CONSTANTS, ControllerConstants
from sarah.control.hip_law import BalanceParameters, HipLaw
from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import LONGEST_GAP, PatternGenerator, Phase, PhaseChange, SteppingParameters
from sarah.errors import ConfigurationError
from sarah.robot.reading import SensorReading

P = SteppingParameters(*PAPER_STEPPING)
WRONG = ((0.1, 0.3), (-0.3, -0.1), (-0.1, math.nan))
NARROW = ((-0.01, 0.3), (-0.02, 0.3), (-0.005, 0.005), (-0.8, 0.8), (-0.004, 0.02), (-0.05, 0.12))


def stepping(balance: BalanceParameters = BALANCE, dt: float = DT, **options: Any) -> PatternGenerator:
    return stood(PatternGenerator(P, balance, dt, **options))


def test_targets_stay_within_limits_whose_joints_are_named() -> None:
    """The robot is pushed to the right, so abduction is negative; V4 flexes by 0.02 rad, and the left leg swings."""
    v = BalanceParameters(2.0, 0.0, 0.0, 1.0)
    given = [*NARROW]
    generator = stepping(v, limits=given)
    given.clear()
    free = stepping(v)
    assert generator.limited_joints == ("left_hip_flexion", "left_leg_length")
    named, at_the_top = set[str](), set[str]()
    for _ in range(400):
        generator.tick(reading(lateral=3.0))
        free.tick(reading(lateral=3.0))
        named |= set(generator.limited_joints)
        if generator.targets[4] == 0.02:
            at_the_top |= set(generator.limited_joints)
        assert free.limited_joints == ()
        for target, (low, high) in zip(generator.targets, NARROW, strict=True):
            assert low <= target <= high
    assert named == {"left_hip_abduction", "right_hip_abduction", "left_hip_flexion", "left_leg_length"}
    assert "left_leg_length" in at_the_top
    assert generator.targets[:2] == (-0.01, -0.01)  # one abduction for both


@pytest.mark.parametrize(
    "limits", [NARROW[:5], (*NARROW, NARROW[0]), *(((low, high), *NARROW[1:]) for low, high in WRONG), None]
)
def test_limits_that_no_robot_has_are_refused(limits: Any) -> None:
    with pytest.raises(ConfigurationError, match="limits must be 6 ranges around zero, not"):
        PatternGenerator(P, limits=limits)


@pytest.mark.parametrize("dt", [0.0, 0.11, math.nan, math.inf, None])
def test_periods_that_no_robot_has_are_refused(dt: Any) -> None:
    with pytest.raises(ConfigurationError, match=f"dt must be between 0.0001 and 0.1 s, not {dt!r}"):
        PatternGenerator(P, dt=dt)
    for make in (lambda: HipLaw(BALANCE, dt), lambda: Baselines(dt)):
        if dt in (0.0, math.inf):
            with pytest.raises(ConfigurationError, match=f"dt must be finite and above zero, not {dt}"):
                make()


def test_flexion_that_a_limit_keeps_from_v4_is_no_fall() -> None:
    limits = ((-1.0, 1.0), (-1.0, 1.0), (-0.005, 0.005), (-0.005, 0.005), (-1.0, 1.0), (-1.0, 1.0))
    v = BalanceParameters(0.0, 0.0, 1.0, 2.0)
    generator = PatternGenerator(P, v, DT, limits)
    for _ in range(400):
        generator.tick(reading()._replace(joints=generator.targets))
    assert generator.targets[2:4] == (0.005, 0.005) and abs(generator.hips.fall) < 1e-9


SIGNALS = {"acceleration": 3, "angular_rate": 3, "pressures": 4, "joints": 6}


@pytest.mark.parametrize(("field", "index"), [(field, index) for field, n in SIGNALS.items() for index in range(n)])
def test_a_signal_that_drops_out_keeps_its_value(field: str, index: int) -> None:
    def with_signal(whole: SensorReading, value: float) -> SensorReading:
        values = list(getattr(whole, field))
        values[index] = value
        return whole._replace(**{field: tuple(values)})

    lost, stuck = (stepping() for _ in range(2))
    for generator in (lost, stuck):
        generator.tick(rocking(5))
    last = getattr(rocking(5), field)[index]
    moved = set()
    for tick in range(6, 100):
        bad = (math.nan, math.inf, -math.inf, 1e300)[tick % 4]
        assert lost.tick(with_signal(rocking(tick), bad)) == stuck.tick(with_signal(rocking(tick), last))
        assert lost.targets == stuck.targets and lost.tilt == stuck.tilt and lost.rate == stuck.rate
        moved.add(lost.targets)
    assert len(moved) > 20


def lying(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> SensorReading:
    """A reading of a robot that lies, with gravity's reaction along these axes, and whose feet carry nothing."""
    return reading(left=UNLOADED, right=UNLOADED)._replace(acceleration=(x, y, z))


@pytest.mark.parametrize("fallen", [lying(x=9.81), lying(z=-9.81), lying(y=9.0, z=4.0)])
def test_who_lies_has_fallen_within_a_second_and_is_still(fallen: SensorReading) -> None:
    generator = stepping()
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


@pytest.mark.parametrize("dt", [0.001, 0.02])
@pytest.mark.parametrize("up", [0.0, 40.0, -1e5])
def test_a_tenth_of_a_second_or_a_reading_after_a_gap_is_no_fall(up: float, dt: float) -> None:
    generator = stepping(dt=dt)
    for lies, seconds, ticks in ((lying(), dt, round(0.1 / dt)), (lying(z=up), 1.0, 1), (lying(z=up), 60.0, 1)):
        for _ in range(ticks):
            generator.tick(lies, seconds)
        for _ in range(round(1.0 / dt)):
            generator.tick(reading())
    assert not generator.has_fallen


@pytest.mark.parametrize(("every", "longest"), [(1, 0.4), (3, 0.4), (10, 1.3)])
def test_who_lies_is_recognised_though_most_ticks_are_missed(every: int, longest: float) -> None:
    generator, elapsed = started(), 0.0
    while not generator.has_fallen:
        generator.tick(lying(y=9.81), every * DT)
        elapsed += every * DT
    assert elapsed < longest


def test_new_p1_to_p5_hold_from_the_next_tick_on() -> None:
    """A tilt of nearly 1.25 is not above P2 = 1.3, and above P2 = 1.1; the V that were given before stay."""
    v = BalanceParameters(0.0, 0.0, 0.5, 0.0)
    generator = stepping(v)
    for _ in range(50):
        assert generator.tick(reading(lateral=-1.25, rate=0.3)) is None
    generator.set_parameters(SteppingParameters(0.4, 1.1, 0.1, 1.0, 1.0))
    assert generator.tick(reading(lateral=-1.25, rate=0.3)) == PhaseChange(Phase.SHIFT, by_sensors=True)
    assert generator.hips.parameters == v


def test_new_v1_to_v4_come_at_the_speed_of_the_ramp_and_arrive() -> None:
    """4 per second are 0.04 in a tick: V1 goes by 1 in 25 ticks, and V4 by 1.5 in 38. P1 to P5 stay."""
    generator, late = stepping(), stepping()
    goal = BalanceParameters(0.0, 0.0, 0.5, -1.5)
    for one in (generator, late):
        one.set_parameters(balance=goal)
    late.tick(reading(), 3 * DT)
    assert pytest.approx(-0.12) == late.hips.parameters.V4
    assert generator.hips.parameters == BALANCE
    for tick in range(1, 39):
        generator.tick(reading())
        v = generator.hips.parameters
        assert pytest.approx(max(0.0, 1.0 - 0.04 * tick)) == v.V1 and (v.V2, v.V3) == (0.0, 0.5)
        assert pytest.approx(max(-1.5, -0.04 * tick)) == v.V4
    assert v == goal and generator.parameters == P


def test_while_the_robot_stands_new_parameters_hold_at_once() -> None:
    generator = PatternGenerator(SteppingParameters(0.0, 0.0, 0.0, 0.0, 0.0), dt=DT)
    generator.tick(reading())
    generator.set_parameters(P, BALANCE)
    assert generator.parameters == P and generator.hips.parameters == BALANCE
    given = PatternGenerator(P, BALANCE, DT)
    given.tick(reading())
    for tick in range(300):
        assert generator.tick(rocking(tick)) == given.tick(rocking(tick)) and generator.targets == given.targets


@pytest.mark.parametrize(
    ("refused", "words"),
    [
        ((SteppingParameters(0.4, math.nan, 0.1, 1.0, 1.0), BALANCE), "finite numbers"),
        ((SteppingParameters(1.0, 1.0, 1.0, 1.0, 1.0), BalanceParameters(1.0, 0.0, 10**400, 0.0)), "finite numbers"),
        ((BALANCE, BALANCE), "SteppingParameters"),
        ((SteppingParameters(1.0, 1.0, 1.0, 1.0, 1.0), (0.0,) * 4), "BalanceParameters"),
    ],
)
def test_parameters_that_cannot_be_are_refused_and_none_changes(refused: Any, words: str) -> None:
    generator = stepping()
    for take in (generator.set_parameters, PatternGenerator):
        with pytest.raises(ConfigurationError, match=f"parameters must be {words}, not"):
            take(*refused)
    generator.tick(reading())
    assert generator.parameters == P and generator.hips.parameters == BALANCE


def phase_ends(dt: float, every: int, told: bool) -> list[tuple[float, PhaseChange]]:
    """When phases end in 8 s of rocking after standing, by the ticks that take place: one in ``every``."""
    generator, ends = stepping(dt=dt), []
    for tick in range(every, round(8.0 / dt) + 1, every):
        change = generator.tick(rocking(tick, dt), every * dt if told else None)
        if change is not None:
            ends.append((tick * dt, change))
    return ends


def test_who_is_told_of_missed_ticks_steps_as_at_half_the_rate() -> None:
    missed, slow = phase_ends(DT, 2, told=True), phase_ends(2 * DT, 1, told=False)
    assert [change for _, change in missed] == [change for _, change in slow]
    assert [seconds for seconds, _ in missed] == pytest.approx([seconds for seconds, _ in slow])
    assert sum(change.is_step for _, change in missed) > 5
    assert phase_ends(DT, 2, told=False) != missed


@pytest.mark.parametrize("seconds", [0.02, math.inf])
def test_it_stands_for_a_second_of_readings_however_far_apart(seconds: float) -> None:
    generator = PatternGenerator(P, dt=DT)
    generator.tick(reading(), DT)
    for _ in range(100):
        assert generator.phase is Phase.STAND and generator.targets == (0.0,) * 6
        generator.tick(reading(), seconds)
    assert generator.phase is Phase.SHIFT


def test_a_reading_after_a_long_gap_weighs_no_more_in_a_mean() -> None:
    generator = PatternGenerator(P, dt=DT)
    generator.tick(reading())
    generator.tick(reading(lateral=1.0), 1.0)
    assert generator.stable_x == pytest.approx(0.5, rel=1e-3)


def test_late_and_early_ticks_count_by_their_times() -> None:
    for times in ((0.014,), (0.001,), (0.016, 0.004)):
        generator, elapsed = started(), 0.0
        while generator.phase is Phase.SHIFT:
            for seconds in times:
                generator.tick(reading(), seconds)
                elapsed += seconds
        assert elapsed == pytest.approx(1.0, abs=0.016)


@pytest.mark.parametrize(("seconds", "ticks"), [(None, 1), (0.03, 3), (60.0, 100), (0.0, 0), (math.nan, 1), (-5, 1)])
def test_a_gap_counts_up_to_a_second_and_no_time_as_a_tick(seconds: float | None, ticks: int) -> None:
    late, punctual = started(), started()
    late.tick(OVER_RIGHT, seconds)
    for _ in range(ticks):
        punctual.tick(OVER_RIGHT)
    assert late.stable_x == pytest.approx(punctual.stable_x)
    assert late.rate == pytest.approx(punctual.rate, rel=0.01)


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
    constants=st.sampled_from([STANDARD_CONSTANTS, NEVER_FALLEN]),
)
def test_targets_are_slow_and_within_limits_whatever_comes(
    limits: tuple[tuple[float, float], ...],
    ticks: list[tuple[SensorReading, float | None, SteppingParameters | BalanceParameters | None, int]],
    constants: ControllerConstants,
) -> None:
    generator = PatternGenerator(P, dt=0.01, limits=limits, constants=constants)
    speeds = [constants.hip_speed] * 4 + [constants.leg_speed] * 2
    before = generator.targets
    for given_reading, seconds, change, repetitions in [*ticks, (reading(), None, None, 150), *ticks]:
        with suppress(ValueError):  # not finite
            if isinstance(change, BalanceParameters):
                generator.set_parameters(balance=change)
            else:
                generator.set_parameters(change)
        counts = seconds is not None and seconds >= 0.0
        longest = 0.01 + (min(seconds, LONGEST_GAP) if counts and seconds is not None else 0.0)
        for _ in range(repetitions):
            generator.tick(given_reading, seconds)
            for now, then, (low, high), speed in zip(generator.targets, before, limits, speeds, strict=True):
                assert low <= now <= high and abs(now - then) <= speed * longest * (1 + 1e-9)
            before = generator.targets
