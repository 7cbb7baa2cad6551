"""Warnings of NAF: of rewards that mu learns badly from, of values that run away, and of threads that wait."""

from collections.abc import Sequence
from dataclasses import dataclass

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
REWARDS_WITHOUT_WARM_UP = 100
"""Number of rewards that are judged where there is no warm-up: those of a few successive steps are alike."""
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
            f"Remedy: subtract their mean in the environment, as {remedy}; or scale them, if the agent "
            "can end the episode"
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


@dataclass
class Watch:
    """
    What an agent has seen of an environment since it was made or loaded, and what was said of it

    :param updates: Number of updates
    :param seconds: Time that the first of them took
    :param value_bound: Value of the largest reward so far, whatever its sign, if it came at every step
    :param value_ceiling: The same for the highest reward, or 0 where all are negative, because an episode may end
    :param warned_of_values: Whether ``V`` was said to run away
    :param judged_rewards: Whether the first rewards were judged
    """

    updates: int = 0
    seconds: float = 0.0
    value_bound: float = 0.0
    value_ceiling: float = 0.0
    warned_of_values: bool = False
    judged_rewards: bool = False

    def judge_rewards(self, rewards: np.ndarray, warm_up: float, is_full: bool) -> str | None:
        """
        What to say once of the rewards of the warm-up, or of the first ones without it; see :func:`reward_warning`

        :param rewards: Rewards so far
        :param warm_up: Number of steps of the warm-up
        :param is_full: Whether the replay buffer holds no more than these
        :return: The warning; none if there is nothing to say
        """
        enough = max(warm_up or REWARDS_WITHOUT_WARM_UP, FEWEST_REWARDS)
        if self.judged_rewards or (rewards.size < enough and not is_full):
            return None
        self.judged_rewards = True
        return reward_warning(rewards)

    def judge_value(
        self, largest: float, forever: tuple[float, float], gamma: float, has_w: bool
    ) -> tuple[float | None, str | None]:
        """
        How near ``V`` comes to the largest value that rewards allow, and what to say once if it is far beyond.

        That value is the ceiling. Where ``V`` exceeds it, the excess counts in units of the bound.

        :param largest: Largest ``V`` of a batch
        :param forever: Values of the lowest and the highest reward of this batch if they came at every step
        :param gamma: the discount factor
        :param has_w: Whether targets take ``W``
        :return: Ratio that is 1 at the ceiling, none while all rewards are 0; and the warning, none if there is nothing
            to say
        """
        lowest, highest = forever
        self.value_bound = max(self.value_bound, highest, -lowest)
        self.value_ceiling = max(self.value_ceiling, highest)
        if self.value_bound == 0:
            return None, None
        ratio = 1 + (largest - self.value_ceiling) / self.value_bound
        if ratio <= RUNAWAY_RATIO or self.updates <= FRESH_UPDATES or self.warned_of_values:
            return ratio, None
        self.warned_of_values = True
        return ratio, value_warning(largest, self.value_ceiling, self.value_bound, gamma, has_w)

    def judge_time(self, seconds: float, updates: int, parameters: Sequence[th.Tensor], batch_size: int) -> str | None:
        """
        What to say once of first updates that are slow because several threads share the work of small networks.

        Where other processes keep the cores busy, an operation waits until each of its threads has had its turn. On
        idle cores small networks gain nothing by a second thread.

        :param seconds: Time that some more updates took
        :param updates: Number of them
        :param parameters: Weights that they changed
        :param batch_size: Number of transitions in a minibatch
        :return: The warning; none if there is nothing to say
        """
        were_first = self.updates < FIRST_UPDATES
        self.updates += updates
        if not were_first:
            return None
        self.seconds += seconds
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
