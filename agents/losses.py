"""Losses of NAF beside the error of Q."""

import torch as th

from sarah.agents.critic import Values

EVEN_SHARE = 0.2
"""Share of the weight in the loss of W that all replayed actions have alike."""
PRIOR_ACTIONS = 30
"""Number of replayed actions for which the prior of mu counts, if their distance from mu is 1."""
HIGHEST_PULL = 0.1
"""Largest weight of that prior beside the mean error of Q, while few actions are replayed."""


def nearby_loss(values: Values, targets: th.Tensor) -> th.Tensor:
    """
    Loss of ``W``, by which it becomes the mean of the targets of actions near ``mu``.

    Whatever the weights, a mean is never above the largest target. The network may be, in states that it hardly knows.

    :param values: Values of replayed actions
    :param targets: What these actions led to
    :return: Mean squared error of ``W``, weighted by the nearness of the actions
    """
    weights = nearby_weights(values.distance.detach())
    return (weights * (values.target - targets).square()).sum()


def nearby_weights(distances: th.Tensor) -> th.Tensor:
    """
    Weights of replayed actions in the loss of ``W``.

    An action whose squared distance from ``mu`` is the batch's mean counts by a factor of e less than ``mu`` itself. A
    share of the weight is spread evenly: where nobody acts near ``mu``, ``W`` would otherwise follow no target at all.
    With many actions all distances are nearly the batch's mean, and so the weights are nearly even.

    :param distances: Squared distances of the actions from ``mu``, of shape (batch, 1)
    :return: Weights of the same shape, whose sum is 1
    """
    weights = th.softmax(distances / (-distances.mean() - 1e-8), dim=0)
    return (1 - EVEN_SHARE) * weights + EVEN_SHARE / len(weights)


def centre_loss(values: Values, q_loss: th.Tensor, n_transitions: int) -> th.Tensor:
    """
    Loss of ``mu`` away from the centre of the action space, which counts for less the more transitions there were.

    Until ``V`` is settled, the parabola also follows targets by pushing ``mu`` away from all replayed actions. Where
    the tanh of ``mu`` and the parabola are flat, it gets no gradient, and stays. The pull is a normal prior of ``mu``,
    and the error of ``Q`` the noise of the data beside it. So it has the units of the loss.

    :param values: Values of replayed actions
    :param q_loss: Mean squared error of ``Q``
    :param n_transitions: Number of transitions so far
    :return: Mean squared length of ``mu``, times its weight
    """
    weight = min(HIGHEST_PULL, PRIOR_ACTIONS / n_transitions)
    return weight * q_loss.detach() * values.mu.square().sum(dim=1).mean()
