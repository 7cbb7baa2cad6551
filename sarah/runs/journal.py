"""The journal of a training: the outcome of every episode, from which an interrupted training resumes exactly.

A training is deterministic: its next episode follows from its configuration and from the outcomes so far. So a resumed
training runs again from its beginning, but takes the outcomes that the journal has instead of simulating the episodes.
That costs only the learner's share of the time, a few per cent. It restores random generators, replay buffer, optimiser
and schedules of any algorithm, because they go through the same states again.

The first row says what all others depend on: :mod:`sarah.runs.origin`.

A row is a checksum and a JSON object, and is on the disk before the training goes on. A damaged row is ignored, and its
episode is simulated again. Checksums begin from the hash of the first row, so rows of other trainings count as damaged.
"""

from __future__ import annotations

import logging
import os
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

from sarah.episode.ending import is_ending
from sarah.episode.episode import simulate
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import EpisodeSpec
from sarah.episode.workers import Executor, Job, Outcome, begin_episode, finish_episode
from sarah.errors import ResumeError, SarahError, TrainingInterruptedError
from sarah.robot.reading import SensorReading
from sarah.runs.config import TrainingConfig
from sarah.runs.origin import check_first_row, first_row
from sarah.runs.rows import LONGEST_ROW, JournalFile, checksummed, read_checksummed

ROOM_PER_EPISODE = 10_000
"""Largest number of bytes for each episode in a journal that is read."""
EPISODES_BESIDE = 1000
"""Number of episodes, beside those of the budget, that a journal has room for: evaluations, and rows that were cut."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class _Kind:
    """Conversion of a function's outcome to JSON and back.

    :param plain: function that makes values for JSON of an outcome
    :param value: function that makes the outcome of values from JSON
    """

    plain: Callable[[Any], Any]
    value: Callable[[Any], Any]


def _reading(plain: Any) -> SensorReading:
    return SensorReading(*map(tuple, plain))


def _result(plain: Any) -> EpisodeResult:
    x, y, z = plain["final_position"]
    termination = plain["termination"]
    if not is_ending(termination):
        raise ValueError("the way in which an episode ended is no name")
    numbers = {name: value for name, value in plain.items() if name not in ("termination", "final_position")}
    if any(type(value) not in (int, float) for value in (x, y, z, *numbers.values())):
        raise TypeError("a number of an episode is none")
    return EpisodeResult(termination=termination, final_position=(x, y, z), **numbers)


_KINDS = {
    "begin": _Kind(lambda reading: reading, _reading),
    "finish": _Kind(
        lambda outcome: [outcome.result.fields(), *outcome[1:]],
        lambda p: Outcome(_result(p[0]), _reading(p[1]), p[2] and _reading(p[2])),
    ),
    "simulate": _Kind(lambda result: result.fields(), _result),
    "extend": _Kind(lambda nothing: nothing, lambda nothing: nothing),
}
_NAMES: dict[Callable[..., Any], str] = {
    begin_episode: "begin",
    finish_episode: "finish",
    simulate: "simulate",
}


@dataclass(frozen=True)
class _Row:
    """A known outcome.

    :param request: number, kind, seed and parameters of the episode
    :param value: outcome of the episode
    """

    request: dict[str, Any]
    value: Any


class Journal(JournalFile, Executor):
    """An executor that takes known outcomes from the journal's file, and has all other episodes simulated.

    :param path: path of the file, which must exist
    :param config: settings of the training
    :param executor: executor that simulates episodes
    :param interrupted: function that says after every episode whether the training is to stop
    :param outside: function that makes the context in which to simulate and to ask that, which is not the learner's
    """

    def __init__(
        self,
        path: Path,
        config: TrainingConfig,
        executor: Executor,
        interrupted: Callable[[], bool] = lambda: False,
        outside: Callable[[], AbstractContextManager[None]] = nullcontext,
    ) -> None:
        super().__init__(path, "training")
        self._config = config
        self._executor = executor
        self._interrupted = interrupted
        self.outside = outside
        self._submitted = 0
        self._known: dict[int, _Row] = {}

    @property
    def replaying(self) -> bool:
        """Whether the journal has outcomes that the training has not yet asked for."""
        return bool(self._known)

    def _read(self) -> None:
        limit = ROOM_PER_EPISODE * (self._config.episodes + EPISODES_BESIDE)
        if (size := os.fstat(self._file.fileno()).st_size) > limit:
            raise ResumeError(f"{self._path} has {size} bytes, but such a training writes at most {limit}")
        super()._read()

    def _first_row(self) -> bytes:
        return first_row(self._config)

    def _check_first_row(self, first: bytes) -> None:
        check_first_row(self._path, first, self._config)

    def _read_rows(self, reader: BinaryIO) -> None:
        damaged, whole = 0, reader.tell()
        while line := reader.readline(LONGEST_ROW):
            row = _read_row(line, self._seed)
            if line.endswith(b"\n"):
                whole = reader.tell()
            if row is None:
                damaged += 1
            else:
                self._known[row.request["index"]] = row
        if damaged:
            self._file.truncate(whole)  # a row that was cut has no end
            _log.warning("%s: damaged rows: %d; their episodes are simulated again", self._path, damaged)

    def submit(self, function: Callable[..., Any], *subjects: Any) -> Job:
        """Have an episode simulated, unless its outcome is known.

        :param function: function to call: :func:`~sarah.episode.workers.begin_episode`,
            :func:`~sarah.episode.workers.finish_episode` or :func:`sarah.simulate`
        :param subjects: arguments of the function, the episode's specification first
        :raises ResumeError: if the training asks for another episode than it did when the journal was written
        """
        request = _request(self._submitted, function, subjects[0])
        row = self._known.pop(self._submitted, None)
        self._submitted += 1
        if row is None:
            return _NewJob(self, request, self._executor.submit(function, *subjects))
        if row.request != request:
            raise ResumeError(
                f"{self._path.parent} cannot be resumed here: it does not repeat what it did before its interruption, "
                "as the kind of processor differs, or something else that arithmetic depends on"
            )
        return _KnownJob(self, row.value)

    def extend(self, episodes: int) -> None:
        """Note that the training goes on to a larger budget, or check that it did so before.

        :param episodes: the larger budget
        :raises ResumeError: if the training was extended to another one
        """
        request = {"index": self._submitted, "kind": "extend", "seed": 0, "parameters": [episodes]}
        row = self._known.pop(self._submitted, None)
        self._submitted += 1
        if row is None:
            self.add(request, None)
        elif row.request != request:
            raise self._other_stages(self._config.stages, "episodes")

    def add(self, request: dict[str, Any], value: Any) -> None:
        """Write the outcome of an episode.

        :param request: number, kind, seed and parameters of the episode
        :param value: outcome of the episode
        """
        outcome = _KINDS[request["kind"]].plain(value)
        row = checksummed({**request, "outcome": outcome}, self._seed)
        self._append(row, at_once=request["kind"] != "begin")  # standing is cheap to simulate again

    def stop_if_interrupted(self) -> None:
        """Raise :class:`~sarah.errors.TrainingInterruptedError` if the training is to stop."""
        with self.outside():
            is_to_stop = self._interrupted()
        if is_to_stop:
            raise TrainingInterruptedError("the training was interrupted")


@dataclass(frozen=True)
class _KnownJob:
    journal: Journal
    value: Any

    def result(self) -> Any:
        self.journal.stop_if_interrupted()
        return self.value


@dataclass(frozen=True)
class _NewJob:
    journal: Journal
    request: dict[str, Any]
    job: Job

    def result(self) -> Any:
        with self.journal.outside():
            value = self.job.result()
        self.journal.add(self.request, value)
        self.journal.stop_if_interrupted()
        return value


def _request(index: int, function: Callable[..., Any], spec: EpisodeSpec) -> dict[str, Any]:
    return {"index": index, "kind": _NAMES[function], "seed": spec.seed, "parameters": list(spec.parameters)}


def _read_row(line: bytes, seed: int) -> _Row | None:
    """Read a row of the journal; return ``None`` if it is damaged."""
    request = read_checksummed(line, seed)
    if request is None:
        return None
    try:
        value = _KINDS[request["kind"]].value(request.pop("outcome"))
        return _Row({"index": int(request["index"]), **request}, value)
    except (ValueError, TypeError, LookupError, ArithmeticError, SarahError, RecursionError):
        return None
