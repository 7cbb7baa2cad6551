"""What becomes of a stepping robot whose sensors or control loop fail. Faults stay, unless their name says otherwise.

The controller stands behind the fault, which decides what it reads and whether its tick takes place. The simulated
robot and the judgement of the episode are not touched.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from statistics import mean
from typing import Any, NamedTuple

from experiments.maker import ParallelExperiment
from experiments.record import Row
from sarah.control.pattern_generator import PatternGenerator, PhaseChange
from sarah.episode.episode import Episode
from sarah.episode.push import Push
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.episode.workers import Workers
from sarah.robot.filters import ramped
from sarah.robot.reading import SensorReading

FIRST_TICKS, TICKS_LATER = 200, 3
"""Ticks of stepping before the fault begins, and how many later it does in each further episode. So faults meet the
robot in any phase."""
STUCK_PAD = 300.0
"""Load that a stuck pad reports, in N: about the weight of the robot."""
HIPS = {"locked": (0.0, 0.0, 0.0, 0.0), "V1 = 1, V3 = 0.7": (1.0, 0.0, 0.7, 0.0)}
"""Values of V1 to V4."""

Heard = SensorReading | None
Change = Callable[[SensorReading, SensorReading, int], Heard]
"""What the controller hears, of the reading, of the last one before the fault, and of the ticks since the fault began;
None if its tick does not take place."""
NOTHING = SensorReading((math.nan,) * 3, (math.nan,) * 3, (math.nan,) * 4, (math.nan,) * 6)
"""A reading of which no signal has come."""


def exact(reading: SensorReading, before: SensorReading, ticks: int) -> Heard:
    """No fault."""
    return reading


def signal(field: str, elements: tuple[int, ...], value: float | None = None, added: float = 0.0) -> Change:
    """A fault of some elements of a signal.

    :param field: name of the signal
    :param elements: indices of the elements that fail
    :param value: value that they are stuck at; by default the last one before the fault, unless something is added
    :param added: constant that is added to them instead
    """

    def change(reading: SensorReading, before: SensorReading, ticks: int) -> Heard:
        stuck = getattr(before, field)
        values = [
            x if k not in elements else x + added if added else stuck[k] if value is None else value
            for k, x in enumerate(getattr(reading, field))
        ]
        return reading._replace(**{field: tuple(values)})

    return change


def at_times(fails: Callable[[int], bool], change: Change) -> Change:
    """A fault that comes and goes.

    :param fails: whether it is there, by the ticks since it began
    :param change: the fault
    """
    return lambda reading, before, ticks: change(reading, before, ticks) if fails(ticks) else reading


def repeated(reading: SensorReading, before: SensorReading, ticks: int) -> Heard:
    """The last reading before the fault again."""
    return before


def lost(reading: SensorReading, before: SensorReading, ticks: int) -> Heard:
    """No signal is finite."""
    return NOTHING


def missed(reading: SensorReading, before: SensorReading, ticks: int) -> Heard:
    """No tick: the targets stay."""
    return None


class Fault(NamedTuple):
    """A fault.

    :param change: what it does to readings
    :param delay_seconds: delay of all readings, in s
    :param to_zero: whether targets go to zero, at the speeds of the controller, while its ticks do not take place
    :param is_told: whether the controller is told how much time has passed since its last tick
    """

    change: Change = exact
    delay_seconds: float = 0.01
    to_zero: bool = False
    is_told: bool = False


FAULTS = {
    "none": Fault(),
    "one reading in ten is not finite": Fault(at_times(lambda ticks: ticks % 10 == 0, lost)),
    "every second reading is not finite": Fault(at_times(lambda ticks: ticks % 2 == 0, lost)),
    "no reading is finite for 0.5 s": Fault(at_times(lambda ticks: ticks < 50, lost)),
    "no reading is finite any more": Fault(lost),
    "lateral acceleration: not finite any more": Fault(signal("acceleration", (0,), math.nan)),
    "rate about y: not finite any more": Fault(signal("angular_rate", (1,), math.nan)),
    "one pad: not finite any more": Fault(signal("pressures", (0,), math.nan)),
    "left flexion joint: not finite any more": Fault(signal("joints", (2,), math.nan)),
    "all joints: not finite any more": Fault(signal("joints", (0, 1, 2, 3, 4, 5), math.nan)),
    "the same reading comes for 0.1 s": Fault(at_times(lambda ticks: ticks < 10, repeated)),
    "the same reading comes for 0.5 s": Fault(at_times(lambda ticks: ticks < 50, repeated)),
    "the same reading comes for ever": Fault(repeated),
    "lateral acceleration: 0": Fault(signal("acceleration", (0,), 0.0)),
    "lateral acceleration: 0.2 m/s² too high": Fault(signal("acceleration", (0,), added=0.2)),
    "lateral acceleration: 0.5 m/s² too high": Fault(signal("acceleration", (0,), added=0.5)),
    "rate about y: 0": Fault(signal("angular_rate", (1,), 0.0)),
    "rate about y: stuck": Fault(signal("angular_rate", (1,))),
    "rate about y: 0.1 rad/s too high": Fault(signal("angular_rate", (1,), added=0.1)),
    "rate about x: 0": Fault(signal("angular_rate", (0,), 0.0)),
    "rate about x: 0.1 rad/s too high": Fault(signal("angular_rate", (0,), added=0.1)),
    "one pad: 0 N": Fault(signal("pressures", (0,), 0.0)),
    "both pads of a foot: 0 N": Fault(signal("pressures", (0, 1), 0.0)),
    "all pads: 0 N": Fault(signal("pressures", (0, 1, 2, 3), 0.0)),
    "one pad: stuck at 300 N": Fault(signal("pressures", (0,), STUCK_PAD)),
    "right abduction joint: stuck at 0.3 rad": Fault(signal("joints", (1,), 0.3)),
    "right abduction joint: 0.1 rad off": Fault(signal("joints", (1,), added=0.1)),
    "one tick in ten is missed": Fault(at_times(lambda ticks: ticks % 10 == 0, missed)),
    "every second tick is missed": Fault(at_times(lambda ticks: ticks % 2 == 0, missed)),
    "every second tick is missed, and time is told": Fault(
        at_times(lambda ticks: ticks % 2 == 0, missed), is_told=True
    ),
    "ten ticks are missed, once": Fault(at_times(lambda ticks: ticks < 10, missed)),
    "ten ticks are missed, once, and time is told": Fault(at_times(lambda ticks: ticks < 10, missed), is_told=True),
    "no tick any more, targets stay": Fault(missed),
    "no tick any more, targets go to zero": Fault(missed, to_zero=True),
    "delay of 20 ms": Fault(delay_seconds=0.02),
    "delay of 30 ms": Fault(delay_seconds=0.03),
    "delay of 50 ms": Fault(delay_seconds=0.05),
}
"""Faults, by what happens; a delay is there from the beginning."""


class BehindFault:
    """A pattern generator that hears its sensors through a fault.

    :param generator: pattern generator
    :param fault: fault
    :param begin: ticks of stepping before the fault begins
    :param dt: control period, in s
    """

    def __init__(self, generator: PatternGenerator, fault: Fault, begin: int, dt: float) -> None:
        self.since = -begin
        self.targets: tuple[float, ...] = generator.targets
        self.changes: list[PhaseChange] = []
        constants = generator.constants
        self._generator = generator
        self._fault = fault
        self._largest_moves = [constants.hip_speed * dt] * 4 + [constants.leg_speed * dt] * 2
        self._before: SensorReading | None = None
        self._dt = dt
        self._missed = 0

    def __getattr__(self, name: str) -> Any:
        """Anything else is the pattern generator's."""
        return getattr(self._generator, name)

    def tick(self, reading: SensorReading) -> PhaseChange | None:
        """Advance by one control tick, unless the fault is that it does not take place.

        :param reading: sensor reading of this tick, without the fault
        """
        since, heard = self.since, reading
        self.since += 1
        if since < 0 or self._before is None:
            self._before = reading
        else:
            changed = self._fault.change(reading, self._before, since)
            if changed is None:
                if self._fault.to_zero:
                    moves = zip(self.targets, self._largest_moves, strict=True)
                    self.targets = tuple(ramped(target, 0.0, largest) for target, largest in moves)
                self._missed += 1
                return None
            heard = changed
        change = self._generator.tick(heard, (1 + self._missed) * self._dt if self._fault.is_told else None)
        self._missed = 0
        self.targets = self._generator.targets
        if since >= 0 and change is not None:
            self.changes.append(change)
        return change


class Outcome(NamedTuple):
    """What became of an episode with a fault.

    :param survived: whether the robot stayed in its place to the end
    :param steps_per_second: steps per second from the fault on
    :param by_sensors: share of the phases from the fault on that sensors ended
    """

    survived: bool
    steps_per_second: float
    by_sensors: float


def simulate(name: str, hips: str, seed: int, time_limit: float) -> Outcome:
    """Simulate an episode with a fault.

    :param name: name of the fault
    :param hips: name of V1 to V4
    :param seed: seed of the episode
    :param time_limit: time limit of the episode, in s
    """
    fault = FAULTS[name]
    config = BalanceConfig(engine="pybullet", push=Push(newtons=(0.0, 0.0)), time_limit=time_limit)
    config = replace(config, randomisation=replace(config.randomisation, delay_seconds=fault.delay_seconds))
    dt = config.physics.control_dt
    with Episode(config, seed, BALANCE) as episode:
        episode.stand()
        episode.start(HIPS[hips])
        generator = BehindFault(episode.robot.generator, fault, FIRST_TICKS + TICKS_LATER * seed, dt)
        episode.robot.generator = generator  # type: ignore[assignment]  # whatever an episode asks of it, it has
        while episode.termination is None:
            episode.tick()
    changes, seconds = generator.changes, generator.since * dt
    return Outcome(
        episode.termination == "time_limit",
        sum(change.is_step for change in changes) / seconds if seconds > 0 else 0.0,
        sum(change.by_sensors for change in changes) / len(changes) if changes else 0.0,
    )


@dataclass(frozen=True)
class SensorFaults(ParallelExperiment):
    """Faults of sensors and of the control loop, with locked hips and with the hip law, without a push.

    :param seeds: number of episodes
    :param time_limit: time limit of an episode, in s
    """

    seeds: int = 20
    time_limit: float = 15.0

    def rows(self) -> Iterator[Row]:
        """A row for each fault and hips."""
        with Workers(self.workers) as workers:
            for name in FAULTS:
                for hips in HIPS:
                    jobs = [workers.submit(simulate, name, hips, seed, self.time_limit) for seed in range(self.seeds)]
                    outcomes = [job.result() for job in jobs]
                    yield {
                        "fault": name,
                        "hips": hips,
                        "survival": mean(outcome.survived for outcome in outcomes),
                        "steps_per_second": mean(outcome.steps_per_second for outcome in outcomes),
                        "phases_by_sensors": mean(outcome.by_sensors for outcome in outcomes),
                    }
