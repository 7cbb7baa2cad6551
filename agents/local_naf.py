"""NAF for tasks of one step, which explores around the best action so far."""

from typing import Any

import numpy as np
import torch as th
from stable_baselines3.common.noise import ActionNoise
from stable_baselines3.common.type_aliases import GymEnv, Schedule

from sarah.agents.arguments import Deviations, checked_number, checked_schedule
from sarah.agents.buffers import RankReplayBuffer
from sarah.agents.even_warm_up import EvenWarmUp
from sarah.agents.naf import NAF
from sarah.agents.policies import NAFPolicy
from sarah.agents.unknown_arguments import explains_unknown


class LocalNAF(EvenWarmUp, NAF):
    """
    NAF for tasks of one step and a few hundred of them to spend

    A parabola cannot fit a landscape with cliffs and decoys, and then ``mu`` is wrong. So good transitions are replayed
    more often than bad ones, and part of the exploring actions are drawn around the best known action, not around
    ``mu``. The actions of the warm-up are spread evenly over the action space. ``PRESETS["one-step"]`` holds the other
    arguments that suit such tasks.

    :param policy: The policy model to use (MlpPolicy, CnnPolicy, ...)
    :param env: The environment to learn from (if registered in Gym, can be str)
    :param gamma: the discount factor; above 0 only for a replay without ranks, that is with ``temperature=0`` and
        ``elite_share=0``
    :param replay_buffer_class: Replay buffer class to use, which must know the best action
    :param elite_share: Share of the exploring actions that are drawn around the best action of the replay buffer;
        it can be a function of the current progress remaining (from 1 to 0)
    :param elite_std: Standard deviation of these draws, in actions scaled to [-1, 1]; it can be a function of the
        current progress remaining (from 1 to 0)
    :param elite_draws: Number of draws for each such action. The one that the replay buffer expects most of is done, so
        that wide draws follow what is known
    :param first_action_centre: Whether the first environment's first action is the centre of the action space, often
        a neutral one. Then actions around the best one are drawn as soon as its outcome is known, and the others of the
        warm-up are uniform, not spread evenly
    :param _init_setup_model: Whether or not to build the network at the creation of the instance

    The other arguments are those of :class:`~sarah.agents.naf.NAF`.
    """

    replay_buffer: RankReplayBuffer

    @explains_unknown
    def __init__(
        self,
        policy: str | type[NAFPolicy],
        env: GymEnv | str,
        learning_rate: float | Schedule = 1e-3,
        buffer_size: int = 1_000_000,  # 1e6
        learning_starts: int = 100,
        batch_size: int = 256,
        tau: float = 0.02,
        gamma: float = 0.0,
        train_freq: int | tuple[int, str] = 1,
        gradient_steps: int = 1,
        action_noise: ActionNoise | None = None,
        replay_buffer_class: type[RankReplayBuffer] = RankReplayBuffer,
        replay_buffer_kwargs: dict[str, Any] | None = None,
        optimize_memory_usage: bool = False,
        n_steps: int = 1,
        max_grad_norm: float | None = 1.0,
        exploration_std: Deviations = 0.3,
        stats_window_size: int = 100,
        tensorboard_log: str | None = None,
        policy_kwargs: dict[str, Any] | None = None,
        verbose: int = 0,
        seed: int | None = None,
        device: th.device | str = "auto",
        _init_setup_model: bool = True,
        *,
        elite_share: float | str | Schedule = 0.5,
        elite_std: float | str | Schedule = 0.2,
        elite_draws: int = 16,
        first_action_centre: bool = False,
    ) -> None:
        super().__init__(
            policy,
            env,
            learning_rate,
            buffer_size,
            learning_starts,
            batch_size,
            tau,
            gamma,
            train_freq,
            gradient_steps,
            action_noise,
            replay_buffer_class,
            replay_buffer_kwargs,
            optimize_memory_usage,
            n_steps,
            max_grad_norm,
            exploration_std,
            stats_window_size,
            tensorboard_log,
            policy_kwargs,
            verbose,
            seed,
            device,
            _init_setup_model=False,
        )

        self.elite_share = elite_share
        self.elite_std = elite_std
        self.elite_draws = elite_draws
        self.first_action_centre = first_action_centre

        if _init_setup_model:
            self._setup_model()

    def _setup_model(self) -> None:
        super()._setup_model()
        if not isinstance(self.first_action_centre, bool):
            raise ValueError(f"first_action_centre must be True or False, not {self.first_action_centre!r}")
        self.elite_draws = checked_number("elite_draws", self.elite_draws, 1, whole=True)
        self.elite_share_schedule = checked_schedule("elite_share", self.elite_share, 0.0, 1.0)
        self.elite_std_schedule = checked_schedule("elite_std", self.elite_std, 0.0)
        if not isinstance(self.replay_buffer, RankReplayBuffer):
            raise ValueError(
                f"LocalNAF needs a RankReplayBuffer, not a {type(self.replay_buffer).__name__}, "
                "which an agent of NAF has: NAF.load loads that"
            )
        if self.gamma != 0 and self.elite_share != 0:
            raise ValueError(
                f"gamma must be 0 with elite_share above 0, not {self.gamma!r}: "
                "the best action is that of the best reward, whatever it leads to"
            )

    def _sample_action(
        self,
        learning_starts: int,
        action_noise: ActionNoise | None = None,
        n_envs: int = 1,
    ) -> tuple[np.ndarray, np.ndarray]:
        action, scaled_action = super()._sample_action(learning_starts, action_noise, n_envs)
        elite_share = self.elite_share_schedule(self._current_progress_remaining)
        if elite_share > 0 and self._knows_a_best_action(learning_starts):
            self._draw_near_best(scaled_action, elite_share)
            action = self.policy.unscale_action(scaled_action)
        return self._begin_at_centre(action, scaled_action)

    def _knows_a_best_action(self, learning_starts: int) -> bool:
        """Whether the draws around it may begin: after the warm-up, or with the outcome of the centre."""
        return self.replay_buffer.size() > 0 and (self.first_action_centre or self.num_timesteps >= learning_starts)

    def _draw_near_best(self, scaled_actions: np.ndarray, share: float) -> None:
        """
        Replace a share of some exploring actions by draws around the best action.

        :param scaled_actions: One of each environment; changed in place
        :param share: Share of them
        """
        std = self.elite_std_schedule(self._current_progress_remaining)
        near_best = np.random.random(len(scaled_actions)) < share
        for i in np.flatnonzero(near_best):
            elite = self.replay_buffer.draw_near_best(std, self.elite_draws)
            scaled_actions[i] = elite.reshape(scaled_actions[i].shape)
