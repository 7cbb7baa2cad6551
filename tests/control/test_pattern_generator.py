"""The state machine against hand-made readings: what ends each phase, and what the legs are told."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sarah.control.constants import STANDARD_CONSTANTS as CONSTANTS
from sarah.control.hip_law import BalanceParameters, HipLaw
from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import PatternGenerator, Phase, PhaseChange, SteppingParameters
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


def started(parameters: tuple[float, ...] = PAPER_STEPPING) -> PatternGenerator:
    """A pattern generator that has just entered its first SHIFT."""
    generator = PatternGenerator(SteppingParameters(*parameters), dt=DT)
    generator.tick(reading())
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
    generator.sense(OVER_RIGHT)
    assert generator.tilt > 0 and generator.rate > 0
    generator.stance = Side.LEFT
    assert generator.tilt < 0 and generator.rate < 0


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
        reading(lateral=-3.0, rate=0.019, right=2 * LOADED),  # rate below 0.2 P3 = 0.02
        reading(lateral=-3.0, rate=0.3, right=29.0),  # stance foot not loaded
    ],
)
def test_shift_waits_for_tilt_rate_and_load(steady: SensorReading) -> None:
    """Until its time-out of 0.5 (1 + P5) = 1 s."""
    change, ticks = tick_until_change(started(), steady)
    assert change == PhaseChange(Phase.SHIFT, by_sensors=False)
    assert ticks == 100


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


def test_phases_last_at_least_their_minimum() -> None:
    generator = lifted((0.0, 0.0, 0.0, 0.0, 0.0))
    _, ticks = tick_until_change(generator, ROCKING_BACK)
    assert ticks == round(CONSTANTS.minimum_phase_seconds / DT)


def test_legs_push_lift_and_straighten_at_the_leg_speed() -> None:
    generator = started()
    assert generator.targets == (0.0, 0.0, 0.0, 0.0, pytest.approx(-CONSTANTS.shift_extension), 0.0)
    tick_until_change(generator, OVER_RIGHT)
    lengths = [generator.targets[4]]
    for _ in range(4):
        generator.tick(reading(left=UNLOADED))
        lengths.append(generator.targets[4])
    ramp = [CONSTANTS.leg_speed * DT * ticks - CONSTANTS.shift_extension for ticks in (1, 2, 3)]
    assert lengths == pytest.approx([*ramp, *[CONSTANTS.lift_retraction] * 2])
    assert generator.targets[5] == 0.0


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
        assert abs(generator.stable_x) <= CONSTANTS.largest_acceleration
        before = targets


@given(parameters=st.tuples(*[st.floats(0.0, 2.0)] * 5), steady=st.tuples(st.floats(-20, 20), st.floats(-5, 5)))
def test_no_phase_outlasts_its_time_out(parameters: tuple[float, ...], steady: tuple[float, float]) -> None:
    generator = started(parameters)
    for _ in range(6):
        phase = generator.phase
        _, ticks = tick_until_change(generator, reading(*steady))
        assert ticks * DT <= generator.time_out(phase) + DT


def test_abduction_by_the_hip_law_counts_as_tilt_and_rate_to_its_side() -> None:
    hips = HipLaw(BalanceParameters(1.0, 0.0, 0.0, 0.0), DT)
    generator = PatternGenerator(SteppingParameters(*PAPER_STEPPING), dt=DT, hips=hips)
    for _ in range(10):
        generator.tick(reading(lateral=-3.0))
    # Both feet to the left: the legs lean over the right one more than the torso does.
    assert hips.abduction > 0.0 and hips.abduction_rate > 0.0 and generator.stance is Side.RIGHT
    tilt = CONSTANTS.abduction_tilt * hips.abduction - generator.stable_x
    rate = CONSTANTS.abduction_rate_share * hips.abduction_rate
    assert generator.tilt == pytest.approx(tilt) and generator.rate == pytest.approx(rate)
    generator.stance = Side.LEFT
    assert generator.tilt == pytest.approx(-tilt) and generator.rate == pytest.approx(-rate)


def test_constant_abduction_is_no_tilt() -> None:
    hips = HipLaw(BalanceParameters(0.0, -2.0, 0.0, 0.0), DT)
    generator = PatternGenerator(SteppingParameters(*PAPER_STEPPING), dt=DT, hips=hips)
    for _ in range(20):
        generator.tick(reading())
    assert hips.abduction == pytest.approx(0.1) and generator.tilt == pytest.approx(0.0)
