"""Threads of torch."""

from collections.abc import Iterator
from contextlib import contextmanager

import torch as th


@contextmanager
def one_thread() -> Iterator[None]:
    """
    Let torch compute on one thread for a while, and then on as many as before.

    Small networks are fastest so: more threads wait for each other. And no bit depends on the number of cores.
    """
    before = th.get_num_threads()
    th.set_num_threads(1)
    try:
        yield
    finally:
        th.set_num_threads(before)
