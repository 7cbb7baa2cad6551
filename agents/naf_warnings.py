"""Warnings of NAF: of rewards that mu learns badly from, of values that run away, and of threads that wait."""

from collections.abc import Sequence

import numpy as np
import torch as th

RUNAWAY_RATIO = 1.5
"""V over its bound from which on a warning says that it runs away."""
FRESH_UPDATES = 1000
"""Number of updates in which V may still be that of fresh networks, whatever rewards are."""
SMALL_REWARD = 0.01
"""Largest reward below which the noise of learning rates is larger."""
FAR_REWARD = 5.0
"""Distance of the rewards' mean from 0 that is far, in deviations and in units of reward."""
LARGE_DEVIATION = 30.0
"""Deviation of the rewards that is large: somewhat above it first seeds of a small task fail."""
FEWEST_REWARDS = 5
"""Number of rewards below which their mean and deviation say nothing."""
FIRST_UPDATES = 10
"""Number of updates that are timed, or fewer if they have taken too long by then."""
SLOW_UPDATE = 0.05
"""Seconds that a small network's update only takes where threads wait for each other."""
SMALL_UPDATE = 1e8
"""Number of weights times transitions of a batch up to which one thread needs a small part of that time."""


def reward_warning(rewards: np.ndarray) -> str | None:
    """
    What to say of rewards that are all far from 0, where networks begin, or that are large

    Until ``V`` is down there, the parabola follows them sooner by pushing ``mu`` away from what was tried. Until it
    is up there, the error of ``Q`` is large, and so is the pull of ``mu`` to the centre.

    :param rewards: Rewards of the warm-up
    :return: The warning; none if there is nothing to say
    """
    if rewards.size < FEWEST_REWARDS or not np.isfinite(rewards).all():
        return None
    std, mean = (one.item() for one in th.std_mean(th.as_tensor(rewards), correction=0))
    if abs(mean) > FAR_REWARD * max(1.0, std):
        side, remedy = ("below", f"reward + {-mean:.3g}") if mean < 0 else ("above", f"reward - {mean:.3g}")
        return (
            f"rewards of {mean:.3g} on average are far {side} 0, and mu learns from them slowly or not at all. "
            f"Remedy: take their mean off in the environment, as {remedy}; or scale them, if it is for "
            "the agent to end the episode"
        )
    if std > LARGE_DEVIATION:
        return (
            f"rewards with a deviation of {std:.3g} are large, and mu learns from them slowly or ends at its "
            "bounds. Remedy: scale them to about 1"
        )
    return None


def value_warning(largest: float, ceiling: float, bound: float, gamma: float, has_w: bool) -> str:
    """
    What to say of a ``V`` far beyond what rewards allow, with the remedy

    :param largest: Largest ``V`` of a batch
    :param ceiling: Value of the highest reward so far at every step, or 0
    :param bound: The same of the largest reward, whatever its sign
    :param gamma: the discount factor
    :param has_w: Whether targets take ``W``
    :return: The warning
    """
    cause = "it runs away"
    if bound * (1 - gamma) < SMALL_REWARD:
        cause, remedy = "the rewards are smaller than what networks resolve", "scale the rewards up"
    elif not has_w:
        remedy = "give net_arch as a list, or with layers for W in place of V"
    else:
        remedy = "take a wider exploration_std or a lower learning_rate"
    return (
        f"V of {largest:.3g} is beyond {ceiling:.3g}, the largest value that the rewards so far "
        f"allow, by {(largest - ceiling) / bound:.2g} times |reward| / (1 - gamma) = {bound:.3g}: {cause}. "
        f"Remedy: {remedy}"
    )


class FirstUpdates:
    """Time that the first updates of an agent take, and the warning if threads make them slow."""

    def __init__(self) -> None:
        self.seconds = 0.0
        self.updates = 0

    def thread_warning(
        self, seconds: float, updates: int, parameters: Sequence[th.Tensor], batch_size: int
    ) -> str | None:
        """
        What to say once of updates that are slow because several threads share the work of small networks.

        Where other processes keep the cores busy, an operation waits until each of its threads has had its turn. On
        idle cores small networks gain nothing by a second thread.

        :param seconds: Time that some more updates took
        :param updates: Number of them
        :param parameters: Weights that they changed
        :param batch_size: Number of transitions in a minibatch
        :return: The warning; none if there is nothing to say
        """
        if self.updates >= FIRST_UPDATES:
            return None
        self.seconds += seconds
        self.updates += updates
        threads, mean = th.get_num_threads(), self.seconds / self.updates
        is_slow = self.seconds >= SLOW_UPDATE * max(self.updates, FIRST_UPDATES)
        if not is_slow or threads == 1 or not _is_small(parameters, batch_size):
            return None
        self.updates = max(self.updates, FIRST_UPDATES)
        return (
            f"updates take {mean:.2g} s each, as the {threads} threads of torch wait for each other: the cores are "
            "busy, and the networks small. Remedy: torch.set_num_threads(1), or OMP_NUM_THREADS=1 in the environment "
            "of the program, which holds for NumPy as well"
        )


def _is_small(parameters: Sequence[th.Tensor], batch_size: int) -> bool:
    """Whether an update is so little work that threads gain next to nothing; weights of images are used many times."""
    on_cpu = all(weights.device.type == "cpu" and weights.dim() <= 2 for weights in parameters)
    return on_cpu and batch_size * sum(weights.numel() for weights in parameters) <= SMALL_UPDATE
