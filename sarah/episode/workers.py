"""Where episodes are simulated: in this process, in worker processes of this machine, or on a Dask cluster.

An episode is a pure function of its specification, so where it runs, in which order, and how often it had to be begun
anew after a worker died, changes nothing in its result.
"""

from __future__ import annotations

import functools
import logging
import os
import signal
import threading
from abc import ABC, abstractmethod
from collections import OrderedDict
from collections.abc import Callable, Iterator, Sequence
from concurrent import futures
from types import TracebackType
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from sarah.episode.episode import Episode, simulate
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import TASKS
from sarah.errors import ConfigurationError, WorkersError, check_range
from sarah.robot.reading import SensorReading
from sarah.versions import SIMULATING, versions

if TYPE_CHECKING:
    from distributed import Client, LocalCluster

MOST_WAITING = 8
"""Episodes that a process keeps standing, waiting for their parameters. Each takes some 15 MB, and one whose parameters
went to another process waits in vain; whoever does not stand here stands anew, for a thirtieth of an episode."""
SCHEDULER_SECONDS = 10
"""How long to wait for a connection to a scheduler."""
SAFE_PATH = "PYTHONSAFEPATH"
"""Keeps Python from putting the working folder on its search path, from Python 3.11 on."""
NICENESS = 5
"""Niceness of local workers, so that the learner gets the processor first."""
UNWATCHED = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
    "distributed.admin.system-monitor.interval": "10s",
}
"""How little the processes of this machine watch themselves. As Dask has it, every 10 to 500 ms, it takes the
processor from the episodes."""
MOST_WORKERS = 1000
"""On one machine."""
ATTEMPTS = 20
"""How often an episode is handed in: a scheduler gives it up after the deaths of a few workers."""

_waiting: OrderedDict[tuple[Any, ...], Episode] = OrderedDict()


class Outcome(NamedTuple):
    """An episode that is over.

    :param result: what came of it
    :param reading: the sensors' last one
    :param following: the last reading of the episode that was to stand after it, if one was
    """

    result: EpisodeResult
    reading: SensorReading
    following: SensorReading | None = None


class Job(Protocol):
    """Something that is simulated, now or later, here or elsewhere."""

    def result(self) -> Any:
        """What came of it; waits for it."""


def begin_episode(spec: EpisodeSpec) -> SensorReading:
    """Let an episode stand for its first second, and keep it until its parameters are known.

    :param spec: of the episode; its parameters do not matter
    :return: the sensors' last reading, which the agent acts on
    """
    episode = _standing(spec)
    before = _waiting.pop(_key(spec), None)
    if before is not None:  # whoever asked for it never let it run
        before.close()
    _waiting[_key(spec)] = episode
    if len(_waiting) > MOST_WAITING:
        _waiting.popitem(last=False)[1].close()
    return episode.last_reading


def finish_episode(spec: EpisodeSpec, following: EpisodeSpec | None = None) -> Outcome:
    """Run an episode to its end: the one that stands here, or, if none does, one from the beginning.

    :param spec: of the episode
    :param following: of another one, to let stand afterwards; a task of its own would cost the scheduler as much
    """
    episode = _waiting.pop(_key(spec), None) or _standing(spec)
    try:
        result = episode.run(spec.parameters)
    finally:
        episode.close()
    return Outcome(result, episode.last_reading, None if following is None else begin_episode(following))


def _standing(spec: EpisodeSpec) -> Episode:
    episode = Episode(spec.config, spec.seed, TASKS[spec.task])
    try:
        episode.stand()
    except BaseException:
        episode.close()
        raise
    return episode


def close_waiting_episodes() -> None:
    """Close the episodes of this process that stand and wait for parameters."""
    while _waiting:
        _waiting.popitem()[1].close()


def _key(spec: EpisodeSpec) -> tuple[Any, ...]:
    return (spec.task, spec.seed, repr(spec.config))


class Executor(ABC):
    """Whoever has things simulated."""

    @abstractmethod
    def submit(self, function: Callable[..., Any], *subjects: Any) -> Job:
        """Have something done.

        :param function: :func:`begin_episode`, :func:`finish_episode`, :func:`sarah.simulate`, or another module's
        :param subjects: of the function: specifications of episodes, or what else it takes
        """

    def simulate_all(self, specs: Sequence[EpisodeSpec]) -> Iterator[EpisodeResult]:
        """Simulate many episodes.

        :param specs: of the episodes
        :return: their results, in the same order
        """
        jobs = [self.submit(simulate, spec) for spec in specs]
        return (job.result() for job in jobs)


class Workers(Executor):
    """A context in which episodes are simulated.

    Worker processes import the main module: a script that starts some does it under ``if __name__ == "__main__":``.

    :param count: worker processes to start on this machine; with none, episodes run in this process, when they are
        asked for
    :param scheduler: address of a Dask scheduler, such as ``tcp://10.0.0.1:8786``, whose workers are used instead
    :raises ConfigurationError: if the count is none that a machine can start, or both are given
    :raises WorkersError: on entering, if no scheduler answers
    """

    def __init__(self, count: int = 0, scheduler: str | None = None) -> None:
        check_range("workers", count, 0, MOST_WORKERS)
        if count and scheduler is not None:
            raise ConfigurationError("workers are started here, a scheduler has its own: give one of the two")
        self._count = count
        self._scheduler = scheduler
        self._client: Client | None = None
        self._cluster: LocalCluster | None = None
        self._safe_path = ""

    def __enter__(self) -> Workers:
        """Start the workers, or find them."""
        if self._scheduler is not None:
            self._client = _connect(self._scheduler)
        elif self._count:
            # Otherwise a new process imports what lies in the working folder, such as a pickle.py in somebody's run.
            self._safe_path = os.environ.get(SAFE_PATH, "")
            os.environ[SAFE_PATH] = "1"
            self._cluster, self._client = _start(self._count)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Stop what was started; a cluster goes on without this client."""
        close_waiting_episodes()
        if self._client is not None:
            self._client.close()
        if self._cluster is not None:
            self._cluster.close()
            os.environ[SAFE_PATH] = self._safe_path  # empty is as good as unset

    def submit(self, function: Callable[..., Any], *subjects: Any) -> Job:
        """Have something done: simulated, or trained.

        :param function: :func:`begin_episode`, :func:`finish_episode`, :func:`sarah.simulate`, or another module's
        :param subjects: of the function: specifications of episodes, or what else it takes
        """
        if self._client is None:
            return _LocalJob(function, *subjects)
        return _RemoteJob(functools.partial(self._client.submit, function, *subjects, pure=False))


class _LocalJob:
    def __init__(self, function: Callable[..., Any], *subjects: Any) -> None:
        self.result = functools.partial(function, *subjects)


class _RemoteJob:
    def __init__(self, submit: Callable[[], Any]) -> None:
        self._submit = submit
        self._future = submit()

    def result(self) -> Any:
        from concurrent.futures import CancelledError

        from distributed.scheduler import KilledWorker

        for _ in range(ATTEMPTS):
            try:
                return self._future.result()
            except KilledWorker:  # a scheduler gives up after a few deaths, which a pure function need not
                self._future = self._submit()
            except CancelledError as error:
                raise WorkersError(f"the connection to the scheduler is lost: {error}") from error
        raise WorkersError(f"an episode was handed in {ATTEMPTS} times, and each time its workers died")


def _connect(address: str) -> Client:
    try:
        client = _client_in_time(address)
    except futures.TimeoutError as error:
        raise WorkersError(f"no Dask scheduler answers at {address!r}: whoever listens there says nothing") from error
    except (OSError, ValueError, TypeError, RuntimeError) as error:
        raise WorkersError(f"no Dask scheduler answers at {address!r}: {error}") from error
    here = versions(SIMULATING)
    for worker, there in client.run(versions, SIMULATING).items():
        if there != here:
            client.close()
            raise WorkersError(f"worker {worker} has {there}, and results would differ: here is {here}")
    return client


def _client_in_time(address: str) -> Client:
    """A client, made in a thread: Dask waits for ever at a port where nobody says anything."""
    from distributed import Client

    made: futures.Future[Client] = futures.Future()

    def make() -> None:
        try:
            made.set_result(Client(address, timeout=SCHEDULER_SECONDS))
        except BaseException as error:
            made.set_exception(error)

    threading.Thread(target=make, daemon=True).start()
    return made.result(2 * SCHEDULER_SECONDS)


def _start(count: int) -> tuple[LocalCluster, Client]:
    import dask
    from distributed import Client, LocalCluster, WorkerPlugin

    class Serve(WorkerPlugin):
        """Leave Ctrl-C, which reaches workers too, to the training, and the processor to the learner they wait for."""

        def setup(self, worker: Any) -> None:
            signal.signal(signal.SIGINT, signal.SIG_IGN)
            os.nice(NICENESS)

    with dask.config.set(UNWATCHED):
        cluster = LocalCluster(
            n_workers=count,
            threads_per_worker=1,
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",  # any free port; otherwise 8787, which another may hold
            security=True,  # others on this machine reach the ports too
            memory_limit=0,
            silence_logs=logging.CRITICAL,
        )
    try:
        client = Client(cluster)
        client.register_plugin(Serve())
    except BaseException:
        cluster.close()
        raise
    return cluster, client
