"""The robot of a session: windows that are known are not simulated again, and every new one is told."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from sarah.errors import ResumeError
from sarah.operation.robot_in_operation import RobotInOperation
from sarah.operation.settings import OperationConfig, Parameters
from sarah.operation.window import Window
from sarah.simulation.world import HoldsWorld


class WatchedRobot(HoldsWorld):
    """A robot in operation that remembers its windows.

    :param robot: robot, at the beginning of its operation
    :param known: first windows, from an earlier process
    :param watch: function that is called with every other window
    """

    def __init__(self, robot: RobotInOperation, known: Sequence[Window], watch: Callable[[Window], None]) -> None:
        self.windows: list[Window] = []
        """All windows so far, in order."""
        self.config: OperationConfig = robot.config
        self._robot = robot
        self._known = known
        self._watch = watch

    @property
    def is_over(self) -> bool:
        """Whether the operation's time is over."""
        return self._robot.is_over

    @property
    def windows_left(self) -> float:
        """Number of windows that the time of the present stage is enough for if the robot does not fall."""
        return self._robot.windows_left

    def run(self, parameters: Parameters) -> Window:
        """Run one window, unless it is known.

        :param parameters: P1 to P5 and V1 to V4
        :raises ResumeError: if the known window had others
        """
        if len(self.windows) < len(self._known):
            window = self._known[len(self.windows)]
            if window.parameters != parameters:
                raise ResumeError(
                    "the session cannot be resumed here: it does not repeat what it did before its interruption, as "
                    "the kind of processor differs, or something else that arithmetic depends on"
                )
            self._robot.skip(window)
            self.windows.append(window)
            return window
        window = self._robot.run(parameters)
        self.windows.append(window)
        self._watch(window)
        return window

    def close(self) -> None:
        """Give the physics engine's resources back."""
        self._robot.close()
