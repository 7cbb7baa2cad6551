"""The processes that simulate for a training."""

from __future__ import annotations

import os

import psutil

from sarah.episode.workers import Workers


def worker_processes(workers: Workers) -> list[psutil.Process]:
    """Worker processes that are ready to simulate, in the order of their ids.

    :param workers: workers that have been started on this machine
    """
    assert workers.client is not None
    return [psutil.Process(pid) for pid in sorted(workers.client.run(os.getpid, on_error="ignore").values())]
