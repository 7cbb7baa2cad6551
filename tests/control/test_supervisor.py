"""The supervisor against hand-made readings: what stops the robot, how it stops, and when it steps again."""

import itertools
import math
import random
from collections.abc import Callable, Iterator
from itertools import pairwise

import pytest
from hand_made import BALANCE, DT, rocking

from sarah.control.constants import STANDARD_CONSTANTS
from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import PatternGenerator, Phase, SteppingParameters
from sarah.control.supervisor import State, Supervisor
from sarah.control.supervisor_settings import SupervisorSettings
from sarah.control.watches import NOTHING, Watches
from sarah.robot.reading import SensorReading

STEPPING = SteppingParameters(*PAPER_STEPPING)
STANDING = SensorReading((0.0, 0.0, 9.81), (0.0,) * 3, (75.0,) * 4, (0.0,) * 6)
Change = Callable[[int, SensorReading, SensorReading], SensorReading | None]
"""A tick since the fault began, the reading, and the last one before it, to what the supervisor is given."""


def readings() -> Iterator[SensorReading]:
    """A robot that stands for a second, and then rocks from foot to foot, upright in the sagittal plane."""
    for tick in range(100_000):
        seen = rocking(tick - 100) if tick >= 100 else STANDING
        yield noisy(seen._replace(angular_rate=(0.0, *seen.angular_rate[1:])), tick)


def noisy(reading: SensorReading, seed: int) -> SensorReading:
    drawn = random.Random(seed)
    (ax, ay, az), (wx, wy, wz) = reading.acceleration, reading.angular_rate
    a, b, c, d, e, f = (drawn.gauss(0.0, 0.01) for _ in range(6))
    return reading._replace(acceleration=(ax + a, ay + b, az + c), angular_rate=(wx + d, wy + e, wz + f))


def supervised(**settings: float) -> Supervisor:
    return Supervisor(STEPPING, BALANCE, DT, settings=SupervisorSettings(enabled=True, **settings))


def stopped(change: Change, seconds: float = 4.0, after: float = 3.0) -> tuple[float, str] | None:
    """Time after a fault's beginning at which the robot stops or falls, and why; ``None`` if it steps on."""
    supervisor, began = supervised(), round(after / DT)
    before = NOTHING
    for tick, reading in enumerate(readings()):
        since = tick - began
        before = reading if since < 0 else before
        supervisor.tick(reading if since < 0 else change(since, reading, before), DT)
        if supervisor.state in (State.STOPPING, State.FALLEN):
            assert supervisor.state_change is not None
            return since * DT, supervisor.state_change.reason
        if since * DT > seconds:
            return None
    raise AssertionError


def stuck(signal: str, index: int) -> Change:
    def change(since: int, reading: SensorReading, before: SensorReading) -> SensorReading:
        values = list(getattr(reading, signal))
        values[index] = getattr(before, signal)[index]
        return reading._replace(**{signal: tuple(values)})

    return change


def added(signal: str, index: int, value: float) -> Callable[[int, SensorReading, SensorReading], SensorReading]:
    def change(since: int, reading: SensorReading, before: SensorReading) -> SensorReading:
        values = list(getattr(reading, signal))
        values[index] += value
        return reading._replace(**{signal: tuple(values)})

    return change


def mostly_gone(since: int, reading: SensorReading, before: SensorReading) -> SensorReading:
    return added("angular_rate", 1, math.nan)(0, reading, before) if since % 10 else reading


def test_a_robot_that_steps_is_moved_as_without_a_supervisor() -> None:
    supervisor, generator = supervised(), PatternGenerator(STEPPING, BALANCE, DT)
    for _, reading in zip(range(1500), readings(), strict=False):
        assert supervisor.tick(reading) == generator.tick(reading)
        assert (supervisor.targets, supervisor.phase) == (generator.targets, generator.phase)
    assert supervisor.state is State.STEPPING


@pytest.mark.parametrize(
    ("change", "seconds", "words"),
    [
        (lambda since, reading, before: None, 0.55, "stale: no new reading"),
        (lambda since, reading, before: NOTHING, 0.55, "stale: no new reading"),
        (lambda since, reading, before: before, 0.55, "stale: no new reading"),
        (stuck("angular_rate", 1), 0.1, "frozen: angular rate y"),
        (stuck("acceleration", 0), 0.1, "frozen: acceleration x"),
        (added("acceleration", 2, math.nan), 0.1, "stale: no new acceleration z"),
        (added("angular_rate", 0, 0.1), 2.2, "contradiction: angular rate x says"),
        (lambda since, reading, before: NOTHING if since % 55 < 50 else reading, 2.0, "stale: acceleration x comes in"),
        (mostly_gone, 2.2, "stale: angular rate y comes in"),
    ],
)
def test_what_the_controller_cannot_do_without_stops_it(change: Change, seconds: float, words: str) -> None:
    found = stopped(change)
    assert found is not None
    assert found[0] == pytest.approx(seconds, abs=0.03 if seconds < 1.0 else 0.3)
    assert words in found[1]


@pytest.mark.parametrize(
    "change",
    [
        lambda since, reading, before: None if since < 50 else reading,
        lambda since, reading, before: before if since < 50 else reading,
        lambda since, reading, before: NOTHING if since % 2 else reading,
        stuck("angular_rate", 0),  # V3 alone needs it
        stuck("joints", 2),
        added("pressures", 0, math.nan),
        added("angular_rate", 1, 0.1),
        lambda since, reading, before: added("angular_rate", 1, 50.0)(0, reading, before) if since == 9 else reading,
        lambda since, reading, before: added("angular_rate", 1, 1e200)(0, reading, before) if since == 9 else reading,
        lambda since, reading, before: added("acceleration", 0, 500.0)(0, reading, before) if since == 9 else reading,
    ],
)
def test_what_it_can_do_without_does_not_stop_it(change: Change) -> None:
    assert stopped(change) is None


def test_a_gyroscope_that_only_hums_contradicts_the_pads() -> None:
    def hums(since: int, reading: SensorReading, before: SensorReading) -> SensorReading:
        return reading._replace(angular_rate=(reading.angular_rate[0], 0.001 * (since % 7), reading.angular_rate[2]))

    found = stopped(hums)
    assert found is not None and found[1].startswith("contradiction: angular rate y") and found[0] < 1.5


def test_a_robot_that_does_not_step_stops_after_two_seconds() -> None:
    supervisor, tick = supervised(), 0
    while supervisor.state is not State.STOPPING:
        supervisor.tick(noisy(STANDING, tick))
        tick += 1
    assert tick * DT == pytest.approx(3.0, abs=0.05)
    assert supervisor.state_change is not None and supervisor.state_change.reason == "no step for 2.0 s"


def test_a_joint_that_does_not_follow_is_a_warning() -> None:
    supervisor, said = supervised(), []
    for tick, reading in zip(range(600), readings(), strict=False):
        joints = (0.0, 0.3, *reading.joints[2:]) if tick > 300 else reading.joints
        supervisor.tick(reading._replace(joints=joints))
        said += [supervisor.state_change.reason] if supervisor.state_change is not None else []
    assert said[1:] == ["warning: servo: right_hip_abduction does not follow its target"]
    assert supervisor.state is State.STEPPING


def test_a_robot_that_tips_over_has_fallen_and_its_targets_stay() -> None:
    supervisor, tick = supervised(), 0
    while supervisor.state is not State.FALLEN:
        turned = max(0.0, tick * DT - 1.5)  # to the right, at 1 rad/s
        tips = STANDING._replace(
            acceleration=(-9.81 * math.sin(turned), 0.0, 9.81 * math.cos(turned)),
            angular_rate=(0.0, float(turned > 0.0), 0.0),
        )
        supervisor.tick(noisy(tips, tick))
        tick += 1
    assert turned == pytest.approx(0.5, abs=0.15)  # it looks ten times a second
    held = supervisor.targets
    for _ in range(50):
        supervisor.tick(NOTHING)
    assert supervisor.has_fallen and supervisor.targets == held
    supervisor.step()
    largest = 0.0
    for tick in range(100):
        before = supervisor.targets
        supervisor.tick(noisy(STANDING, tick))
        largest = max(largest, *(abs(now - last) for now, last in zip(supervisor.targets, before, strict=True)))
    assert not any(supervisor.targets) and largest <= 0.06 + 1e-9  # 6 rad/s


def test_it_stands_while_readings_are_missing_and_then_goes_on() -> None:
    supervisor, steps = supervised(), readings()
    while supervisor.phase is not Phase.LIFT or max(supervisor.targets[4:]) < 0.03:
        supervisor.tick(next(steps))
    lengths = []
    for tick in range(40):
        reading = next(steps)
        supervisor.tick(None if tick < 20 else reading)
        lengths.append(max(supervisor.targets[4:]))
    assert lengths[:8] == [0.03] * 8 and lengths[11:20] == [0.0] * 9 and max(lengths[20:]) == 0.03
    assert max(later - now for now, later in pairwise(lengths)) < 0.0101  # 1 m/s
    assert supervisor.state is State.STEPPING


def test_it_stops_at_the_speeds_of_the_controller_and_stands() -> None:
    supervisor = supervised()
    steps = readings()
    while supervisor.phase is not Phase.LIFT or abs(supervisor.targets[5]) + abs(supervisor.targets[4]) < 0.029:
        supervisor.tick(next(steps))
    supervisor.stand()
    lengths = []
    while supervisor.state is not State.STANDING:
        supervisor.tick(next(steps))
        lengths.append(max(supervisor.targets[4:]))
    assert lengths == pytest.approx([0.03, 0.02, 0.01, 0.0], abs=1e-3)  # 1 m/s
    assert supervisor.targets == (0.0,) * 6 and supervisor.phase is Phase.STAND


def test_it_steps_again_only_when_asked_after_a_second_of_standing() -> None:
    supervisor, steps = supervised(), readings()
    standing = [next(steps) for _ in range(100)]
    for reading in (*standing, *(next(steps) for _ in range(300))):
        supervisor.tick(reading)
    supervisor.stand()
    for _ in range(300):
        supervisor.tick(next(steps))
    assert supervisor.state is State.STANDING
    supervisor.step()
    for reading in standing:
        supervisor.tick(reading)
        assert supervisor.state is State.STANDING and not any(supervisor.targets)
    for _ in range(10):
        supervisor.tick(next(steps))
    assert supervisor.state is State.STEPPING and any(supervisor.targets)


def test_parameters_that_do_not_step_are_replaced_by_those_that_did() -> None:
    supervisor, others = supervised(), SteppingParameters(2.0, 2.0, 2.0, 2.0, 2.0)
    for _, reading in zip(range(700), readings(), strict=False):
        supervisor.tick(reading)
    supervisor.set_parameters(others)
    tick = 0
    while supervisor.state_change is None:
        supervisor.tick(noisy(STANDING, tick))
        tick += 1
    assert supervisor.state is State.STEPPING and supervisor.generator.parameters == STEPPING
    assert supervisor.state_change.reason == "the parameters before are back: no step for 2.0 s"


def test_after_a_fall_it_steps_with_what_worked_before() -> None:
    supervisor, others = supervised(), SteppingParameters(0.5, 0.7, 1.2, 0.6, 1.9)
    for _, reading in zip(range(700), readings(), strict=False):
        supervisor.tick(reading)
    supervisor.set_parameters(others)
    lying = STANDING._replace(acceleration=(-9.81 * math.sin(0.7), 0.0, 9.81 * math.cos(0.7)))
    for tick in range(300):
        supervisor.tick(noisy(lying, tick))
    assert supervisor.has_fallen and supervisor.asked[0] == STEPPING
    supervisor.step()
    for tick in range(200):
        supervisor.tick(noisy(STANDING, tick))
    assert supervisor.generator.parameters == STEPPING


def test_ticks_that_come_late_stop_it() -> None:
    once, often = supervised(), supervised()
    for tick, reading in zip(range(800), readings(), strict=False):
        once.tick(reading, 0.11 if tick == 400 else DT)
        often.tick(reading, 0.02)
    assert once.state is State.STEPPING
    assert often.state is State.STANDING


def test_sensors_at_half_the_rate_of_the_loop_are_watched_as_well() -> None:
    kept: list[SensorReading] = []

    def half(since: int, reading: SensorReading, before: SensorReading) -> SensorReading:
        kept[:] = kept if since % 2 and kept else [added("angular_rate", 0, 0.1)(0, reading, before)]
        return kept[0]

    found = stopped(half)
    assert found is not None and found[1].startswith("contradiction: angular rate x") and found[0] < 2.6


def test_readings_whose_lists_are_written_again_are_new_ones() -> None:
    supervisor, acceleration, rate = supervised(), [0.0] * 3, [0.0] * 3
    for _, reading in zip(range(400), readings(), strict=False):
        acceleration[:], rate[:] = reading.acceleration, reading.angular_rate
        supervisor.tick(reading._replace(acceleration=acceleration, angular_rate=rate))  # type: ignore[arg-type]
    assert supervisor.state is State.STEPPING


@pytest.mark.parametrize("late", [0.01, 0.7])
def test_the_second_of_standing_begins_with_readings_in_time(late: float) -> None:
    supervisor, standing = supervised(), [noisy(STANDING, tick) for tick in range(300)]
    for tick, reading in enumerate(standing):
        supervisor.tick(None if tick < 70 else reading, late if tick == 120 else DT)
        if supervisor.state is State.STEPPING:
            break
    assert tick == (170 if late == 0.01 else 221)


def test_a_robot_that_stands_is_watched_and_does_not_step_while_it_lies() -> None:
    supervisor = supervised()
    for tick in range(150):
        supervisor.tick(noisy(STANDING, tick))
    supervisor.stand("tilted floor ahead")
    for tick in range(20):
        supervisor.tick(noisy(STANDING, tick))
    assert supervisor.state is State.STANDING
    lying = STANDING._replace(acceleration=(-9.81 * math.sin(0.7), 0.0, 9.81 * math.cos(0.7)))
    for tick in range(300):
        supervisor.tick(noisy(lying, tick))
    assert supervisor.has_fallen
    supervisor.step()
    for tick in range(300):
        supervisor.tick(noisy(lying, tick))
    assert supervisor.state is State.STANDING


def test_the_words_of_who_stops_it_are_no_fault() -> None:
    supervisor, said = supervised(), []
    for tick, reading in zip(range(600), readings(), strict=False):
        if tick == 500:
            supervisor.stand("no step wanted")
        supervisor.tick(reading)
        said += [supervisor.state_change] if supervisor.state_change is not None else []
        if tick == 501:
            supervisor.step()
    assert [(change.state, change.reason) for change in said[1:]] == [
        (State.STOPPING, "no step wanted"),
        (State.STANDING, "stopped: no step wanted"),
    ]
    for tick in range(110):  # it was asked to step while it stopped
        supervisor.tick(noisy(STANDING, tick))
    assert supervisor.state is State.STEPPING


def test_a_robot_that_stands_has_no_tilt_of_its_last_step() -> None:
    supervisor = supervised()
    for reading in itertools.islice(readings(), 500):
        supervisor.tick(reading)
    assert supervisor.tilt != 0.0
    supervisor.stand()
    for tick in range(200):
        supervisor.tick(noisy(STANDING, tick))
        assert supervisor.tilt == 0.0
    assert supervisor.state is State.STANDING


def test_times_that_are_none_count_as_a_period() -> None:
    supervisor, steps = supervised(), readings()
    for tick in range(400):
        supervisor.tick(next(steps) if tick < 300 else None, (math.nan, -1000.0)[tick % 2])
    assert supervisor.state is State.STANDING


def test_parameters_that_change_all_the_time_do_not_hide_that_it_does_not_step() -> None:
    supervisor = supervised()
    for tick in range(400):
        supervisor.set_parameters(SteppingParameters(0.4 + 1e-6 * tick, *PAPER_STEPPING[1:]))
        supervisor.tick(noisy(STANDING, tick))
    assert supervisor.state is State.STANDING


def test_a_joint_is_believed_again_when_it_follows() -> None:
    watches, lost = Watches(SupervisorSettings(), DT, STANDARD_CONSTANTS), []
    for tick, reading in zip(range(300), readings(), strict=False):
        seen = reading._replace(joints=(0.0, 0.3 if 100 <= tick < 200 else 0.0, 0.0, 0.0, 0.0, 0.0))
        watches.tick(seen, seen, DT, (0.0,) * 6, Phase.STAND, None)
        lost.append(set(watches.lost_joints))
    assert (lost[50], lost[190], lost[299]) == (set(), {1}, set())


def test_a_sensor_that_is_dead_from_the_beginning_is_told_of_once() -> None:
    supervisor, said = supervised(), []
    for tick in range(500):
        seen = noisy(STANDING, tick)
        dead = seen._replace(angular_rate=(seen.angular_rate[0], 0.0, seen.angular_rate[2]))
        supervisor.tick(None if tick < 50 else dead)
        said += [supervisor.state_change.reason] if supervisor.state_change is not None else []
    assert supervisor.state is State.STANDING and len(said) == 2
    assert said[0].startswith("no new reading") and said[1].startswith("stands for another second: frozen")
