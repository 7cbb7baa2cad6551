"""Places where episodes are simulated: this process, worker processes on this machine, or a Dask cluster.

An episode is a pure function of its specification. So its result does not depend on where it runs, in which order, or
how often it was repeated because a worker died.
"""

from __future__ import annotations

import functools
from abc import ABC, abstractmethod
from collections import OrderedDict
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any, NamedTuple

from sarah.episode.cluster import RemoteJob, connected, started
from sarah.episode.episode import Episode, simulate
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import is_portable
from sarah.errors import ConfigurationError, check_whole, shortened
from sarah.robot.reading import SensorReading
from sarah.simulation.world import HoldsWorld
from sarah.versions import LEARNING, SIMULATING

if TYPE_CHECKING:
    from distributed import Client

MOST_WAITING = 8
"""Largest number of episodes that a process keeps standing until their parameters are known. Each takes some 15 MB.
Parameters may go to another process, which then lets the episode stand anew, at a thirtieth of an episode's cost."""
MOST_WORKERS = 256
"""Largest number of workers on one machine."""

_waiting: OrderedDict[tuple[Any, ...], Episode] = OrderedDict()


class Outcome(NamedTuple):
    """Outcome of an episode that has ended.

    :param result: result of the episode
    :param reading: last reading of its sensors
    :param following: last reading of the standing robot of the following episode, if there was one
    """

    result: EpisodeResult
    reading: SensorReading
    following: SensorReading | None = None


class Job(NamedTuple):
    """A call that is computed now or later, in this process or another.

    :param result: function that waits for the call, and returns what it returned
    """

    result: Callable[[], Any]


def begin_episode(spec: EpisodeSpec) -> SensorReading:
    """Let the robot of an episode stand for the first second, and keep the episode until its parameters are known.

    :param spec: specification of the episode; its parameters do not matter
    :return: the last sensor reading, which the agent acts on
    """
    episode = _standing(spec)
    before = _waiting.pop(_key(spec), None)
    if before is not None:  # it was never finished
        before.close()
    _waiting[_key(spec)] = episode
    if len(_waiting) > MOST_WAITING:
        _waiting.popitem(last=False)[1].close()
    return episode.robot.last_reading


def finish_episode(spec: EpisodeSpec, following: EpisodeSpec | None = None) -> Outcome:
    """Run an episode to its end. It goes on from the episode that stands in this process, or begins anew.

    :param spec: specification of the episode
    :param following: specification of an episode to let stand afterwards; a separate job would cost the scheduler as
        much as the episode's own
    """
    with _waiting.pop(_key(spec), None) or _standing(spec) as episode:
        result = episode.run(spec.parameters)
    return Outcome(result, episode.robot.last_reading, None if following is None else begin_episode(following))


def _standing(spec: EpisodeSpec) -> Episode:
    episode = Episode.of(spec)
    try:
        episode.stand()
    except BaseException:
        episode.close()
        raise
    return episode


def close_waiting_episodes() -> None:
    """Close this process's episodes that stand and wait for parameters."""
    while _waiting:
        _waiting.popitem()[1].close()


def _key(spec: EpisodeSpec) -> tuple[Any, ...]:
    return (spec.task.identity, 0 if is_portable(spec.task) else id(spec.task), spec.seed, repr(spec.config))


_EPISODES = (begin_episode, finish_episode, simulate)


class Executor(ABC):
    """Something that computes calls, in this process or in others."""

    @abstractmethod
    def submit(self, function: Callable[..., Any], *subjects: Any) -> Job:
        """Submit a call.

        :param function: function to call: :func:`begin_episode`, :func:`finish_episode`, :func:`sarah.simulate`, or
            one of another module
        :param subjects: arguments of the function, such as specifications of episodes
        """

    def simulate_all(self, specs: Sequence[EpisodeSpec]) -> Iterator[EpisodeResult]:
        """Simulate many episodes.

        :param specs: specifications of the episodes
        :return: their results, in the same order
        """
        jobs = [self.submit(simulate, spec) for spec in specs]
        return (job.result() for job in jobs)


class Workers(HoldsWorld, Executor):
    """Workers that simulate episodes, as a context.

    Worker processes import the main module, so a script must start workers under ``if __name__ == "__main__":``.

    :param count: number of worker processes to start on this machine; with 0, this process simulates an episode when
        its result is asked for
    :param scheduler: address of a Dask scheduler, such as ``tcp://10.0.0.1:8786``, whose workers are used instead
    :raises ConfigurationError: if the count is negative or too large, or if count and scheduler are both given
    :raises WorkersError: on entering, if workers cannot start here, no scheduler answers, or a worker has other code or
        versions; an outcome from such a worker, which may come later, is refused as well
    """

    client: Client | None
    """Client of Dask's scheduler, in the context; nothing if this process simulates."""

    def __init__(self, count: int = 0, scheduler: str | None = None) -> None:
        count = check_whole("workers", count, 0, MOST_WORKERS)
        if scheduler is not None and not (isinstance(scheduler, str) and scheduler):
            raise ConfigurationError(
                f"scheduler must be an address, such as tcp://10.0.0.1:8786, not {scheduler!r:.100}"
            )
        if count and scheduler is not None:
            raise ConfigurationError("workers start on this machine, but a scheduler has its own: give one of the two")
        self._count = count
        self._scheduler = scheduler
        self.client = None
        self._stack = ExitStack()

    def __enter__(self) -> Workers:
        """Start the workers, or connect to the scheduler."""
        if self._scheduler is not None:
            self.client = self._stack.enter_context(connected(self._scheduler))
        elif self._count:
            self.client = self._stack.enter_context(started(self._count))
        return self

    def __exit__(self, *error: object) -> None:
        """Stop the workers that were started; the workers of a scheduler go on without this client."""
        close_waiting_episodes()
        self.client = None
        self._stack.close()

    def submit(self, function: Callable[..., Any], *subjects: Any) -> Job:
        """Submit a call, of an episode or of a whole training.

        :raises ConfigurationError: outside the context, or if other processes simulate and the task is that of a script
        """
        if self.client is None and (self._count or self._scheduler is not None):
            raise ConfigurationError("workers start in a with statement: with Workers(4) as workers")
        if self.client is None:
            return Job(functools.partial(function, *subjects))
        for subject in subjects:
            if isinstance(subject, EpisodeSpec) and not is_portable(subject.task):
                raise ConfigurationError(
                    f"task {subject.task.name!r} is not that of a file, so worker processes cannot have it: put it "
                    "into one, and use sarah.load_task"
                )
        packages = SIMULATING if function in _EPISODES else LEARNING
        return Job(RemoteJob(self.client, packages, function, *subjects).result)


def executor_of(workers: Executor | None) -> Executor:
    """Check who is to simulate.

    :param workers: executor; with ``None``, this process simulates
    :raises ConfigurationError: for anything else, such as a number of workers
    """
    if workers is not None and not isinstance(workers, Executor):
        raise ConfigurationError(
            f"workers must be an executor, as in with Workers(4) as workers, not {shortened(workers)}"
        )
    return Workers() if workers is None else workers
