"""The supervisor against hand-made readings: what stops the robot, how it stops, and when it steps again."""

import itertools
import math
import random
from collections.abc import Callable, Iterable, Iterator
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
BEGAN = 300
"""Tick in which faults begin."""


def noisy(reading: SensorReading, seed: int) -> SensorReading:
    drawn = random.Random(seed)
    a, w = ([signal + drawn.gauss(0.0, 0.01) for signal in signals] for signals in reading[:2])
    return reading._replace(acceleration=(a[0], a[1], a[2]), angular_rate=(w[0], w[1], w[2]))


def stepping(tick: int) -> SensorReading:
    """A reading of a robot that stands for a second, and then rocks from foot to foot, and does not pitch."""
    seen = rocking(tick - 100) if tick >= 100 else STANDING
    return noisy(seen._replace(angular_rate=(0.0, *seen.angular_rate[1:])), tick)


def steps(end: int, begin: int = 0) -> list[SensorReading]:
    return list(map(stepping, range(begin, end)))


def still(ticks: int, steady: SensorReading = STANDING) -> list[SensorReading]:
    return [noisy(steady, tick) for tick in range(ticks)]


def supervised(**settings: float) -> Supervisor:
    return Supervisor(STEPPING, BALANCE, DT, settings=SupervisorSettings(enabled=True, **settings))


def fed(supervisor: Supervisor, given: Iterable[SensorReading | None]) -> list[str]:
    """What a supervisor says that it does, one reading a tick."""
    said = []
    for reading in given:
        supervisor.tick(reading)
        said += [supervisor.state_change.reason] if supervisor.state_change is not None else []
    return said


def stopped(change: Change, seconds: float = 4.0) -> tuple[float, str] | None:
    """Time after a fault's beginning at which the robot stops or falls, and why; ``None`` if it steps on."""
    supervisor = supervised()
    fed(supervisor, steps(BEGAN))
    for since in range(round(seconds / DT)):
        supervisor.tick(change(since, stepping(BEGAN + since), stepping(BEGAN - 1)), DT)
        if supervisor.state in (State.STOPPING, State.FALLEN):
            assert supervisor.state_change is not None
            return since * DT, supervisor.state_change.reason
    return None


def altered(signal: str, index: int, alter: Callable[[float, float], float]) -> Change:
    """A fault of one signal, by its value and the one before the fault."""

    def change(since: int, reading: SensorReading, before: SensorReading) -> SensorReading:
        values = list(getattr(reading, signal))
        values[index] = alter(values[index], getattr(before, signal)[index])
        return reading._replace(**{signal: tuple(values)})

    return change


def stuck(signal: str, index: int) -> Change:
    return altered(signal, index, lambda _, before: before)


def added(signal: str, index: int, value: float) -> Change:
    return altered(signal, index, lambda now, _: now + value)


def at(tick: int, fault: Change) -> Change:
    return lambda since, reading, before: fault(since, reading, before) if since == tick else reading


def hums(since: int, reading: SensorReading, before: SensorReading) -> SensorReading:
    return reading._replace(angular_rate=(reading.angular_rate[0], 0.001 * (since % 7), reading.angular_rate[2]))


def mostly_gone(since: int, reading: SensorReading, before: SensorReading) -> SensorReading | None:
    return added("angular_rate", 1, math.nan)(0, reading, before) if since % 10 else reading


def at_half_the_rate(since: int, reading: SensorReading, before: SensorReading) -> SensorReading | None:
    return added("angular_rate", 0, 0.1)(0, stepping(BEGAN + since - since % 2), before)


def test_a_robot_that_steps_is_moved_as_without_a_supervisor() -> None:
    supervisor, generator = supervised(), PatternGenerator(STEPPING, BALANCE, DT)
    for reading in steps(1500):
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
        (at_half_the_rate, 2.2, "contradiction: angular rate x says"),
        (hums, 1.1, "contradiction: angular rate y"),
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
        *(at(9, added(*outlier)) for outlier in (("angular_rate", 1, 50.0), ("angular_rate", 1, 1e200))),
        at(9, added("acceleration", 0, 500.0)),
    ],
)
def test_what_it_can_do_without_does_not_stop_it(change: Change) -> None:
    assert stopped(change) is None


def test_a_robot_that_does_not_step_stops_after_two_seconds() -> None:
    supervisor = supervised()
    assert fed(supervisor, still(295))[1:] == [] and supervisor.state is State.STEPPING
    assert fed(supervisor, still(10)) == ["no step for 2.0 s", "stopped: no step for 2.0 s"]


def test_a_joint_that_does_not_follow_is_a_warning() -> None:
    supervisor = supervised()
    askew = [reading._replace(joints=(0.0, 0.3, *reading.joints[2:])) for reading in steps(600, 301)]
    said = fed(supervisor, [*steps(301), *askew])
    assert said[1:] == ["warning: servo: right_hip_abduction does not follow its target"]
    assert supervisor.state is State.STEPPING


def test_a_robot_that_tips_over_has_fallen_and_its_targets_stay() -> None:
    supervisor, tick = supervised(), 0
    while supervisor.state is not State.FALLEN:
        turned = max(0.0, tick * DT - 1.5)  # to the right, at 1 rad/s
        supervisor.tick(noisy(leaning(turned, float(turned > 0.0)), tick))
        tick += 1
    assert turned == pytest.approx(0.5, abs=0.15)  # it looks ten times a second
    held = supervisor.targets
    fed(supervisor, [NOTHING] * 50)
    assert supervisor.has_fallen and supervisor.targets == held
    supervisor.step()
    largest = 0.0
    for reading in still(100):
        before = supervisor.targets
        supervisor.tick(reading)
        largest = max(largest, *(abs(now - last) for now, last in zip(supervisor.targets, before, strict=True)))
    assert not any(supervisor.targets) and largest <= 0.06 + 1e-9  # 6 rad/s


def leaning(radians: float, rate: float = 0.0) -> SensorReading:
    acceleration = (-9.81 * math.sin(radians), 0.0, 9.81 * math.cos(radians))
    return STANDING._replace(acceleration=acceleration, angular_rate=(0.0, rate, 0.0))


def lifted() -> tuple[Supervisor, Iterator[SensorReading]]:
    """A supervised robot whose swing leg is as short as it gets, and its further readings."""
    supervisor, following = supervised(), map(stepping, itertools.count())
    while supervisor.phase is not Phase.LIFT or max(supervisor.targets[4:]) < 0.03:
        supervisor.tick(next(following))
    return supervisor, following


def test_it_stands_while_readings_are_missing_and_then_goes_on() -> None:
    supervisor, following = lifted()
    lengths = []
    for tick in range(40):
        reading = next(following)
        supervisor.tick(None if tick < 20 else reading)
        lengths.append(max(supervisor.targets[4:]))
    assert lengths[:8] == [0.03] * 8 and lengths[11:20] == [0.0] * 9 and max(lengths[20:]) == 0.03
    assert max(later - now for now, later in pairwise(lengths)) < 0.0101  # 1 m/s
    assert supervisor.state is State.STEPPING


def test_it_stops_at_the_speeds_of_the_controller_and_stands() -> None:
    supervisor, following = lifted()
    supervisor.stand()
    lengths = []
    while supervisor.state is not State.STANDING:
        supervisor.tick(next(following))
        lengths.append(max(supervisor.targets[4:]))
    assert lengths == pytest.approx([0.03, 0.02, 0.01, 0.0], abs=1e-3)  # 1 m/s
    assert supervisor.targets == (0.0,) * 6 and supervisor.phase is Phase.STAND


def test_it_steps_again_when_asked_after_a_second_of_standing() -> None:
    supervisor = supervised()
    fed(supervisor, steps(400))
    assert supervisor.tilt != 0.0
    supervisor.stand()
    for reading in steps(700, 400):
        supervisor.tick(reading)
        assert supervisor.tilt == 0.0  # it has none of its last step
    assert supervisor.state is State.STANDING
    supervisor.step()
    for reading in steps(100):
        supervisor.tick(reading)
        assert supervisor.state is State.STANDING and not any(supervisor.targets)
    fed(supervisor, steps(710, 700))
    assert supervisor.state is State.STEPPING and any(supervisor.targets)


def test_parameters_without_a_step_are_replaced_by_those_before() -> None:
    supervisor = supervised()
    fed(supervisor, steps(700))
    supervisor.set_parameters(SteppingParameters(2.0, 2.0, 2.0, 2.0, 2.0))
    assert fed(supervisor, still(210)) == ["the parameters before are back: no step for 2.0 s"]
    assert supervisor.state is State.STEPPING and supervisor.generator.parameters == STEPPING


def test_after_a_fall_it_steps_with_what_worked_before() -> None:
    supervisor = supervised()
    fed(supervisor, steps(700))
    supervisor.set_parameters(SteppingParameters(0.5, 0.7, 1.2, 0.6, 1.9))
    fed(supervisor, still(300, leaning(0.7)))
    assert supervisor.has_fallen and supervisor.asked[0] == STEPPING
    supervisor.step()
    fed(supervisor, still(200))
    assert supervisor.generator.parameters == STEPPING


def test_ticks_that_come_late_stop_it() -> None:
    once, often = supervised(), supervised()
    for tick, reading in enumerate(steps(800)):
        once.tick(reading, 0.11 if tick == 400 else DT)
        often.tick(reading, 0.02)
    assert once.state is State.STEPPING
    assert often.state is State.STANDING


def test_readings_whose_lists_are_written_again_are_new_ones() -> None:
    supervisor, acceleration, rate = supervised(), [0.0] * 3, [0.0] * 3
    for reading in steps(400):
        acceleration[:], rate[:] = reading.acceleration, reading.angular_rate
        supervisor.tick(reading._replace(acceleration=acceleration, angular_rate=rate))  # type: ignore[arg-type]
    assert supervisor.state is State.STEPPING


@pytest.mark.parametrize(("late", "begins"), [(0.01, 170), (0.7, 221)])
def test_the_second_of_standing_begins_with_readings_in_time(late: float, begins: int) -> None:
    supervisor = supervised()
    for tick, reading in enumerate(still(begins + 1)):
        assert supervisor.state is State.STANDING
        supervisor.tick(None if tick < 70 else reading, late if tick == 120 else DT)
    assert supervisor.state is State.STEPPING


def test_who_stands_is_watched_and_does_not_step_while_it_lies() -> None:
    supervisor = supervised()
    fed(supervisor, still(150))
    supervisor.stand("tilted floor ahead")  # words of who stops it, and no fault
    assert fed(supervisor, still(20)) == ["tilted floor ahead", "stopped: tilted floor ahead"]
    assert supervisor.state is State.STANDING
    fed(supervisor, still(300, leaning(0.7)))
    assert supervisor.has_fallen
    supervisor.step()
    fed(supervisor, still(300, leaning(0.7)))
    assert supervisor.state is State.STANDING


def test_who_is_asked_to_step_while_it_stops_steps_again() -> None:
    supervisor, following = lifted()
    supervisor.stand("no step wanted")
    assert fed(supervisor, [next(following)]) == ["no step wanted"] and supervisor.state is State.STOPPING
    supervisor.step()
    assert fed(supervisor, still(110)) == ["stopped: no step wanted", "stood for a second"]


def test_times_that_are_none_count_as_a_period() -> None:
    supervisor = supervised()
    for tick, reading in enumerate(steps(400)):
        supervisor.tick(reading if tick < 300 else None, (math.nan, -1000.0)[tick % 2])
    assert supervisor.state is State.STANDING


def test_parameters_that_keep_changing_hide_no_missing_step() -> None:
    supervisor = supervised()
    for tick, reading in enumerate(still(400)):
        supervisor.set_parameters(SteppingParameters(0.4 + 1e-6 * tick, *PAPER_STEPPING[1:]))
        supervisor.tick(reading)
    assert supervisor.state is State.STANDING


def test_a_joint_is_believed_again_when_it_follows() -> None:
    watches, lost = Watches(SupervisorSettings(), DT, STANDARD_CONSTANTS), []
    for tick, reading in enumerate(steps(300)):
        seen = reading._replace(joints=(0.0, 0.3 if 100 <= tick < 200 else 0.0, 0.0, 0.0, 0.0, 0.0))
        watches.tick(seen, seen, DT, (0.0,) * 6, Phase.STAND, None)
        lost.append(set(watches.lost_joints))
    assert (lost[50], lost[190], lost[299]) == (set(), {1}, set())


def test_a_sensor_dead_from_the_beginning_is_told_of_once() -> None:
    supervisor = supervised()
    dead = [stuck("angular_rate", 1)(0, seen, STANDING) for seen in still(500)[50:]]
    said = fed(supervisor, [*[None] * 50, *dead])
    assert supervisor.state is State.STANDING and len(said) == 2
    assert said[0].startswith("no new reading") and said[1].startswith("stands for another second: frozen")
