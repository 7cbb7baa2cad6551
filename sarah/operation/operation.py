"""What a learner or an environment needs of a robot in operation."""

from __future__ import annotations

from typing import Protocol

from sarah.operation.settings import OperationConfig, Parameters
from sarah.operation.window import Window


class Operation(Protocol):
    """A robot in operation: :class:`~sarah.operation.robot_in_operation.RobotInOperation`, or one whose first windows
    are known.
    """

    config: OperationConfig

    @property
    def is_over(self) -> bool:
        """Whether the operation's time is over."""

    @property
    def windows_left(self) -> float:
        """Number of windows that the time of the present stage is enough for if the robot does not fall."""

    def run(self, parameters: Parameters) -> Window:
        """Run one window.

        :param parameters: P1 to P5 and V1 to V4
        """

    def close(self) -> None:
        """Give the physics engine's resources back."""
