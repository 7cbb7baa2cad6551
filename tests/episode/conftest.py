"""What several tests share: an episode that they look at, and workers."""

import os
from collections.abc import Iterator

import dask
import distributed  # noqa: F401  # its settings are there before a test changes one, and stay when that ends
import pytest

from sarah import EpisodeResult, EpisodeSpec, simulate
from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.workers import Workers

SOMEBODYS = {
    "distributed.worker.lifetime.duration": "1 hour",
    "distributed.scheduler.idle-timeout": "1 hour",
    "distributed.scheduler.no-workers-timeout": "1 hour",
    "distributed.scheduler.allowed-failures": 0,
}
"""Settings of Dask that suit somebody's clusters."""


@pytest.fixture(scope="session")
def paper_episode() -> EpisodeResult:
    return simulate(EpisodeSpec(PAPER_STEPPING, seed=0), record_trace=True)


@pytest.fixture(scope="session")
def workers() -> Iterator[Workers]:
    """Two workers, which begin with somebody's settings, and with a standard output that is full."""
    output = os.dup(1)
    with open("/dev/full", "w") as full:
        os.dup2(full.fileno(), 1)
    try:
        with dask.config.set(SOMEBODYS):
            started = Workers(2).__enter__()
    finally:
        os.dup2(output, 1)
        os.close(output)
    yield started
    started.__exit__(None, None, None)
