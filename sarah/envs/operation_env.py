"""The gymnasium environment of a robot in operation: a window is one step of the agent."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np

from sarah.envs.sarah_env import checked_action, checked_render_mode, draw_seed
from sarah.episode.from_mapping import from_mapping
from sarah.errors import ConfigurationError, check_range, shortened
from sarah.operation.operated_robot import OperatedRobot
from sarah.operation.robot_in_operation import RobotInOperation
from sarah.operation.settings import (
    BOX,
    PARAMETERS,
    SHIPPED,
    OperationConfig,
    Parameters,
    check_effect,
)
from sarah.operation.window import FELT, LARGEST, Window, observation_from


class SarahOperationEnv(gymnasium.Env[np.ndarray, np.ndarray]):
    """An environment in which a robot runs on, and an agent chooses the parameters of one window after the other.

    The observation is what the robot felt in the last window, :data:`~sarah.operation.window.FELT`, each scaled to
    order 1 and clipped to [-5, 5], and its present parameters, scaled to [-1, 1]. The action is the next parameters:
    P1 to P5 and V1 to V4, with ``reach`` of each range on either side of ``first`` scaled to [-1, 1]. The reward is
    what the robot's own sensors say, :attr:`~sarah.operation.window.Window.observed_reward`. A fall terminates; the end
    of the operation's time truncates. ``info`` contains the ``window``. There are no pictures: ``sarah-view`` plays
    sessions.

    :param config: settings of the operation
    :param first: parameters to begin with; by default those that the package ships
    :param reach: half-width of the action's box, as a share of each range; what lies outside the range comes to its end
    :param operated: robot to operate, instead of one that the settings describe
    :param render_mode: ``None``: there are no pictures
    :param settings: settings to change, by name: ``minutes=5``, ``robot={"engine": "mujoco"}``
    :raises ConfigurationError: naming the setting and its nearest valid name, if one is not allowed
    """

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(
        self,
        config: OperationConfig | None = None,
        first: Sequence[float] = SHIPPED,
        reach: float = 0.25,
        operated: OperatedRobot | None = None,
        render_mode: str | None = None,
        **settings: Any,
    ) -> None:
        config = OperationConfig() if config is None else config
        if not isinstance(config, OperationConfig):
            raise ConfigurationError(f"config must be an OperationConfig, not {shortened(config)}")
        if operated is not None and not callable(getattr(operated, "run", None)):
            raise ConfigurationError(f"operated must be a robot in operation, not {shortened(operated)}")
        check_effect(settings.get("robot"))
        self.config = from_mapping(config, settings)
        self.first = BOX.checked(first)
        self.render_mode = checked_render_mode(render_mode, self.metadata["render_modes"])
        self._reach = float(check_range("reach", reach, 0.0, 1.0))
        size = len(FELT) + len(PARAMETERS)
        self.observation_space = gymnasium.spaces.Box(-LARGEST, LARGEST, (size,), np.float32)
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (len(PARAMETERS),), np.float32)
        self._given = operated
        self._robot: OperatedRobot | None = None
        self._last: Window | None = None
        self._is_done = False

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Put the robot up, and run a window with the parameters :attr:`first`.

        Without a seed, a robot that has fallen goes on with its operation; otherwise another operation begins.

        :param seed: seed of the generator that draws the seeds of operations
        :param options: options of gymnasium, which are ignored
        """
        super().reset(seed=seed)
        goes_on = seed is None and self._last is not None and self._last.fell and self._is_done
        if self._robot is None or self._robot.is_over or not goes_on:
            self.close()
            drawn = draw_seed(self.np_random)
            self._robot = self._given or RobotInOperation(self.config, drawn)
        if self._last is None or not self._robot.is_over:  # a given robot's time may be over for good
            self._last = self._robot.run(self.first)
        self._is_done = False
        return self._observe(self._last), {"window": self._last}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Run a window.

        :param action: next parameters, scaled to [-1, 1]
        :raises ConfigurationError: if the action is not finite or out of its box, or if the episode is over
        """
        if self._robot is None or self._last is None or self._is_done:
            raise ConfigurationError("the episode is over: call reset before step")
        parameters = self.parameters_from(action)
        if self._robot.is_over:  # the window of reset took the rest of the time: there is nothing left to do
            self._is_done = True
            return self._observe(self._last), 0.0, False, True, {"window": self._last}
        window = self._last = self._robot.run(parameters)
        is_over = self._robot.is_over and not window.fell
        self._is_done = window.fell or is_over
        return self._observe(window), window.observed_reward, window.fell, is_over, {"window": window}

    def parameters_from(self, action: np.ndarray) -> Parameters:
        """Parameters that an action stands for.

        :param action: one number in [-1, 1] for each parameter
        :raises ConfigurationError: if the action is not finite or out of its box
        """
        return BOX.at_shares(BOX.shares(self.first) + self._reach * checked_action(action, len(PARAMETERS)))

    def __copy__(self) -> SarahOperationEnv:
        """Copy with a robot of its own, as one that both had would run the windows of both."""
        return copy.deepcopy(self)

    def close(self) -> None:
        """Give the physics engine's resources back."""
        if self._robot is not None and self._given is None:
            self._robot.close()
        self._robot = None

    def _observe(self, window: Window) -> np.ndarray:
        shares = np.array(BOX.shares(window.parameters), np.float32)
        return np.concatenate([observation_from(window.felt, self.config.robot.scale), 2.0 * shares - 1.0])
