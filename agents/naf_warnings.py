"""Warnings of NAF: of rewards that mu learns badly from, and of values that run away."""

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
