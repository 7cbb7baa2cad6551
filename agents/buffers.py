"""Replay buffer for tasks of one step, which draws good episodes more often than bad ones and knows the best action."""

from typing import Any

import numpy as np
import torch as th
from gymnasium import spaces
from stable_baselines3.common.buffers import ReplayBuffer
from stable_baselines3.common.type_aliases import ReplayBufferSamples
from stable_baselines3.common.vec_env import VecNormalize

from sarah.agents.arguments import checked_disturbances, checked_number
from sarah.agents.corrections import corrected

DOUBT = 0.25
"""Worthless transitions that every neighbourhood is thought to hold, so that single lucky ones do not win."""
NEIGHBOURHOOD = 0.15
"""Distance over which one transition says something of another's action, in scaled actions."""
SURROUNDINGS = 0.7
"""The same for actions that are still to be tried, as a share of the deviation that they are drawn with: wide at first,
when little is known. Never less than the distance above."""
LITTLE_DOUBT = 1e-3
"""Of them: average transitions in every neighbourhood, which count only where hardly anything is known."""
BEST_CANDIDATES = 100
"""Transitions of the highest rewards, among which the best action is looked for."""
MOST_JUDGED = 10_000
"""Newest transitions that the best action is judged by: in larger buffers a decision takes no longer."""


@np.errstate(under="ignore")  # What is far away weighs nothing
def neighbourhood_means(
    at: np.ndarray, places: np.ndarray, values: np.ndarray, distance: float, doubt: float = DOUBT
) -> np.ndarray:
    """
    Mean value around some places, by a Gaussian kernel, where little is known drawn towards 0.

    :param at: Places to judge, of shape (m, dim)
    :param places: Places of known values, of shape (n, dim)
    :param values: Values there, of shape (n,)
    :param distance: Standard deviation of the kernel
    :param doubt: Values of 0 that every place is thought to have
    :return: Means of shape (m,)
    """
    # -|a - b|^2 / 2 as a b - |a|^2 / 2 - |b|^2 / 2, in one matrix: several times faster than by all differences
    weights = at @ places.T
    weights -= np.square(at).sum(axis=1)[:, None] / 2
    weights -= np.square(places).sum(axis=1) / 2
    weights /= distance**2
    np.exp(weights, out=weights)
    return weights @ values.astype(weights.dtype) / (weights.sum(axis=1) + doubt)


def average_ranks(values: np.ndarray) -> np.ndarray:
    """
    Ranks scaled to [0, 1], 0 for the lowest value and 1 for the highest; equal values share their mean rank.
    What is not a number ranks lowest.

    :param values: Values to rank, of shape (n,)
    :return: Ranks of shape (n,)
    """
    _, inverse, counts = np.unique(np.where(np.isnan(values), -np.inf, values), return_inverse=True, return_counts=True)
    mean_positions = np.cumsum(counts) - (counts + 1) / 2
    return mean_positions[inverse] / max(len(values) - 1, 1)


class RankReplayBuffer(ReplayBuffer):
    """
    Replay buffer that draws a transition with a probability proportional to ``exp(temperature * rank)``,
    where ``rank`` is that of its reward in the buffer, from 0 (lowest) to 1 (highest), mean rank for ties.
    Transitions of all environments are ranked together.

    It is meant for episodes of one step, where the reward is the return. In longer episodes it would favour transitions
    of high reward whatever they lead to, so ``gamma`` must be 0. It favours lucky transitions, too: noise makes the
    values that are learned from it too high. The probabilities are computed at the first draw after an addition, in O(n
    log n). The best action is looked for among the newest 10,000 transitions.

    An environment of one step can say what luck an episode had: ``info["disturbances"]`` holds the numbers that its
    return depended on and its action did not choose, as many in every episode. Then ranks and sampled rewards are
    without the part that these explain, see :func:`~sarah.agents.corrections.corrected`; ``rewards`` stay as they came.

    :param buffer_size: Max number of elements in the buffer
    :param observation_space: Observation space
    :param action_space: Action space
    :param device: PyTorch device
    :param n_envs: Number of parallel environments
    :param optimize_memory_usage: Not supported
    :param handle_timeout_termination: Handle timeout termination (due to timelimit)
        separately and treat the task as infinite horizon task.
    :param temperature: Logarithm of how much more often the best transition is drawn than the worst, by its rank;
        0 draws all ranks alike
    """

    def __init__(
        self,
        buffer_size: int,
        observation_space: spaces.Space,
        action_space: spaces.Space,
        device: th.device | str = "auto",
        n_envs: int = 1,
        optimize_memory_usage: bool = False,
        handle_timeout_termination: bool = True,
        temperature: float = 4.0,
    ) -> None:
        if optimize_memory_usage:
            raise NotImplementedError("RankReplayBuffer doesn't support optimize_memory_usage=True")
        if isinstance(observation_space, spaces.Dict):
            raise NotImplementedError("RankReplayBuffer doesn't support Dict observations: flatten them before")
        # One row a transition, whichever environment it comes from: ranks know no environments
        super().__init__(
            buffer_size,
            observation_space,
            action_space,
            device,
            n_envs=1,
            handle_timeout_termination=handle_timeout_termination,
        )
        self.temperature = checked_number("temperature", temperature, 0.0)
        self.disturbances: np.ndarray | None = None
        self._corrected_rewards: np.ndarray | None = None
        self._cumulative_probabilities: np.ndarray | None = None

    def add(
        self,
        obs: np.ndarray,
        next_obs: np.ndarray,
        action: np.ndarray,
        reward: np.ndarray,
        done: np.ndarray,
        infos: list[dict[str, Any]],
    ) -> None:
        """
        Add one transition of each environment, whose info may hold what its disturbances were.

        :raises ValueError: if disturbances are not finite, or not as many as those of the transitions before, or if an
            action is not finite
        """
        if not np.isfinite(action).all():
            raise ValueError(
                f"an action must be finite, not {np.asarray(action).tolist()}: see the agent and its noise"
            )
        self._forget()
        for i, info in enumerate(infos):
            row = slice(i, i + 1)
            self._add_disturbances(info.get("disturbances"))
            super().add(obs[row], next_obs[row], action[row], reward[row], done[row], [info])

    def _add_disturbances(self, given: Any) -> None:
        """Store the disturbances of the next transition. The first transition says how many all have."""
        if self.size() == 0 and given is not None:
            self.disturbances = np.zeros((self.buffer_size, len(checked_disturbances(given, None))))
        if (given is None) != (self.disturbances is None):
            raise ValueError('info["disturbances"] must be there in every episode or in none')
        if self.disturbances is not None:
            self.disturbances[self.pos] = checked_disturbances(given, self.disturbances.shape[1])

    def reset(self) -> None:
        """
        Reset the buffer.
        """
        super().reset()
        self.disturbances = None
        self._forget()

    def _forget(self) -> None:
        """Forget what was computed from the transitions before."""
        self._corrected_rewards = self._cumulative_probabilities = None

    def sample(self, batch_size: int, env: VecNormalize | None = None) -> ReplayBufferSamples:
        """
        Sample transitions, with replacement.

        :param batch_size: Number of elements to sample
        :param env: associated gym VecEnv
            to normalize the observations/rewards when sampling
        :return: The transitions
        :raises ValueError: if the buffer is empty
        """
        if self.size() == 0:
            raise ValueError("the replay buffer is empty, so there is nothing to sample")
        if self._cumulative_probabilities is None:
            with np.errstate(under="ignore"):  # Ranks that are hardly ever drawn
                weights = np.exp(self.temperature * (average_ranks(self._learned_rewards()) - 1))
            cumulative = np.cumsum(weights)
            self._cumulative_probabilities = cumulative / cumulative[-1]
        # As np.random.choice does with probabilities, which it would add up again for every batch
        batch_inds = self._cumulative_probabilities.searchsorted(np.random.random_sample(batch_size), side="right")
        samples = self._get_samples(batch_inds, env=env)
        rewards = self._learned_rewards()[batch_inds, None].astype(np.float32)
        return samples._replace(rewards=self.to_torch(self._normalize_reward(rewards, env)))

    def best_action(self) -> np.ndarray:
        """
        The action around which ranks are highest, so that one lucky transition does not win.

        :return: One of the stored actions, scaled to [-1, 1], of shape (action dim,); reshaped as the action space,
            ``unscale_action`` of the policy makes one of the environment of it
        :raises ValueError: if the buffer is empty, as it is after loading an agent
        """
        self._check_not_empty()
        actions, ranks = self._newest()
        highest = np.argsort(-ranks, kind="stable")[:BEST_CANDIDATES]
        means = neighbourhood_means(actions[highest], actions, ranks, NEIGHBOURHOOD)
        return actions[highest[np.argmax(means)]]

    def _check_not_empty(self) -> None:
        if self.size() == 0:
            raise ValueError("the replay buffer is empty, so there is no best action; an agent's file does not hold it")

    def draw_near_best(self, std: float, draws: int) -> np.ndarray:
        """
        An action to try near the best one: of some Gaussian draws around it that with the best neighbourhood.

        :param std: Standard deviation of the draws, in scaled actions
        :param draws: Number of draws
        :return: A scaled action, of shape (action dim,)
        """
        best = self._promising_centre()
        drawn = np.random.normal(best, std, (draws, len(best)))
        # Reflected at the bounds, where otherwise every wide draw would end
        drawn = np.where(np.abs(drawn) > 1, 2 * np.sign(drawn) - drawn, drawn).clip(-1, 1).astype(np.float32)
        return drawn[np.argmax(self._promises(drawn, std))]

    def _promising_centre(self) -> np.ndarray:
        """Action that others are drawn around."""
        return self.best_action()

    def _promises(self, drawn: np.ndarray, std: float) -> np.ndarray:
        """What is expected of actions that were drawn with a standard deviation, to compare them."""
        actions, ranks = self._newest()
        distance = max(NEIGHBOURHOOD, SURROUNDINGS * std)
        return neighbourhood_means(drawn, actions, ranks - ranks.mean(), distance, LITTLE_DOUBT)

    def _learned_rewards(self) -> np.ndarray:
        """Rewards as they are ranked and sampled."""
        return self._without_luck()

    def _newest(self) -> tuple[np.ndarray, np.ndarray]:
        """Actions and ranks of the newest transitions."""
        count = min(self.size(), MOST_JUDGED)
        newest = np.arange(self.pos - count, self.pos)  # In a full buffer, negative ones count from its end
        return self.actions[newest, 0], average_ranks(self._without_luck()[newest])

    def _without_luck(self) -> np.ndarray:
        """Rewards as they are stored, without what disturbances explain of them."""
        rewards = self.rewards[: self.size(), 0]
        if self.disturbances is None:
            return rewards
        if self._corrected_rewards is None:
            oldest_first = np.arange(self.pos - len(rewards), self.pos)  # Negative ones are at its end
            self._corrected_rewards = np.empty(len(rewards))
            self._corrected_rewards[oldest_first] = corrected(
                rewards[oldest_first], self.actions[oldest_first, 0], self.disturbances[oldest_first]
            )
        return self._corrected_rewards
