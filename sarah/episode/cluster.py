"""Worker processes of Dask, here or behind a scheduler. Every outcome says which code and versions computed it."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent import futures
from functools import partial
from multiprocessing.resource_tracker import ensure_running
from typing import TYPE_CHECKING, Any

from sarah.errors import WorkersError, one_line
from sarah.streams import keep_streams
from sarah.versions import SIMULATING, differences, versions

if TYPE_CHECKING:
    from distributed import Client

SCHEDULER_SECONDS = 10
"""Time limit for connecting to a scheduler, in s."""
NICENESS = 5
"""Niceness of local workers, so that the learner gets the processor first."""
WATCH_SECONDS = 5
"""Time after which it is looked whether somebody is still there to answer, in s."""
UNWATCHED = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
    "distributed.admin.system-monitor.interval": "10s",
}
"""Settings with which Dask's workers on this machine watch themselves less. By default they do so every 10 to 500 ms,
which takes the processor from the episodes."""
UNLIMITED = {
    "distributed.worker.lifetime.duration": None,
    "distributed.scheduler.idle-timeout": None,
    "distributed.scheduler.no-workers-timeout": None,
}
"""Settings with which Dask's workers on this machine stay until the work is done, whatever somebody's clusters have."""
ENVIRONMENT, FREES_MEMORY = "distributed.nanny.pre-spawn-environ", "MALLOC_TRIM_THRESHOLD_"
"""Dask's setting of the environment of workers, and the variable in it with which they take every array above 128 kB
from the system and give it back. That slows trainings of large networks."""
SAFE_PATH = "PYTHONSAFEPATH"
"""Environment variable that keeps Python 3.11 and later from searching the working folder for modules."""
ATTEMPTS = 20
"""Largest number of times that a call is submitted: a scheduler gives it up after the deaths of a few workers."""


def answer(packages: tuple[str, ...], function: Callable[..., Any], *subjects: Any) -> tuple[Any, str, dict[str, str]]:
    """Compute a call, in a worker.

    :param packages: names of the packages whose versions matter
    :param function: function to call
    :param subjects: arguments of the function
    :return: what the call returned, the worker's address, and the versions that the worker has, by name
    """
    from distributed import get_worker

    return function(*subjects), get_worker().address, versions(packages)


class RemoteJob:
    """A call that some worker computes.

    :param client: client of the scheduler
    :param packages: names of the packages whose versions must be the same there
    :param function: function to call
    :param subjects: arguments of the function
    """

    def __init__(self, client: Client, packages: tuple[str, ...], function: Callable[..., Any], *subjects: Any) -> None:
        self._client = client
        self._packages = packages
        self._submit = partial(client.submit, answer, packages, function, *subjects, pure=False)
        self._future = self._submit()

    def result(self) -> Any:
        """Wait for the call, and return what it returned.

        :raises WorkersError: if the worker has other code or versions than this process, or if all workers die and no
            other can start
        """
        value, worker, there = self._wait()
        _check_worker(worker, there, self._packages)
        return value

    def _wait(self) -> tuple[Any, str, dict[str, str]]:
        from concurrent.futures import CancelledError

        from distributed.scheduler import KilledWorker

        for _ in range(ATTEMPTS):
            try:
                self._wait_for_its_end()
                return self._future.result()
            except KilledWorker:  # the scheduler gave up after a few deaths, but a pure function can be repeated
                self._future = self._submit()
            except CancelledError as error:
                raise WorkersError(f"the connection to the scheduler is lost: {error}") from error
        raise WorkersError(f"an episode was submitted {ATTEMPTS} times, and its workers died each time")

    def _wait_for_its_end(self) -> None:
        """Wait until the call has ended, somehow, or until nobody is left who could compute it."""
        from distributed import wait

        while not self._future.done():
            try:
                wait(self._future, timeout=WATCH_SECONDS)
            except (TimeoutError, asyncio.TimeoutError):  # which are two in Python 3.10
                _check_presence(self._client)


def _check_presence(client: Client) -> None:
    """Refuse to wait for workers of this machine if none is there, and none will come: their nannies have given up."""
    from distributed.core import Status

    if client.cluster is None:  # whoever has a scheduler can start workers at any time
        return
    if all(nanny.status in (Status.closed, Status.failed) for nanny in client.cluster.workers.values()):
        raise WorkersError("all worker processes of this machine have ended, and no other could start")


@contextlib.contextmanager
def _in_one_line(what: str) -> Iterator[None]:
    """Raise whatever goes wrong with Dask as one line, which says what was tried and the first cause."""
    try:
        yield
    except WorkersError:
        raise
    except Exception as error:
        cause: BaseException | None = error
        reason = one_line(error)
        while cause is not None:
            reason = one_line(cause) if str(cause) else reason
            # Dask stumbles over what has not begun.
            is_aftermath = isinstance(cause, (AssertionError, AttributeError))
            cause = cause.__cause__ or (cause.__context__ if is_aftermath else None)
        raise WorkersError(f"{what}: {reason}") from error


def _check_worker(worker: str, there: dict[str, str], packages: tuple[str, ...]) -> None:
    """Refuse a worker whose results would differ, with its address and the difference."""
    if different := differences(versions(packages), there, "there"):
        raise WorkersError(f"worker {worker} is refused, because its results would differ: {different}")


@contextlib.contextmanager
def connected(address: str) -> Iterator[Client]:
    """Connection to a scheduler, whose workers go on without it.

    :param address: address of the scheduler, such as ``tcp://10.0.0.1:8786``
    :raises WorkersError: if no scheduler answers, or one of its workers has other code or versions
    """
    with _in_one_line(f"no Dask scheduler answers at {address!r}"):
        client = _client_in_time(address)
    with contextlib.closing(client):
        with _in_one_line(f"a worker behind {address!r} tells no versions"):
            for worker, there in client.run(versions, SIMULATING).items():
                _check_worker(worker, there, SIMULATING)
        yield client


def _client_in_time(address: str) -> Client:
    """Make a client in a thread of its own, because Dask waits for ever at a port where nothing answers."""
    from distributed import Client

    made: futures.Future[Client] = futures.Future()

    def make() -> None:
        try:
            made.set_result(Client(address, timeout=SCHEDULER_SECONDS))
        except BaseException as error:
            made.set_exception(error)

    threading.Thread(target=make, daemon=True).start()
    try:
        return made.result(2 * SCHEDULER_SECONDS)
    except futures.TimeoutError as error:
        raise WorkersError(f"no Dask scheduler answers at {address!r}: the port is open, but silent") from error


@contextlib.contextmanager
def started(count: int) -> Iterator[Client]:
    """Workers on this machine, which end with the context.

    :param count: number of worker processes
    :raises WorkersError: if they cannot start
    """
    before, during = dict(os.environ), dict[str, str]()
    # Otherwise a worker imports modules from the working folder, such as a pickle.py in somebody's run folder.
    os.environ[SAFE_PATH] = "1"
    try:
        with contextlib.ExitStack() as stack:
            client = _started_client(count, stack)
            during = dict(os.environ)  # Dask sets others, which workers need as long as they may be started again
            yield client
    finally:
        for name, value in (during or dict(os.environ)).items():
            if name not in before:
                os.environ.pop(name, None)
            elif value != before[name]:
                os.environ[name] = before[name]


@_in_one_line("no workers can start on this machine")
def _started_client(count: int, stack: contextlib.ExitStack) -> Client:
    """Client of a new cluster on this machine; the stack closes both."""
    import dask
    from distributed import Client, LocalCluster, WorkerPlugin

    class Serve(WorkerPlugin):
        """Ignore Ctrl-C, which the training handles, and give the learner's process priority over the worker."""

        def setup(self, worker: Any) -> None:
            keep_streams()  # a reward may print, and nobody need read it
            signal.signal(signal.SIGINT, signal.SIG_IGN)
            os.nice(NICENESS)

    environment = {name: value for name, value in dask.config.get(ENVIRONMENT).items() if name != FREES_MEMORY}
    with _interrupted_later(), dask.config.set({**UNWATCHED, **UNLIMITED, ENVIRONMENT: environment}):
        cluster = LocalCluster(
            n_workers=count,
            threads_per_worker=1,
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",  # any free port; the default 8787 may be taken
            security=True,  # other users of this machine can reach the ports too
            memory_limit=0,
            silence_logs=logging.CRITICAL,
        )
        stack.enter_context(contextlib.closing(cluster))
        client = stack.enter_context(contextlib.closing(Client(cluster)))
        client.register_plugin(Serve())
    return client


@contextlib.contextmanager
def _interrupted_later() -> Iterator[None]:
    """Let signals that end a command come at the end of this context, because Dask cannot stop while it starts.

    Processes that are started ignore Ctrl-C from their first moment.
    """
    is_main = threading.current_thread() is threading.main_thread()  # no other may have handlers
    handlers = {int(number): signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM) if is_main}
    usual = {number: handler for number, handler in handlers.items() if handler is not None}  # others are not Python's
    came: list[int] = []
    ensure_running()  # otherwise it starts with the first worker, and lets Ctrl-C through again
    for number in usual:
        signal.signal(number, lambda number, _: came.append(number))
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        for number, handler in usual.items():
            signal.signal(number, handler)
        for number in came:
            signal.raise_signal(number)
