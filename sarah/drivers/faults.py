"""Faults of a simulated robot's sensors and of its control loop, by name.

A fault stands between sensors and controller. It decides what the controller reads, and whether its tick takes place.
It stays, unless its name says otherwise.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from sarah.control.watches import NOTHING
from sarah.robot.reading import SensorReading

Change = Callable[[SensorReading, SensorReading], SensorReading]
"""What the controller reads, of the reading and of the last one before the fault."""


def _signal(field: str, elements: tuple[int, ...], value: float | None = None, added: float = 0.0) -> Change:
    """Some elements of a signal are stuck, at their last value unless another is given, or something is added."""

    def change(reading: SensorReading, before: SensorReading) -> SensorReading:
        values = list(getattr(reading, field))
        for k in elements:
            stuck = getattr(before, field)[k] if value is None else value
            values[k] = values[k] + added if added else stuck
        return reading._replace(**{field: tuple(values)})

    return change


def _lost(reading: SensorReading, before: SensorReading) -> SensorReading:
    return NOTHING


def _repeated(reading: SensorReading, before: SensorReading) -> SensorReading:
    return before


def _never(seconds: float, tick: int) -> bool:
    return False


@dataclass(frozen=True)
class Fault:
    """A fault of a robot's sensors, or of its control loop.

    :param change: what it does to readings
    :param when: whether it is there, by the time and the number of ticks since it began
    :param misses: whether a tick is missed, by the same
    :param to_zero_after: time without a tick after which the robot's own electronics move the targets to zero, in s
    :param delay_seconds: delay of all readings, in s, from the beginning on; ``None`` for the usual one
    """

    change: Change = lambda reading, before: reading
    when: Callable[[float, int], bool] = lambda seconds, tick: True
    misses: Callable[[float, int], bool] = _never
    to_zero_after: float = math.inf
    delay_seconds: float | None = None


def _one_in(number: int) -> Callable[[float, int], bool]:
    return lambda seconds, tick: tick % number == 0


def _for(duration: float) -> Callable[[float, int], bool]:
    return lambda seconds, tick: seconds < duration - 1e-9


def _always(seconds: float, tick: int) -> bool:
    return True


FAULTS = {
    "none": Fault(),
    "one reading in ten is not finite": Fault(_lost, _one_in(10)),
    "every second reading is not finite": Fault(_lost, _one_in(2)),
    "no reading is finite for 0.5 s": Fault(_lost, _for(0.5)),
    "no reading is finite any more": Fault(_lost),
    "lateral acceleration: not finite any more": Fault(_signal("acceleration", (0,), math.nan)),
    "rate about y: not finite any more": Fault(_signal("angular_rate", (1,), math.nan)),
    "one pad: not finite any more": Fault(_signal("pressures", (0,), math.nan)),
    "left flexion joint: not finite any more": Fault(_signal("joints", (2,), math.nan)),
    "all joints: not finite any more": Fault(_signal("joints", (0, 1, 2, 3, 4, 5), math.nan)),
    "the same reading comes for 0.1 s": Fault(_repeated, _for(0.1)),
    "the same reading comes for 0.5 s": Fault(_repeated, _for(0.5)),
    "the same reading comes for ever": Fault(_repeated),
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
    "one tick in ten is missed": Fault(misses=_one_in(10)),
    "every second tick is missed": Fault(misses=_one_in(2)),
    "ten ticks are missed, once": Fault(misses=_for(0.1)),
    "no tick any more, targets stay": Fault(misses=_always),
    "no tick any more, targets go to zero": Fault(misses=_always, to_zero_after=0.0),
    "no tick any more, targets go to zero after 0.1 s": Fault(misses=_always, to_zero_after=0.1),
    "delay of 20 ms": Fault(delay_seconds=0.02),
    "delay of 30 ms": Fault(delay_seconds=0.03),
    "delay of 50 ms": Fault(delay_seconds=0.05),
}
"""Faults, by what happens."""
