"""What keeps a robot whole: limits of its joints, signals that are no numbers, and falls."""

import math
from typing import Any

import pytest
from hand_made import BALANCE, DT, UNLOADED, reading, rocking, started, stood

from sarah.control.baselines import Baselines
from sarah.control.hip_law import BalanceParameters, HipLaw
from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import PatternGenerator, SteppingParameters
from sarah.errors import ConfigurationError
from sarah.robot.reading import SensorReading

WRONG = ((0.1, 0.3), (-0.3, -0.1), (-0.1, math.nan))
NARROW = ((-0.01, 0.3), (-0.02, 0.3), (-0.005, 0.005), (-0.8, 0.8), (-0.004, 0.02), (-0.05, 0.12))


def test_targets_stay_within_limits_whose_joints_are_named() -> None:
    """The robot is pushed to the right, so abduction is negative; V4 flexes by 0.02 rad, and the left leg swings."""
    v = BalanceParameters(2.0, 0.0, 0.0, 1.0)
    given = [*NARROW]
    generator = stood(PatternGenerator(SteppingParameters(*PAPER_STEPPING), v, DT, limits=given))
    given.clear()
    free = stood(PatternGenerator(SteppingParameters(*PAPER_STEPPING), v, DT))
    assert generator.limited_joints == ("left_hip_flexion", "left_leg_length")
    named = set()
    for _ in range(400):
        generator.tick(reading(lateral=3.0))
        free.tick(reading(lateral=3.0))
        named |= set(generator.limited_joints)
        assert free.limited_joints == ()
        for target, (low, high) in zip(generator.targets, NARROW, strict=True):
            assert low <= target <= high
    assert named == {"left_hip_abduction", "right_hip_abduction", "left_hip_flexion", "left_leg_length"}
    assert generator.targets[:2] == (-0.01, -0.01)  # one abduction for both


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        *(
            ({"limits": limits}, "limits must be 6 ranges around zero, not")
            for limits in (NARROW[:5], *(((low, high), *NARROW[1:]) for low, high in WRONG), None)
        ),
        *(({"dt": dt}, f"dt must be between 0.0001 and 0.1 s, not {dt!r}") for dt in (0.0, 0.11, math.nan, None)),
    ],
)
def test_limits_and_periods_that_no_robot_has_are_refused(arguments: dict[str, Any], words: str) -> None:
    with pytest.raises(ConfigurationError, match=words):
        PatternGenerator(SteppingParameters(*PAPER_STEPPING), **arguments)


def test_flexion_that_a_limit_keeps_from_v4_is_no_fall() -> None:
    limits = ((-1.0, 1.0), (-1.0, 1.0), (-0.005, 0.005), (-0.005, 0.005), (-1.0, 1.0), (-1.0, 1.0))
    v = BalanceParameters(0.0, 0.0, 1.0, 2.0)
    generator = PatternGenerator(SteppingParameters(*PAPER_STEPPING), v, DT, limits)
    for _ in range(400):
        generator.tick(reading()._replace(joints=generator.targets))
    assert generator.targets[2:4] == (0.005, 0.005) and abs(generator.hips.fall) < 1e-9


@pytest.mark.parametrize("dt", [0.0, math.inf])
def test_filters_refuse_periods_that_are_not_above_zero(dt: float) -> None:
    for make in (lambda: HipLaw(BALANCE, dt), lambda: Baselines(dt)):
        with pytest.raises(ConfigurationError, match=f"dt must be finite and above zero, not {dt}"):
            make()


SIGNALS = {"acceleration": 3, "angular_rate": 3, "pressures": 4, "joints": 6}


@pytest.mark.parametrize(("field", "index"), [(field, index) for field, n in SIGNALS.items() for index in range(n)])
def test_a_signal_that_is_lost_counts_as_stuck(field: str, index: int) -> None:
    def with_signal(whole: SensorReading, value: float) -> SensorReading:
        values = list(getattr(whole, field))
        values[index] = value
        return whole._replace(**{field: tuple(values)})

    lost, stuck = (stood(PatternGenerator(SteppingParameters(*PAPER_STEPPING), BALANCE, DT)) for _ in range(2))
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
    generator = stood(PatternGenerator(SteppingParameters(*PAPER_STEPPING), BALANCE, DT))
    for _ in range(10):
        generator.tick(lying())
    for tick in range(100):
        generator.tick(rocking(tick))
    generator.tick(lying(z=-1e5), 60.0)
    generator.tick(reading())
    assert not generator.has_fallen


@pytest.mark.parametrize("dt", [0.001, 0.02])
@pytest.mark.parametrize("up", [0.0, 40.0, -1e5])
def test_a_single_reading_after_a_second_without_any_is_no_fall(up: float, dt: float) -> None:
    generator = stood(PatternGenerator(SteppingParameters(*PAPER_STEPPING), BALANCE, dt))
    for _ in range(2):
        generator.tick(lying(z=up), 1.0)
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
