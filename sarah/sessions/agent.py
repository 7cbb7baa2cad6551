"""NAF as a learner of a session: every window is a step of an environment."""

from __future__ import annotations

from typing import Any

from stable_baselines3.common.callbacks import BaseCallback

from sarah.agents import PRESETS, LocalNAF, RankReplayBuffer
from sarah.envs.operation_env import SarahOperationEnv
from sarah.operation.operation import Operation
from sarah.operation.settings import Parameters

UNSMOOTHED: dict[str, Any] = dict(replay_buffer_class=RankReplayBuffer, elite_share=0.5, elite_draws=16)
"""Arguments that differ from the preset's: a robot in operation changes, and rewards from before say less of it."""
LONGEST = 1_000_000
"""Number of windows that no operation has."""


class AgentLearner:
    """LocalNAF with its preset for few steps, around the first parameters. A window is worth its own reward only.

    :param first: parameters to begin with
    :param seed: seed of the agent
    """

    def __init__(self, first: Parameters, seed: int) -> None:
        self._first = first
        self._seed = seed

    def operate(self, robot: Operation) -> Parameters:
        """Learn window by window; the agent leaves the robot with the best action that it knows."""
        env = SarahOperationEnv(robot.config, self._first, operated=robot)
        settings: dict[str, Any] = {**PRESETS["one-step"], **UNSMOOTHED, "device": "cpu"}
        model = LocalNAF("MlpPolicy", env, seed=self._seed, first_action_centre=True, **settings)
        model.learn(LONGEST, callback=_UntilOver(robot), log_interval=None)  # type: ignore[arg-type]
        assert isinstance(model.replay_buffer, RankReplayBuffer)
        if model.replay_buffer.size() == 0:  # the time was over before it could learn
            return self._first
        return env.parameters_from(model.replay_buffer.best_action())


class _UntilOver(BaseCallback):
    def __init__(self, robot: Operation) -> None:
        super().__init__()
        self._robot = robot

    def _on_step(self) -> bool:
        return not self._robot.is_over
