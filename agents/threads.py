"""Threads of torch, and of the linear algebra of numpy and scipy."""

from collections.abc import Iterator
from contextlib import contextmanager

import scipy.linalg  # noqa: F401  # brings a library of its own, which has to be there before it is limited
import torch as th
from threadpoolctl import threadpool_limits


@contextmanager
def one_thread() -> Iterator[None]:
    """
    Let torch, numpy and scipy compute on one thread for a while, and then on as many as before.

    Small networks are fastest so: more threads wait for each other. And no bit depends on the number of cores: several
    threads add the parts of a sum in another order.
    """
    before = th.get_num_threads()
    th.set_num_threads(1)
    try:
        with threadpool_limits(1):
            yield
    finally:
        th.set_num_threads(before)
