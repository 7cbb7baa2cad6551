"""What every learner of a session is: something that chooses the parameters of the next window."""

from __future__ import annotations

from typing import Protocol

from sarah.operation.operation import Operation
from sarah.operation.settings import Parameters


class Learner(Protocol):
    """A learner. Of a window it may use what the robot itself knows: all but its score and the number of changes."""

    def operate(self, robot: Operation) -> Parameters:
        """Choose the parameters of one window after the other, until the operation is over.

        :param robot: robot to operate
        :return: parameters to leave the robot with
        """
