"""Arguments of the algorithms for known kinds of task."""

from typing import Any

from stable_baselines3.common.utils import LinearSchedule
from torch import nn

from sarah.agents.smoothed_buffer import SmoothedReplayBuffer

ONE_STEP: dict[str, Any] = dict(
    learning_rate=1e-3,
    buffer_size=10_000,
    learning_starts=5,
    batch_size=64,
    gamma=0.0,  # The reward is the return, also where a time limit ends the episode
    gradient_steps=10,
    max_grad_norm=10.0,
    replay_buffer_class=SmoothedReplayBuffer,
    replay_buffer_kwargs=dict(temperature=4.0),
    exploration_std=LinearSchedule(0.3, 0.05, end_fraction=0.8),
    elite_share=0.8,
    elite_std=LinearSchedule(0.4, 0.15, end_fraction=0.8),
    elite_draws=1,
    policy_kwargs=dict(net_arch=dict(V=[32, 32], mu=[32, 32], L=[32, 32]), activation_fn=nn.Tanh, min_curvature=1.0),
)

PRESETS: dict[str, dict[str, Any]] = {
    # Of LocalNAF, for episodes of one step with a few hundred of them to spend. With several
    # environments, ``gradient_steps`` is per step of all of them: multiply it by their number.
    "one-step": ONE_STEP,
    # The same where chance decides more of a reward than the action does, and a second hill could be
    # taken for the higher one: its draws begin in the whole box.
    "noisy": ONE_STEP
    | dict(replay_buffer_kwargs=dict(temperature=8.0), elite_std=LinearSchedule(1.2, 0.15, end_fraction=0.8)),
    # Of NAF: the networks of Kouppas et al., literally. Their bias of 1 at the output of mu is the centre
    # of Box(0, 2), which in scaled actions is 0. With the settings of "one-step" they hardly learn.
    "paper": dict(
        policy_kwargs=dict(
            net_arch=dict(V=[256] * 3, mu=[16] * 4, L=[80] * 4),
            activation_fn=nn.Sigmoid,
            squash_mu=False,
        ),
    ),
}
"""``LocalNAF("MlpPolicy", env, **PRESETS["one-step"])``, ``NAF("MlpPolicy", env, **PRESETS["paper"])``."""
