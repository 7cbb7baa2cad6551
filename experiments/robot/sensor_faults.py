"""Does the robot go on stepping when its sensors or its control loop fail?

The controller stands behind the fault, which decides what it reads and whether its tick takes place. Faults stay,
unless their name says otherwise. The simulated robot and the judgement of the episode are not touched.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from statistics import mean
from typing import Any, NamedTuple

from pandas import DataFrame

from experiments.experiment import Experiment, product
from experiments.record import Row
from experiments.tables import format_of, table
from sarah.control.pattern_generator import PatternGenerator, PhaseChange
from sarah.episode.episode import Episode
from sarah.episode.push import NO_PUSH
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.robot.filters import ramped
from sarah.robot.reading import SensorReading

FIRST_TICKS, TICKS_LATER = 200, 3
"""Ticks of stepping before the fault begins, and how many later it does in each further episode. So faults meet the
robot in any phase."""
HIPS = {"locked": (0.0, 0.0, 0.0, 0.0), "V1 = 1, V3 = 0.7": (1.0, 0.0, 0.7, 0.0)}
"""Values of V1 to V4, by name."""

Heard = SensorReading | None
Change = Callable[[SensorReading, SensorReading], Heard]
"""What the controller hears, of the reading and of the last one before the fault; None if its tick does not take
place."""
NOTHING = SensorReading((math.nan,) * 3, (math.nan,) * 3, (math.nan,) * 4, (math.nan,) * 6)
"""A reading of which no signal has come."""


def _signal(field: str, elements: tuple[int, ...], value: float | None = None, added: float = 0.0) -> Change:
    """Some elements of a signal are stuck, at their last value unless another is given, or something is added."""

    def change(reading: SensorReading, before: SensorReading) -> Heard:
        values = list(getattr(reading, field))
        for k in elements:
            stuck = getattr(before, field)[k] if value is None else value
            values[k] = values[k] + added if added else stuck
        return reading._replace(**{field: tuple(values)})

    return change


def _constant(heard: Heard) -> Change:
    return lambda reading, before: heard


LOST, MISSED = _constant(NOTHING), _constant(None)


class Fault(NamedTuple):
    """A fault."""

    change: Change = lambda reading, before: reading  # what it does to readings
    when: Callable[[int], bool] = lambda ticks: True  # whether it is there, by the ticks since it began
    delay_seconds: float = 0.01  # delay of all readings, in s
    to_zero: bool = False  # whether targets go to zero, as fast as the controller moves them, while it misses ticks
    is_told: bool = False  # whether the controller is told how much time has passed since its last tick


FAULTS = {
    "none": Fault(),
    "one reading in ten is not finite": Fault(LOST, lambda ticks: ticks % 10 == 0),
    "every second reading is not finite": Fault(LOST, lambda ticks: ticks % 2 == 0),
    "no reading is finite for 0.5 s": Fault(LOST, lambda ticks: ticks < 50),
    "no reading is finite any more": Fault(LOST),
    "lateral acceleration: not finite any more": Fault(_signal("acceleration", (0,), math.nan)),
    "rate about y: not finite any more": Fault(_signal("angular_rate", (1,), math.nan)),
    "one pad: not finite any more": Fault(_signal("pressures", (0,), math.nan)),
    "left flexion joint: not finite any more": Fault(_signal("joints", (2,), math.nan)),
    "all joints: not finite any more": Fault(_signal("joints", (0, 1, 2, 3, 4, 5), math.nan)),
    "the same reading comes for 0.1 s": Fault(lambda reading, before: before, lambda ticks: ticks < 10),
    "the same reading comes for 0.5 s": Fault(lambda reading, before: before, lambda ticks: ticks < 50),
    "the same reading comes for ever": Fault(lambda reading, before: before),
    "lateral acceleration: 0": Fault(_signal("acceleration", (0,), 0.0)),
    "lateral acceleration: 0.2 m/s² too high": Fault(_signal("acceleration", (0,), added=0.2)),
    "lateral acceleration: 0.5 m/s² too high": Fault(_signal("acceleration", (0,), added=0.5)),
    "rate about y: 0": Fault(_signal("angular_rate", (1,), 0.0)),
    "rate about y: stuck": Fault(_signal("angular_rate", (1,))),
    "rate about y: 0.1 rad/s too high": Fault(_signal("angular_rate", (1,), added=0.1)),
    "rate about x: 0": Fault(_signal("angular_rate", (0,), 0.0)),
    "rate about x: 0.1 rad/s too high": Fault(_signal("angular_rate", (0,), added=0.1)),
    "one pad: 0 N": Fault(_signal("pressures", (0,), 0.0)),
    "both pads of a foot: 0 N": Fault(_signal("pressures", (0, 1), 0.0)),
    "all pads: 0 N": Fault(_signal("pressures", (0, 1, 2, 3), 0.0)),
    "one pad: stuck at 300 N": Fault(_signal("pressures", (0,), 300.0)),
    "right abduction joint: stuck at 0.3 rad": Fault(_signal("joints", (1,), 0.3)),
    "right abduction joint: 0.1 rad off": Fault(_signal("joints", (1,), added=0.1)),
    "one tick in ten is missed": Fault(MISSED, lambda ticks: ticks % 10 == 0),
    "every second tick is missed": Fault(MISSED, lambda ticks: ticks % 2 == 0),
    "every second tick is missed, and time is told": Fault(MISSED, lambda ticks: ticks % 2 == 0, is_told=True),
    "ten ticks are missed, once": Fault(MISSED, lambda ticks: ticks < 10),
    "ten ticks are missed, once, and time is told": Fault(MISSED, lambda ticks: ticks < 10, is_told=True),
    "no tick any more, targets stay": Fault(MISSED),
    "no tick any more, targets go to zero": Fault(MISSED, to_zero=True),
    "delay of 20 ms": Fault(delay_seconds=0.02),
    "delay of 30 ms": Fault(delay_seconds=0.03),
    "delay of 50 ms": Fault(delay_seconds=0.05),
}
"""Faults, by what happens; a delay is there from the beginning."""


class _BehindFault:
    """A pattern generator that hears its sensors through a fault, which begins after some ticks of stepping."""

    def __init__(self, generator: PatternGenerator, fault: Fault, begin: int, dt: float) -> None:
        self.since = -begin
        self.targets: tuple[float, ...] = generator.targets
        self.changes: list[PhaseChange] = []
        self._generator, self._fault, self._dt, self._missed = generator, fault, dt, 0
        constants = generator.constants
        self._largest_moves = [constants.hip_speed * dt] * 4 + [constants.leg_speed * dt] * 2
        self._before: SensorReading | None = None

    def __getattr__(self, name: str) -> Any:
        return getattr(self._generator, name)

    def tick(self, reading: SensorReading) -> PhaseChange | None:
        since = self.since
        heard: Heard = reading
        self.since += 1
        if since < 0 or self._before is None:
            self._before = reading
        elif self._fault.when(since):
            heard = self._fault.change(reading, self._before)
        if heard is None:
            self._missed += 1
            if self._fault.to_zero:
                moves = zip(self.targets, self._largest_moves, strict=True)
                self.targets = tuple(ramped(target, 0.0, largest) for target, largest in moves)
            return None
        change = self._generator.tick(heard, (1 + self._missed) * self._dt if self._fault.is_told else None)
        self._missed, self.targets = 0, self._generator.targets
        if since >= 0 and change is not None:
            self.changes.append(change)
        return change


@dataclass(frozen=True)
class SensorFaults(Experiment):
    """Faults of sensors and of the control loop, with locked hips and with the hip law, without a push."""

    seeds: int = 20  # number of episodes
    time_limit: float = 15.0  # time limit of an episode, in s

    def cases(self) -> list[Row]:
        """Each fault and hips."""
        return product(fault=FAULTS, hips=HIPS)

    def rows(self, fault: str, hips: str) -> Iterator[Row]:
        """Survival, and how the robot steps from the fault on."""
        outcomes = [self._simulated(FAULTS[fault], HIPS[hips], seed) for seed in range(self.seeds)]
        survived, steps_per_second, by_sensors = map(mean, zip(*outcomes, strict=True))
        yield {"survival": survived, "steps_per_second": steps_per_second, "phases_by_sensors": by_sensors}

    def _simulated(self, fault: Fault, hips: tuple[float, ...], seed: int) -> tuple[bool, float, float]:
        """Whether the robot stays in its place, its steps per second, and its share of phases that sensors end."""
        config = BalanceConfig(engine="pybullet", push=NO_PUSH, time_limit=self.time_limit)
        config = replace(config, randomisation=replace(config.randomisation, delay_seconds=fault.delay_seconds))
        dt = config.physics.control_dt
        with Episode(config, seed, BALANCE) as episode:
            episode.stand()
            episode.start(hips)
            generator = _BehindFault(episode.robot.generator, fault, FIRST_TICKS + TICKS_LATER * seed, dt)
            episode.robot.generator = generator  # type: ignore[assignment]  # whatever an episode asks of it, it has
            while episode.termination is None:
                episode.tick()
        changes, seconds = generator.changes, generator.since * dt
        return (
            episode.termination == "time_limit",
            sum(change.is_step for change in changes) / seconds if seconds > 0 else 0.0,
            sum(change.by_sensors for change in changes) / len(changes) if changes else 0.0,
        )


FULL = SensorFaults()
QUICK = SensorFaults(seeds=1, time_limit=1.1)


def faults(rows: DataFrame) -> str:
    """What becomes of the robot, with locked hips and with the hip law."""
    columns = ("survival", "steps_per_second", "phases_by_sensors")
    wide = rows.pivot(index="fault", columns="hips", values=list(columns)).reindex(index=list(FAULTS))
    formats = {f"{column}, {hips}": format_of(column) for column in columns for hips in HIPS}
    wide.columns = wide.columns.map(", ".join)
    caption = (
        f"Survival of {FULL.seeds} robots with the shipped P1 to P5 in PyBullet, steps per second, and share of phases "
        f"that sensors end, both from the fault on; with locked hips, and with V1 = 1 and V3 = 0.7."
    )
    return table(wide.reset_index(), ["fault", *formats], caption, **formats)
