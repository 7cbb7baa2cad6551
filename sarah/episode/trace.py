"""The record of an episode, tick by tick, for the viewer, videos and plots."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from sarah.episode.push import PUSH_SHOWN_SECONDS
from sarah.errors import SimulationError
from sarah.robot.reading import Vector


@dataclass(frozen=True)
class Trace:
    """Arrays with one row for every control tick in which the pattern generator ran.

    A row contains the state at the beginning of the tick, and what the controller decided in it.

    :param time: simulated time, from the end of the first second of standing, in s
    :param position: position of the torso's centre in the world's frame, in m; shape (ticks, 3)
    :param orientation: orientation of the torso, as unit quaternions (x, y, z, w); shape (ticks, 4)
    :param joints: true positions of the actuated joints in the order of
        :data:`~sarah.robot.reading.ACTUATED_JOINTS`, in rad and m; leg lengths are positive when retracted; shape
        (ticks, 6)
    :param ankles: true positions of :data:`~sarah.robot.description.ANKLE_JOINTS`, in rad; shape (ticks, 4)
    :param targets: targets of the actuated joints, in rad and m; shape (ticks, 6)
    :param pressures: sensed loads on the pads, in N: left fore, left hind, right fore, right hind; shape (ticks, 4)
    :param acceleration: sensed specific force in the torso's frame, in m/s^2; shape (ticks, 3)
    :param angular_rate: sensed angular rate in the torso's frame, in rad/s; shape (ticks, 3)
    :param phase: phase of the pattern generator: ``"shift"``, ``"lift"`` or ``"land"``
    :param stance: side of the stance leg: +1 right, -1 left
    :param stable_x: low-passed lateral acceleration, in m/s^2
    :param tilt: value that P2 is compared with (:attr:`~sarah.control.pattern_generator.PatternGenerator.tilt`), in
        m/s^2
    :param rate: value that P1 and P3 are compared with
        (:attr:`~sarah.control.pattern_generator.PatternGenerator.rate`), in rad/s
    :param steps_per_second: steps per second in the last 2 s, at the end of the tick, as the tick's reward has it
    :param push: force of the push during the tick, in the world's frame, in N; shape (ticks, 3)
    :param score: score so far
    """

    time: np.ndarray
    position: np.ndarray
    orientation: np.ndarray
    joints: np.ndarray
    ankles: np.ndarray
    targets: np.ndarray
    pressures: np.ndarray
    acceleration: np.ndarray
    angular_rate: np.ndarray
    phase: np.ndarray
    stance: np.ndarray
    stable_x: np.ndarray
    tilt: np.ndarray
    rate: np.ndarray
    steps_per_second: np.ndarray
    push: np.ndarray
    score: np.ndarray

    @classmethod
    def of(cls, rows: Sequence[Mapping[str, Any]]) -> Trace:
        """Make a trace from its rows.

        :param rows: values by field, one row for each tick
        :raises SimulationError: if there are no rows
        """
        if not rows:
            raise SimulationError("there is nothing to show: the simulation diverged while the robot stood")
        return cls(**{field.name: np.array([row[field.name] for row in rows]) for field in fields(cls)})

    def __len__(self) -> int:
        """Number of ticks."""
        return len(self.time)

    def tick_at(self, time: float) -> int:
        """Index of the last tick that began by a time.

        :param time: simulated time, in s; the first and the last tick stand for times outside the trace
        """
        return max(0, int(np.searchsorted(self.time, time + 1e-9, side="right")) - 1)

    def pushes(self) -> list[tuple[int, int]]:
        """First tick of each push, and the one after its last; a new force or a pause begins another push."""
        before = np.concatenate((np.zeros((1, 3)), self.push[:-1]))
        changes = [*np.flatnonzero((self.push != before).any(axis=1)).tolist(), len(self)]
        return [(begin, end) for begin, end in itertools.pairwise(changes) if self.push[begin].any()]

    def shown_pushes(self) -> list[Vector | None]:
        """Force of the push that a picture of each tick shows, in N: while it acts, and for a moment after it began."""
        shown: list[Vector | None] = [None] * len(self)
        for begin, end in self.pushes():
            last = max(end, int(np.searchsorted(self.time, self.time[begin] + PUSH_SHOWN_SECONDS)))
            x, y, z = self.push[begin].tolist()
            shown[begin:last] = [(x, y, z)] * (min(last, len(self)) - begin)
        return shown
