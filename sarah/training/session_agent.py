"""NAF in a session: every window is a step of an environment."""

from __future__ import annotations

from typing import Any

from sarah.agents import PRESETS, LocalNAF, RankReplayBuffer
from sarah.envs.operation_env import SarahOperationEnv
from sarah.operation.operated_robot import OperatedRobot
from sarah.operation.settings import Parameters

UNSMOOTHED: dict[str, Any] = dict(replay_buffer_class=RankReplayBuffer, elite_share=0.5, elite_draws=16)
"""Arguments that differ from the preset's: a robot in operation changes, and rewards from before say less of it."""
LONGEST = 1_000_000
"""Number of windows that no operation has."""


def operate_by_naf(robot: OperatedRobot, first: Parameters, seed: int) -> Parameters:
    """Operate a robot by LocalNAF with its preset for few steps, around the first parameters, until the time is over.

    A window is worth its own reward only.

    :param robot: robot to operate
    :param first: parameters to begin with
    :param seed: seed of the agent
    :return: the best action that the agent knows, as parameters
    """
    env = SarahOperationEnv(robot.config, first, operated=robot)
    settings: dict[str, Any] = {**PRESETS["one-step"], **UNSMOOTHED, "device": "cpu"}
    model = LocalNAF("MlpPolicy", env, seed=seed, first_action_centre=True, **settings)
    model.learn(LONGEST, callback=lambda *_: not robot.is_over, log_interval=None)  # type: ignore[arg-type]
    assert isinstance(model.replay_buffer, RankReplayBuffer)
    if model.replay_buffer.size() == 0:  # the time was over before it could learn
        return first
    return env.parameters_from(model.replay_buffer.best_action())
