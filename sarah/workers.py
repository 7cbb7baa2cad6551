"""Where episodes are simulated: in this process, in worker processes of this machine, or on a Dask cluster.

An episode is a pure function of its specification, so where it runs, in which order, and how often it had to be begun
anew after a worker died, changes nothing in its result.
"""

from __future__ import annotations

import functools
import logging
from collections import OrderedDict
from collections.abc import Callable, Iterator, Sequence
from types import TracebackType
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from sarah.episode import Episode, EpisodeResult, EpisodeSpec, simulate
from sarah.errors import ConfigurationError, WorkersError
from sarah.sensors import SensorReading
from sarah.tasks import TASKS

if TYPE_CHECKING:
    from distributed import Client

KEPT_STANDING = 64
"""Episodes that a process keeps standing, waiting for their parameters."""
SCHEDULER_SECONDS = 10
"""How long to wait for a scheduler to answer."""
DEATHS_PER_EPISODE = 1000
"""How many workers may die over one episode before it is taken for the episode's fault."""

_standing: OrderedDict[tuple[Any, ...], Episode] = OrderedDict()


class Outcome(NamedTuple):
    """An episode that is over.

    :param result: what came of it
    :param reading: the sensors' last one
    """

    result: EpisodeResult
    reading: SensorReading


class Job(Protocol):
    """Something that is simulated, now or later, here or elsewhere."""

    worker: str | None
    """Address of the worker that did it, once it is done; ``None`` for this process."""

    def result(self) -> Any:
        """What came of it; waits for it."""


def stand(spec: EpisodeSpec) -> SensorReading:
    """Let an episode stand for its first second, and keep it until its parameters are known.

    :param spec: of the episode; its parameters do not matter
    :return: the sensors' last reading, which the agent acts on
    """
    episode = Episode(spec.config, spec.seed, TASKS[spec.task])
    reading = episode.stand()
    _standing[_key(spec)] = episode
    if len(_standing) > KEPT_STANDING:
        _standing.popitem(last=False)[1].close()
    return reading


def run(spec: EpisodeSpec) -> Outcome:
    """Run an episode to its end: the one that stands here, or, if none does, one from the beginning.

    :param spec: of the episode
    """
    episode = _standing.pop(_key(spec), None)
    if episode is None:
        episode = Episode(spec.config, spec.seed, TASKS[spec.task])
        episode.stand()
    try:
        return Outcome(episode.run(spec.parameters), episode.last_reading)
    finally:
        episode.close()


def forget_standing() -> None:
    """Close the episodes of this process that stand and wait for parameters."""
    while _standing:
        _standing.popitem()[1].close()


def _key(spec: EpisodeSpec) -> tuple[Any, ...]:
    return (spec.task, spec.seed, repr(spec.config))


class Workers:
    """A context in which episodes are simulated.

    :param count: worker processes to start on this machine; with none, episodes run in this process, when they are
        asked for
    :param scheduler: address of a Dask scheduler, such as ``tcp://10.0.0.1:8786``, whose workers are used instead
    :raises ConfigurationError: if the count is negative, or both are given
    :raises WorkersError: on entering, if no scheduler answers
    """

    def __init__(self, count: int = 0, scheduler: str | None = None) -> None:
        if count < 0:
            raise ConfigurationError(f"workers must be 0 or more, not {count!r}")
        if count and scheduler is not None:
            raise ConfigurationError("workers are started here, a scheduler has its own: give one of the two")
        self._count = count
        self._scheduler = scheduler
        self._client: Client | None = None
        self._cluster: Any = None

    def __enter__(self) -> Workers:
        """Start the workers, or find them."""
        if self._scheduler is not None:
            self._client = _connect(self._scheduler)
        elif self._count:
            self._cluster, self._client = _start(self._count)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Stop what was started; a cluster goes on without this client."""
        forget_standing()
        if self._client is not None:
            self._client.close()
        if self._cluster is not None:
            self._cluster.close()

    def submit(self, function: Callable[[EpisodeSpec], Any], spec: EpisodeSpec, near: str | None = None) -> Job:
        """Have something simulated.

        :param function: :func:`stand`, :func:`run` or :func:`sarah.simulate`
        :param spec: of the episode
        :param near: address of the worker that had better do it
        """
        if self._client is None:
            return _LocalJob(function, spec)
        return _RemoteJob(self._client, function, spec, near)

    def simulate_all(self, specs: Sequence[EpisodeSpec]) -> Iterator[EpisodeResult]:
        """Simulate many episodes.

        :param specs: of the episodes
        :return: their results, in the same order
        """
        jobs = [self.submit(simulate, spec) for spec in specs]
        return (job.result() for job in jobs)


class _LocalJob:
    worker: str | None = None

    def __init__(self, function: Callable[[EpisodeSpec], Any], spec: EpisodeSpec) -> None:
        self.result = functools.partial(function, spec)


class _RemoteJob:
    worker: str | None = None

    def __init__(
        self, client: Client, function: Callable[[EpisodeSpec], Any], spec: EpisodeSpec, near: str | None
    ) -> None:
        self._submit = functools.partial(client.submit, _with_address, function, spec, pure=False)
        self._future = self._submit(workers=[near], allow_other_workers=True) if near else self._submit()

    def result(self) -> Any:
        from distributed.scheduler import KilledWorker

        for _ in range(DEATHS_PER_EPISODE):
            try:
                self.worker, outcome = self._future.result()
                return outcome
            except KilledWorker:  # a scheduler gives up after a few deaths, which a pure function need not
                self._future = self._submit()
        raise WorkersError(f"an episode was begun {DEATHS_PER_EPISODE} times, and each time its worker died")


def _with_address(function: Callable[[EpisodeSpec], Any], spec: EpisodeSpec) -> tuple[str, Any]:
    """What runs on a Dask worker."""
    from distributed import get_worker

    return get_worker().address, function(spec)


def _connect(address: str) -> Client:
    from distributed import Client

    try:
        return Client(address, timeout=SCHEDULER_SECONDS)
    except (OSError, ValueError) as error:
        raise WorkersError(f"no Dask scheduler answers at {address!r}: {error}") from error


def _start(count: int) -> tuple[Any, Client]:
    import dask
    from distributed import Client, LocalCluster

    with dask.config.set({"distributed.scheduler.allowed-failures": DEATHS_PER_EPISODE}):
        cluster = LocalCluster(
            n_workers=count,
            threads_per_worker=1,
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",  # any free port; otherwise 8787, which another may hold
            memory_limit=0,
            silence_logs=logging.CRITICAL,
        )
    return cluster, Client(cluster)
