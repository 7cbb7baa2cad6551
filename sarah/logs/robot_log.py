"""The log of a robot that runs: the control loop hands messages over, and a thread writes them."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from contextlib import AbstractContextManager
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any

from sarah.control.pattern_generator import Phase, PhaseChange
from sarah.logs.chunk_file import ChunkFile
from sarah.logs.topic import Topic
from sarah.logs.topics import PARAMETER_CHANGES, PHASE_CHANGES, STATES, TICKS, TOPICS, WINDOWS
from sarah.robot.reading import SensorReading, Side

MOST_WAITING = 1000
"""Largest number of messages that wait for the disk: ten seconds of a robot's."""


class RobotLog(AbstractContextManager["RobotLog"]):
    """A log of one run, whose methods take a microsecond or two. The end of a ``with`` block completes the file.

    A message is handed to a thread, which encodes and writes it. While the disk is slow, messages wait; when too many
    do, new ones are dropped and counted. Each topic's messages are numbered, so that the file shows where some are
    missing. A chunk of the file is finished every second: a process that is killed loses no more than that. When the
    disk is full, the file ends with its last whole chunk, and :attr:`failure` says so.

    :param path: path of the file, such as ``run.mcap``; it must be new
    :param about: facts about the run by name, such as versions, robot and settings
    :param waits: whether the caller waits for each message, as a simulation does: then none is dropped
    :raises ConfigurationError: if the file is there already, or cannot be written
    """

    def __init__(self, path: Path, about: Mapping[str, str], waits: bool = False) -> None:
        self._file = ChunkFile(path, about)
        self._sequences = dict.fromkeys(TOPICS, 0)
        self._overflowed = 0
        self._queue: SimpleQueue[tuple[Any, ...] | None] = SimpleQueue()
        self._thread = None if waits else threading.Thread(target=self._write, name="log", daemon=True)
        if self._thread is not None:
            self._thread.start()

    def __exit__(self, *error: object) -> None:
        """Complete the file."""
        self.close()

    @property
    def dropped(self) -> int:
        """Number of messages that are not in the file, because the disk was slow or full."""
        return self._overflowed + self._file.lost

    @property
    def failure(self) -> str | None:
        """Why nothing is written any more; ``None`` while all is well."""
        return self._file.failure

    def tick(
        self,
        seconds: float,
        reading: SensorReading | None,
        reading_seconds: float,
        targets: tuple[float, ...],
        state: str,
        phase: Phase,
        stance: Side,
        tilt: float,
        rate: float,
        late_seconds: float,
    ) -> None:
        """Record a control tick. Times are since the run began.

        :param seconds: time of the tick, in s
        :param reading: reading that it acted on; ``None`` if there was none
        :param reading_seconds: time at which the reading was taken, in s
        :param targets: targets of the joints, in rad and m
        :param state: state of the supervisor
        :param phase: phase of the pattern generator
        :param stance: leg that carries the robot
        :param tilt: value that P2 is compared with, in m/s^2
        :param rate: value that P1 and P3 are compared with, in rad/s
        :param late_seconds: delay behind the tick's deadline, in s
        """
        given = (seconds, reading, reading_seconds, tuple(targets), state, phase, stance, tilt, rate, late_seconds)
        self._put(TICKS, given)

    def phase_change(self, seconds: float, change: PhaseChange, stance: Side) -> None:
        """Record the end of a phase.

        :param seconds: time since the run began, in s
        :param change: phase change that the pattern generator reported
        :param stance: leg that carries the robot after it
        """
        self._put(PHASE_CHANGES, (seconds, change, stance))

    def window(self, seconds: float, window: Mapping[str, Any]) -> None:
        """Record a window of an operation.

        :param seconds: time since the run began, in s
        :param window: values of the window by name, as :meth:`sarah.operation.window.Window.plain` gives them
        """
        self._put(WINDOWS, (seconds, dict(window)))

    def parameters(
        self, seconds: float, values: Mapping[str, float], asked_seconds: float, by: str, accepted: bool, reason: str
    ) -> None:
        """Record that parameters were asked for. Times are since the run began.

        :param seconds: time at which they were applied or refused, in s
        :param values: values by name, of P1 to P5 and V1 to V4
        :param asked_seconds: time at which they were asked for, in s
        :param by: who asked
        :param accepted: whether they were applied
        :param reason: reason why they were not; empty if they were
        """
        self._put(PARAMETER_CHANGES, (seconds, dict(values), asked_seconds, by, accepted, reason))

    def state(self, seconds: float, state: str, before: str, reason: str) -> None:
        """Record a change of the state.

        :param seconds: time since the run began, in s
        :param state: new state
        :param before: state before; empty at first
        :param reason: reason of the change
        """
        self._put(STATES, (seconds, state, before, reason))

    def close(self) -> None:
        """Write what waits, and complete the file."""
        if self._thread is not None:
            self._queue.put(None)
            self._thread.join()
        self._file.close({"dropped": str(self.dropped)})

    def _put(self, topic: Topic, given: tuple[Any, ...]) -> None:
        sequence = self._sequences[topic.name]
        self._sequences[topic.name] = sequence + 1
        if self._thread is None:
            self._file.add(topic.name, sequence, *given)
        elif self._queue.qsize() < MOST_WAITING:
            self._queue.put((topic.name, sequence, *given))
        else:
            self._overflowed += 1

    def _write(self) -> None:
        """Write messages as they come. Each is encoded alone, so that the control loop never waits for the thread."""
        while True:
            try:
                message = self._queue.get(timeout=self._file.seconds_left)
            except Empty:
                self._file.finish_chunk()
                continue
            if message is None:
                return
            self._file.add(*message)
