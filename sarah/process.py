"""State that the whole process shares: a learner has it for itself, and leaves it as the caller had it."""

from __future__ import annotations

import random
import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

DEFAULT_ERRORS: dict[str, Any] = {"divide": "warn", "over": "warn", "under": "ignore", "invalid": "warn"}
"""What numpy does by default with numbers that cannot be. Libraries of learning rely on silent underflow."""


@contextmanager
def apart() -> Iterator[Callable[[], AbstractContextManager[None]]]:
    """Let a learner compute apart from everybody else in the process.

    Such libraries seed and draw from the generators of Python, numpy and torch, which afterwards are as they were.
    Torch computes in 32-bit numbers, and torch, numpy and scipy on one thread: small networks are fastest so, and
    several threads add the parts of a sum in another order. So no bit depends on the caller's settings, or on the
    number of cores. Import the library before: what is imported later is not known here.

    :return: function that makes a context in which generators and numpy's errors are the caller's again, for episodes
        and all else that is not the learner's
    """
    import scipy.linalg  # noqa: F401  # brings a library of its own, which has to be there before it is limited

    errors = np.geterr()
    callers = _generators()

    @contextmanager
    def outside() -> Iterator[None]:
        nonlocal callers
        learners = _generators()
        _set_generators(callers)
        try:
            with np.errstate(**errors):
                yield
        finally:
            callers = _generators()
            _set_generators(learners)

    try:
        with np.errstate(**DEFAULT_ERRORS), _torch_by_default(), threadpool_limits(1):
            yield outside
    finally:
        _set_generators(callers)


def _generators() -> tuple[Any, ...]:
    """States of the generators of the process."""
    torch = sys.modules.get("torch")
    states: tuple[Any, ...] = (random.getstate(), np.random.get_state())
    if torch is None:
        return states
    return (*states, torch.get_rng_state(), torch.cuda.get_rng_state_all() if torch.cuda.is_initialized() else [])


def _set_generators(states: tuple[Any, ...]) -> None:
    python, numpy, *of_torch = states
    random.setstate(python)
    np.random.set_state(numpy)
    if of_torch:
        torch = sys.modules["torch"]
        torch.set_rng_state(of_torch[0])
        torch.cuda.set_rng_state_all(of_torch[1])


@contextmanager
def _torch_by_default() -> Iterator[None]:
    """Settings of torch by default, but on one thread."""
    torch = sys.modules.get("torch")
    if torch is None:
        yield
        return
    threads, number = torch.get_num_threads(), torch.get_default_dtype()
    cudnn = torch.backends.cudnn
    deterministic, benchmark = cudnn.deterministic, cudnn.benchmark  # which stable-baselines3 sets with a seed
    with ExitStack() as stack:
        stack.enter_context(torch.inference_mode(False))
        stack.enter_context(torch.enable_grad())
        if torch.get_default_device().type != "cpu":
            stack.enter_context(torch.device("cpu"))
        torch.set_num_threads(1)
        torch.set_default_dtype(torch.float32)
        try:
            yield
        finally:
            torch.set_num_threads(threads)
            torch.set_default_dtype(number)
            cudnn.deterministic, cudnn.benchmark = deterministic, benchmark
