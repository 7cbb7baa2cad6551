"""A pattern generator in operation: new parameters while it runs, and ticks that are late, early or missed."""

import math
from typing import Any

import pytest
from hand_made import BALANCE, DT, OVER_RIGHT, UNLOADED, reading, rocking, started, stood

from sarah.control.hip_law import BalanceParameters
from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import PatternGenerator, Phase, PhaseChange, SteppingParameters
from sarah.errors import ConfigurationError


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
    generator = stood(PatternGenerator(SteppingParameters(*PAPER_STEPPING), BALANCE, DT))
    for take in (generator.set_parameters, PatternGenerator):
        with pytest.raises(ConfigurationError, match=f"parameters must be {words}, not"):
            take(*refused)
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


def test_who_is_told_of_missed_ticks_steps_as_at_half_the_rate() -> None:
    missed, slow = phase_ends(DT, 2, told=True), phase_ends(2 * DT, 1, told=False)
    assert [change for _, change in missed] == [change for _, change in slow]
    assert [seconds for seconds, _ in missed] == pytest.approx([seconds for seconds, _ in slow])
    assert sum(change.is_step for _, change in missed) > 5
    assert phase_ends(DT, 2, told=False) != missed


@pytest.mark.parametrize("seconds", [0.02, math.inf])
def test_it_stands_for_a_second_of_readings_however_far_apart(seconds: float) -> None:
    generator = PatternGenerator(SteppingParameters(*PAPER_STEPPING), dt=DT)
    generator.tick(reading(), DT)
    for _ in range(100):
        assert generator.phase is Phase.STAND and generator.targets == (0.0,) * 6
        generator.tick(reading(), seconds)
    assert generator.phase is Phase.SHIFT


def test_a_reading_after_a_long_gap_weighs_no_more_in_a_mean() -> None:
    generator = PatternGenerator(SteppingParameters(*PAPER_STEPPING), dt=DT)
    generator.tick(reading())
    generator.tick(reading(lateral=1.0), 1.0)
    assert generator.stable_x == pytest.approx(0.5, rel=1e-3)


@pytest.mark.parametrize("field", ["acceleration", "angular_rate"])
def test_signals_that_come_late_have_the_baselines_of_what_came(field: str) -> None:
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
    for times in ((0.014,), (0.001,), (0.016, 0.004)):
        generator, elapsed = started(), 0.0
        while generator.phase is Phase.SHIFT:
            for seconds in times:
                generator.tick(reading(), seconds)
                elapsed += seconds
        assert elapsed == pytest.approx(1.0, abs=0.016)


@pytest.mark.parametrize(("seconds", "ticks"), [(None, 1), (0.03, 3), (60.0, 100), (math.nan, 1), (-5, 1)])
def test_a_gap_counts_up_to_a_second_and_no_time_as_a_tick(seconds: float | None, ticks: int) -> None:
    late, punctual = started(), started()
    late.tick(OVER_RIGHT, seconds)
    for _ in range(ticks):
        punctual.tick(OVER_RIGHT)
    assert late.stable_x == pytest.approx(punctual.stable_x)
    assert late.rate == pytest.approx(punctual.rate, rel=0.01)
