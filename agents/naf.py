"""Normalized advantage functions (NAF): Q-learning for continuous actions, for stable-baselines3."""

import math
import time
import warnings
from typing import Any, ClassVar, TypeVar

import numpy as np
import torch as th
from gymnasium import spaces
from stable_baselines3.common.buffers import ReplayBuffer
from stable_baselines3.common.noise import ActionNoise, NormalActionNoise
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm
from stable_baselines3.common.policies import BasePolicy
from stable_baselines3.common.type_aliases import GymEnv, MaybeCallback, Schedule
from stable_baselines3.common.utils import get_parameters_by_name, polyak_update
from torch import nn
from torch.optim.swa_utils import get_ema_multi_avg_fn

from sarah.agents.arguments import Deviations, check_actions, checked_number, checked_schedule
from sarah.agents.buffers import RankReplayBuffer
from sarah.agents.critic import QuadraticCritic
from sarah.agents.losses import centre_loss, nearby_loss
from sarah.agents.naf_warnings import Watch
from sarah.agents.policies import CnnPolicy, MlpPolicy, MultiInputPolicy, NAFPolicy
from sarah.agents.unknown_arguments import explains_unknown

SelfNAF = TypeVar("SelfNAF", bound="NAF")


class NAF(OffPolicyAlgorithm):
    """
    Q-learning with normalized advantage functions (NAF)

    Paper: https://arxiv.org/abs/1603.00748
    (Gu et al. 2016, Continuous Deep Q-Learning with Model-based Acceleration)
    Q is quadratic in the action, so its maximum and the action that reaches it are outputs of networks:
    there is no actor to train. Targets take W of the next state, the mean of what actions near the best one led to. The
    publication's take V, the value of the best action, which runs away where several actions decide little of what
    follows, see :class:`~sarah.agents.critic.QuadraticCritic`.

    :param policy: The policy model to use (MlpPolicy, CnnPolicy, ...)
    :param env: The environment to learn from (if registered in Gym, can be str)
    :param learning_rate: The learning rate, it can be a function
        of the current progress remaining (from 1 to 0)
    :param buffer_size: size of the replay buffer
    :param learning_starts: number of steps to collect transitions for before learning starts
    :param batch_size: Minibatch size for each gradient update
    :param tau: the soft update coefficient ("Polyak update", between 0 and 1)
    :param gamma: the discount factor
    :param train_freq: Update the model every ``train_freq`` steps. Alternatively pass a tuple of frequency
        and unit like ``(5, "step")`` or ``(2, "episode")``.
    :param gradient_steps: How many gradient steps to do after each rollout (see ``train_freq``)
        Set to ``-1`` means to do as many gradient steps as steps done in the environment
        during the rollout.
    :param action_noise: the action noise type. If ``None`` (default), Gaussian noise
        of ``exploration_std`` is used, but not before ``learning_starts``, where actions are uniform.
    :param replay_buffer_class: Replay buffer class to use (for instance ``HerReplayBuffer``).
        If ``None``, it will be automatically selected.
    :param replay_buffer_kwargs: Keyword arguments to pass to the replay buffer on creation.
    :param optimize_memory_usage: Enable a memory efficient variant of the replay buffer
        at a cost of more complexity.
    :param n_steps: When n_step > 1, uses n-step return (with the NStepReplayBuffer) when updating
        the Q-value network. Note: it is only used when ``replay_buffer_class`` is ``None``,
        and is not supported for Dict observation spaces yet. When passing a custom ``replay_buffer_class``,
        configure it directly with ``replay_buffer_kwargs={"n_steps": ..., "gamma": ...}`` instead.
    :param max_grad_norm: The maximum value for the gradient clipping; ``None`` for no clipping
    :param exploration_std: Standard deviation of the Gaussian exploration noise, in actions scaled
        to [-1, 1]; an array has one for each dimension of the action. It can be a function of the current progress
        remaining (from 1 to 0), such as ``LinearSchedule``, or ``"lin_0.3"`` as in RL Zoo, which ends at 0; 0 switches
        the noise off. Without effect if ``action_noise`` is given.
    :param stats_window_size: Window size for the rollout logging, specifying the number of episodes
        to average the reported success rate, mean episode length, and mean reward over
    :param tensorboard_log: the log location for tensorboard (if None, no logging)
    :param policy_kwargs: additional arguments to be passed to the policy on creation.
        See :class:`sarah.agents.policies.NAFPolicy`
    :param verbose: Verbosity level: 0 for no output, 1 for info messages (such as device or wrappers used),
        2 for debug messages
    :param seed: Seed for the pseudo random generators
    :param device: Device (cpu, cuda, ...) on which the code should be run.
        Setting it to auto, the code will be run on the GPU if possible.
    :param _init_setup_model: Whether or not to build the network at the creation of the instance
    """

    policy_aliases: ClassVar[dict[str, type[BasePolicy]]] = {
        "MlpPolicy": MlpPolicy,
        "CnnPolicy": CnnPolicy,
        "MultiInputPolicy": MultiInputPolicy,
    }
    action_space: spaces.Box
    exploration_schedule: Schedule
    q_net: QuadraticCritic
    q_net_target: QuadraticCritic
    policy: NAFPolicy
    replay_buffer: ReplayBuffer

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
        gamma: float = 0.99,
        train_freq: int | tuple[int, str] = 1,
        gradient_steps: int = 1,
        action_noise: ActionNoise | None = None,
        replay_buffer_class: type[ReplayBuffer] | None = None,
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
            action_noise=action_noise,
            replay_buffer_class=replay_buffer_class,
            replay_buffer_kwargs=replay_buffer_kwargs,
            optimize_memory_usage=optimize_memory_usage,
            n_steps=n_steps,
            policy_kwargs=policy_kwargs,
            stats_window_size=stats_window_size,
            tensorboard_log=tensorboard_log,
            verbose=verbose,
            device=device,
            seed=seed,
            sde_support=False,
            supported_action_spaces=(spaces.Box,),
            support_multi_env=True,
        )

        self.max_grad_norm = max_grad_norm
        self.exploration_std = exploration_std
        self.watch = Watch()
        # Transitions before num_timesteps was last reset
        self.earlier_timesteps = 0

        if _init_setup_model:
            self._setup_model()

    def _setup_model(self) -> None:
        if not issubclass(self.policy_class, NAFPolicy):
            raise ValueError(
                f"the policy of NAF must be NAFPolicy or a subclass of it, not {self.policy_class.__name__}"
            )
        check_actions(self.action_space)
        self.buffer_size = checked_number("buffer_size", self.buffer_size, 1, whole=True)
        self.learning_starts = checked_number("learning_starts", self.learning_starts, 0)
        self.gradient_steps = checked_number("gradient_steps", self.gradient_steps, -1, whole=True)
        super()._setup_model()
        self._create_aliases()
        # Running mean and running var, which the target network copies
        self.batch_norm_stats = get_parameters_by_name(self.q_net, ["running_"])
        self.batch_norm_stats_target = get_parameters_by_name(self.q_net_target, ["running_"])
        self.batch_size = checked_number("batch_size", self.batch_size, 1, whole=True)
        self.gamma = checked_number("gamma", self.gamma, 0.0, 1.0)
        self.tau = checked_number("tau", self.tau, 0.0, 1.0)
        self.n_steps = checked_number("n_steps", self.n_steps, 1, whole=True)
        if self.max_grad_norm is not None:
            self.max_grad_norm = checked_number("max_grad_norm", self.max_grad_norm, 0.0, math.inf, above=True)
        shape = self.action_space.shape
        self.exploration_schedule = checked_schedule("exploration_std", self.exploration_std, 0.0, shape=shape)
        if isinstance(self.replay_buffer, RankReplayBuffer) and self.replay_buffer.temperature > 0 and self.gamma != 0:
            raise ValueError(
                f"gamma must be 0 with a RankReplayBuffer of temperature {self.replay_buffer.temperature:g}, "
                f"not {self.gamma!r}: it ranks rewards, whatever they lead to"
            )

    def _create_aliases(self) -> None:
        self.q_net = self.policy.q_net
        self.q_net_target = self.policy.q_net_target

    def _sample_action(
        self,
        learning_starts: int,
        action_noise: ActionNoise | None = None,
        n_envs: int = 1,
    ) -> tuple[np.ndarray, np.ndarray]:
        # Not in the warm-up: clipped noise would move part of its uniform actions to the bounds
        if action_noise is None and self.num_timesteps >= learning_starts:
            shape = (n_envs, *self.action_space.shape)
            std = self.exploration_schedule(self._current_progress_remaining)
            action_noise = NormalActionNoise(np.zeros(shape), np.full(shape, std))
        return super()._sample_action(learning_starts, action_noise, n_envs)

    def train(self, gradient_steps: int, batch_size: int = 100) -> None:
        """
        Sample the replay buffer and do the updates (gradient descent and update target network).

        :param gradient_steps: Number of updates
        :param batch_size: Minibatch size for each update
        :raises ValueError: if the loss is not finite, as no later update would mend the networks
        """
        if gradient_steps < 1:
            return
        if not self.watch.judged_rewards:
            self._judge_rewards()
        # Switch to train mode (this affects batch norm / dropout)
        self.policy.set_training_mode(True)
        # Update learning rate according to schedule
        self._update_learning_rate(self.policy.optimizer)

        # One call averages all parameters; a loop over them would take a tenth of the time of an update
        parameters, target_parameters = list(self.q_net.parameters()), list(self.q_net_target.parameters())
        average_parameters = get_ema_multi_avg_fn(1 - self.tau)

        # A small replay buffer has forgotten some, and a loaded one has others
        n_transitions = self.earlier_timesteps + self.num_timesteps
        n_transitions = max(n_transitions, self.replay_buffer.size() * self.replay_buffer.n_envs)
        losses, w_losses, mean_q_values, seconds = [], [], [], 0.0
        for _ in range(gradient_steps):
            # Sample replay buffer
            replay_data = self.replay_buffer.sample(batch_size, env=self._vec_normalize_env)
            start = time.perf_counter()
            # For n-step replay, discount factor is gamma**n_steps (when no early termination)
            discounts = replay_data.discounts if replay_data.discounts is not None else self.gamma

            target_q_values = replay_data.rewards
            if self.gamma > 0:  # Otherwise what comes next does not count
                with th.no_grad():
                    # Neither W nor V, the maximum of Q over the actions, needs an action
                    next_values = self.q_net_target.target_value(replay_data.next_observations)
                    # 1-step TD target
                    target_q_values = replay_data.rewards + (1 - replay_data.dones) * discounts * next_values

            # Get current Q-values estimates
            current_values = self.q_net.all_values(replay_data.observations, replay_data.actions)
            mean_q_values.append(current_values.q.detach().mean())

            loss = q_loss = nn.functional.mse_loss(current_values.q, target_q_values)
            losses.append(q_loss.detach())
            if self.q_net.has_w:
                w_loss = nearby_loss(current_values, target_q_values)
                w_losses.append(w_loss.detach())
                loss = q_loss + w_loss + centre_loss(current_values, q_loss, n_transitions)

            # Optimize the policy
            self.policy.optimizer.zero_grad()
            loss.backward()
            if self.max_grad_norm is not None:
                nn.utils.clip_grad_norm_(parameters, self.max_grad_norm)
            self.policy.optimizer.step()

            average_parameters(target_parameters, parameters, 1)
            # Copy running stats, as all algorithms of stable-baselines3 do
            polyak_update(self.batch_norm_stats, self.batch_norm_stats_target, 1.0)
            seconds += time.perf_counter() - start

        # What is asked of the networks between updates is asked of all units
        self.policy.set_training_mode(False)
        # Increase update counter
        self._n_updates += gradient_steps
        _warn(self.watch.judge_time(seconds, gradient_steps, parameters, batch_size))

        mean_loss = th.stack(losses).mean().item()
        if not math.isfinite(mean_loss):
            raise ValueError(
                f"the loss is {mean_loss}, and the agent is lost: an observation or a reward is not a number, or far "
                "too large. VecCheckNan of stable-baselines3, with raise_exception=True, finds what is not a number"
            )
        self.logger.record("train/n_updates", self._n_updates, exclude="tensorboard")
        if self.action_noise is None:
            std = self.exploration_schedule(self._current_progress_remaining)
            self.logger.record("train/exploration_std", float(np.mean(std)))
        self.logger.record("train/loss", mean_loss)
        if w_losses:
            self.logger.record("train/w_loss", th.stack(w_losses).mean().item())
        self.logger.record("train/q", th.stack(mean_q_values).mean().item())
        if 0 < self.gamma < 1:  # The last batch is a sample as good as all of them
            forever = replay_data.rewards / (1 - discounts)
            ends = forever.min().item(), forever.max().item()
            ratio, text = self.watch.judge_value(current_values.best.max().item(), ends, self.gamma, self.q_net.has_w)
            if ratio is not None:
                self.logger.record("train/value_over_bound", ratio)
            _warn(text)

    def _judge_rewards(self) -> None:
        """Warn if the rewards of the warm-up are such that ``mu`` learns badly from them."""
        buffer = self.replay_buffer
        rewards = getattr(buffer, "rewards", np.empty(0))[: buffer.size()]
        if self._vec_normalize_env is not None:
            rewards = self._vec_normalize_env.normalize_reward(rewards)
        _warn(self.watch.judge_rewards(rewards, self.learning_starts, buffer.full))

    def set_env(self, env: GymEnv, force_reset: bool = True) -> None:
        """
        Set the environment to learn from; what was seen of the rewards of another one is forgotten.

        :param env: The environment for learning a policy
        :param force_reset: Force call to ``reset()`` before training
        """
        before = self.env
        super().set_env(env, force_reset)
        if self.env is not before:
            self.watch = Watch()

    def learn(
        self: SelfNAF,
        total_timesteps: int,
        callback: MaybeCallback = None,
        log_interval: int = 4,
        tb_log_name: str = "NAF",
        reset_num_timesteps: bool = True,
        progress_bar: bool = False,
    ) -> SelfNAF:
        """Return a trained model; the arguments are those of all algorithms of stable-baselines3."""
        if reset_num_timesteps:
            self.earlier_timesteps += self.num_timesteps
        return super().learn(
            total_timesteps=total_timesteps,
            callback=callback,
            log_interval=log_interval,
            tb_log_name=tb_log_name,
            reset_num_timesteps=reset_num_timesteps,
            progress_bar=progress_bar,
        )

    def _excluded_save_params(self) -> list[str]:
        return [*super()._excluded_save_params(), "q_net", "q_net_target", "watch"]

    def _get_torch_save_params(self) -> tuple[list[str], list[str]]:
        state_dicts = ["policy", "policy.optimizer"]

        return state_dicts, []


def _warn(text: str | None) -> None:
    """Warn of what is to be said, if anything."""
    if text is not None:
        warnings.warn(text, stacklevel=3)
