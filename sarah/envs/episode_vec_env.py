"""Many episodes at once, as one environment of stable-baselines3 that answers in order.

Stepping many environments side by side waits for the slowest of each round, and episodes last from 2 to 30 s. Here a
fixed number of episodes is in flight instead: a step submits one more, and waits only for the oldest. So a step returns
the outcome of an action some steps before, and the buffer of :mod:`sarah.training.replay` stores it with that action.
The order of the outcomes, and with it the training, does not depend on the workers.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import gymnasium
import numpy as np
from stable_baselines3.common.vec_env import VecEnv
from stable_baselines3.common.vec_env.base_vec_env import VecEnvIndices

from sarah.envs.sarah_env import SarahEnv, draw_seed, observation_from, parameters_from
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.task_answers import disturbances_of
from sarah.episode.tasks import Task
from sarah.episode.workers import Executor, Job, begin_episode, executor_of, finish_episode
from sarah.errors import ConfigurationError, LearningError, check_whole
from sarah.robot.reading import SensorReading
from sarah.simulation.world import HoldsWorld

LARGEST_RETURN = float(np.finfo(np.float32).max)
"""Largest return by amount that an agent can learn from."""
MOST = 2**31
"""Largest number of episodes, and of episodes in flight."""


class _Running(NamedTuple):
    spec: EpisodeSpec
    following: EpisodeSpec | None
    observation: np.ndarray
    action: np.ndarray
    job: Job


class EpisodeVecEnv(HoldsWorld, VecEnv):
    """Episodes of one :class:`~sarah.envs.sarah_env.SarahEnv`, several of them in flight.

    Step k submits the episode of its action and returns the outcome of step ``k - slots + 1``. The reward is that
    episode's return. ``info`` contains its ``spec``, ``result``, ``disturbances`` unless the task names none, and
    ``transition`` (observation, action, last observation). The first ``slots - 1`` steps have no outcome: they end no
    episode, and have ``None`` as ``info["transition"]``. The last ``slots - 1`` steps submit nothing. So
    :attr:`episodes` take ``episodes + slots - 1`` steps.

    :param task: task, or the name of one of this package
    :param config: settings of the episodes
    :param episodes: number of episodes
    :param slots: number of episodes in flight
    :param workers: executor that simulates the episodes
    :raises ConfigurationError: naming the argument that is not allowed
    """

    episodes: int
    """Number of episodes that the environment has after the next :meth:`reset`."""

    def __init__(
        self, task: str | Task[Any], config: EpisodeConfig, episodes: int, slots: int, workers: Executor
    ) -> None:
        self.episodes = check_whole("episodes", episodes, 0, MOST)
        self._slots = check_whole("slots", slots, 1, MOST)
        self._workers = executor_of(workers)
        self._env = SarahEnv(task, config)
        super().__init__(1, self._env.observation_space, self._env.action_space)
        self._task = self._env.task
        self._config = config
        self._running: deque[_Running] = deque()
        self._waiting: deque[tuple[EpisodeSpec, Callable[[], SensorReading]]] = deque()
        self._steps = self._steps_left = 0

    def reset(self) -> np.ndarray:
        """Begin anew, with the episodes that the seed of :meth:`seed` draws.

        :return: the observation of the first episode, of shape (1, 16)
        :raises ConfigurationError: if there are no episodes
        """
        check_whole("episodes", self.episodes, 1, MOST)
        if self._seeds[0] is not None:  # without a new seed the generator goes on, as in SarahEnv
            self._env.np_random = np.random.default_rng(self._seeds[0])
        self._reset_seeds()
        self._running.clear()
        self._waiting.clear()
        self._steps = self._begun = 0
        self._steps_left = self.episodes + self._slots - 1
        for _ in range(min(self._slots, self.episodes)):
            spec = self._next_spec()
            self._waiting.append((spec, self._workers.submit(begin_episode, spec).result))
        self._observe()
        return self._observation[None]

    def step_async(self, actions: np.ndarray) -> None:
        """Submit the episode of an action, unless all episodes have been submitted.

        :param actions: one action in [-1, 1], of shape (1, number of parameters)
        :raises ConfigurationError: before the first reset, and if all episodes are over
        """
        if self._steps == self._steps_left:
            raise ConfigurationError("no episodes are left: call reset before step")
        self._steps += 1
        if self._steps > self.episodes:
            return
        spec, _ = self._waiting.popleft()
        spec = replace(spec, parameters=parameters_from(actions[0], self._task))
        # The worker then lets another episode stand, which the agent acts on when it knows this one's outcome.
        following = self._next_spec() if self._begun < self.episodes else None
        job = self._workers.submit(finish_episode, spec, following)
        self._running.append(_Running(spec, following, self._observation, actions[0].copy(), job))

    def step_wait(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[dict[str, Any]]]:
        """Wait for the oldest episode if all slots are in flight, and for the next episode to stand.

        :raises LearningError: if the return is too large for an agent's 32-bit numbers
        """
        reward, info = 0.0, dict[str, Any](transition=None)
        if self._steps >= self._slots:
            reward, info = self._oldest_outcome()
        self._observe()
        has_outcome = info["transition"] is not None
        return self._observation[None], np.array([reward], np.float32), np.array([has_outcome]), [info]

    def _next_spec(self) -> EpisodeSpec:
        """Specification of the next episode, with the baseline's parameters until its own are known."""
        self._begun += 1
        return EpisodeSpec(self._task.baseline, draw_seed(self._env.np_random), self._task, self._config)

    def _observe(self) -> None:
        """Wait for the observation of the next episode; after the last episode the observation stays."""
        if self._waiting:
            _, reading = self._waiting[0]
            self._observation = observation_from(reading(), self._config.scale)

    def _oldest_outcome(self) -> tuple[float, dict[str, Any]]:
        spec, following, observation, action, job = self._running.popleft()
        result, reading, following_reading = job.result()
        if following is not None:
            self._waiting.append((following, lambda: following_reading))
        transition = (observation, action, observation_from(reading, self._config.scale))
        if abs(result.episode_return) > LARGEST_RETURN:
            raise LearningError(
                f"a return of {result.episode_return:g} is too large for an agent, which computes in 32-bit numbers: "
                "scale the task's reward"
            )
        info = {"spec": spec, "result": result, "transition": transition}
        if (disturbances := disturbances_of(spec)) is not None:
            info["disturbances"] = disturbances
        return result.episode_return, info

    def close(self) -> None:
        """Do nothing: the workers are closed by the caller who made them."""

    def get_attr(self, attr_name: str, indices: VecEnvIndices = None) -> list[Any]:
        """Attribute of the environment, as a list of one value."""
        return [getattr(self._env, attr_name)]

    def set_attr(self, attr_name: str, value: Any, indices: VecEnvIndices = None) -> None:
        """Refuse to change the environment: an episode's settings are those of its specification."""
        raise NotImplementedError("episodes are simulated in workers: make another environment instead")

    def env_method(self, method_name: str, *args: Any, indices: VecEnvIndices = None, **kwargs: Any) -> list[Any]:
        """Refuse to call the environment, as :meth:`set_attr`."""
        raise NotImplementedError("episodes are simulated in workers: there is no environment to call")

    def env_is_wrapped(self, wrapper_class: type[gymnasium.Wrapper], indices: VecEnvIndices = None) -> list[bool]:
        """Answer that no wrapper is around the episodes."""
        return [False]
