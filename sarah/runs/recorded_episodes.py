"""The episodes of a training: what its journal knows is taken from there, and all others are simulated.

A training asks for its episodes in an order that follows from its settings and from the outcomes so far.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from functools import partial
from typing import Any

from sarah.episode.ending import is_ending
from sarah.episode.episode import simulate
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import EpisodeSpec
from sarah.episode.workers import Executor, Job, Outcome, begin_episode, finish_episode
from sarah.errors import TrainingInterruptedError
from sarah.recorded.journal import Journal
from sarah.robot.reading import SensorReading

_Kind = tuple[str, Callable[[Any], Any], Callable[[Any], Any]]
"""Name of a request in the journal, what makes values for JSON of its outcome, and what makes the outcome of these."""


def _reading(plain: Any) -> SensorReading:
    return SensorReading(*map(tuple, plain))


def _result(plain: Any) -> EpisodeResult:
    x, y, z = plain["final_position"]
    termination = plain["termination"]
    if not is_ending(termination):
        raise ValueError("the way in which an episode ended is not a name")
    numbers = {name: value for name, value in plain.items() if name not in ("termination", "final_position")}
    if any(type(value) not in (int, float) for value in (x, y, z, *numbers.values())):
        raise TypeError("a value of an episode is not a number")
    return EpisodeResult(termination=termination, final_position=(x, y, z), **numbers)


_KINDS: dict[Callable[..., Any], _Kind] = {
    begin_episode: ("begin", lambda reading: reading, _reading),
    finish_episode: (
        "finish",
        lambda outcome: [outcome.result.fields(), *outcome[1:]],
        lambda p: Outcome(_result(p[0]), _reading(p[1]), p[2] and _reading(p[2])),
    ),
    simulate: ("simulate", lambda result: result.fields(), _result),
}


class RecordedEpisodes(Executor):
    """Simulates the episodes of a training that its journal does not know.

    :param journal: journal of the training
    :param executor: executor that simulates
    :param interrupted: function that says after every episode whether the training is to stop
    :param outside: function that makes the context in which to simulate and to ask that, which is not the learner's
    """

    def __init__(
        self,
        journal: Journal,
        executor: Executor,
        interrupted: Callable[[], bool] = lambda: False,
        outside: Callable[[], AbstractContextManager[None]] = nullcontext,
    ) -> None:
        self.journal = journal
        self.outside = outside
        self._executor = executor
        self._interrupted = interrupted
        self._numbers = itertools.count()

    def submit(self, function: Callable[..., Any], *subjects: Any) -> Job:
        """Have an episode simulated, unless its outcome is known; its specification is the first subject.

        :raises ResumeError: if the training asks for another episode than it did when the journal was written
        """
        (name, plain, read), spec = _KINDS[function], subjects[0]
        assert isinstance(spec, EpisodeSpec)
        index = next(self._numbers)
        request = {"index": index, "kind": name, "seed": spec.seed, "parameters": list(spec.parameters)}
        known = self.journal.known(request, read)
        if known is not None:
            return Job(partial(self._known, known))
        return Job(partial(self._new, plain, request, self._executor.submit(function, *subjects)))

    def extend(self, episodes: int) -> None:
        """Note that the training goes on to a larger budget, or check that it did so before.

        :param episodes: the larger budget
        :raises ResumeError: if the training was extended to another one
        """
        self.journal.extend(next(self._numbers), episodes)

    def _known(self, outcome: Any) -> Any:
        self._stop_if_interrupted()
        return outcome

    def _new(self, plain: Callable[[Any], Any], request: dict[str, Any], job: Job) -> Any:
        with self.outside():
            outcome = job.result()
        self.journal.add(request, plain(outcome))
        self._stop_if_interrupted()
        return outcome

    def _stop_if_interrupted(self) -> None:
        with self.outside():
            is_to_stop = self._interrupted()
        if is_to_stop:
            raise TrainingInterruptedError("the training was interrupted")
