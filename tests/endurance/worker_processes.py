"""The processes that simulate for this one."""

from __future__ import annotations

import psutil

LOADED = 2**26
"""Resident memory in bytes that a worker has once it is there; those that only begin, or help, have less."""


def worker_processes() -> list[psutil.Process]:
    """Processes below this one that are ready to simulate, in the order of their ids."""
    found = []
    for process in psutil.Process().children(recursive=True):
        try:
            if process.memory_info().rss > LOADED:
                found.append(process)
        except psutil.NoSuchProcess:  # it has just died
            continue
    return sorted(found, key=lambda process: process.pid)
