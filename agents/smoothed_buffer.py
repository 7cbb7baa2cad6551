"""Replay buffer for noisy tasks of one step: every reward is replaced by what is expected of its action."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from sarah.agents.arguments import checked_number
from sarah.agents.buffers import RankReplayBuffer
from sarah.agents.gaussian_process import MOST_EPISODES, GaussianProcess

ADDITIONS_PER_CHOICE = 10
"""Additions to the buffer after which length and noise of the Gaussian process are chosen again."""
OPTIMISM = 1.0
"""Standard deviations by which an action may be better than expected where exploration looks for the best one: without
any it would stay where it began to be good."""


class SmoothedReplayBuffer(RankReplayBuffer):
    """
    Replay buffer that ranks and samples the rewards that a Gaussian process expects of the actions, not those they had.

    Lucky transitions are then as good as their neighbours, and the best action is looked for in the whole action space.
    This suits tasks of one step whose observation says little of the reward. What it does say is averaged as well:
    where it matters, take :class:`~sarah.agents.buffers.RankReplayBuffer`. ``rewards`` stay as they came.

    :param buffer_size: Max number of elements in the buffer; no more than the 500 that the process can know
    :param arguments: Other arguments of :class:`~sarah.agents.buffers.RankReplayBuffer`
    :param length_scales: Factor on the length along each dimension, from 0.01 to 100: below 1 where rewards change fast
    :param kwargs: Other arguments by name
    """

    length_scales: list[float] | None = None

    def __init__(
        self, buffer_size: int, *arguments: Any, length_scales: Sequence[float] | None = None, **kwargs: Any
    ) -> None:
        super().__init__(min(buffer_size, MOST_EPISODES), *arguments, **kwargs)
        if length_scales is not None:
            given = np.ravel(np.array(length_scales, dtype=object)).tolist()
            if len(given) != self.action_dim:
                raise ValueError(f"length_scales must be {self.action_dim} numbers, not {length_scales!r}")
            self.length_scales = [checked_number("each of length_scales", one, 0.01, 100.0) for one in given]
        self._process: GaussianProcess | None = None
        self._kernel: tuple[float, float] | None = None
        self._learned: np.ndarray | None = None
        self._additions = 0

    def reset(self) -> None:
        """
        Reset the buffer.
        """
        super().reset()
        self._kernel, self._additions = None, 0

    def best_action(self) -> np.ndarray:
        """
        The action of the highest expected reward.

        :return: An action scaled to [-1, 1], of shape (action dim,); reshaped as the action space, ``unscale_action``
            of the policy makes one of the environment of it
        :raises ValueError: if the buffer is empty, as it is after loading an agent
        """
        self._check_not_empty()
        return self._expectation().best().astype(np.float32)

    def _forget(self) -> None:
        super()._forget()
        self._process = self._learned = None
        self._additions += 1
        if self._additions % ADDITIONS_PER_CHOICE == 0:
            self._kernel = None

    def _promising_centre(self) -> np.ndarray:
        self._check_not_empty()
        return self._expectation().best(deviations=OPTIMISM)

    def _promises(self, drawn: np.ndarray, std: float) -> np.ndarray:
        return self._expectation().upper_bounds(drawn, OPTIMISM)

    def _learned_rewards(self) -> np.ndarray:
        if self._learned is None:
            rewards, actions = self._without_luck(), self.actions[: self.size(), 0].astype(float)
            self._learned = np.where(np.isfinite(rewards), self._expectation().expected(actions), rewards)
        return self._learned

    def _expectation(self) -> GaussianProcess:
        """What the process expects after the transitions so far."""
        if self._process is None:
            rewards = self._without_luck()
            oldest_first = np.arange(self.pos - len(rewards), self.pos)  # Negative ones are at its end
            known = oldest_first[np.isfinite(rewards[oldest_first])]
            self._process = GaussianProcess(self.actions[known, 0], rewards[known], self._kernel, self.length_scales)
            self._kernel = self._process.kernel
        return self._process
