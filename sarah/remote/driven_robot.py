"""A robot whose control loop runs in this process, asked as one that listens is."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator

from sarah.control.supervisor import Supervisor
from sarah.drivers.loop import ControlLoop, LoopTick
from sarah.errors import RobotError
from sarah.remote.answers import Answer, Measured, Message
from sarah.remote.requests import Request
from sarah.remote.slot import Asked, Slot


class DrivenRobot:
    """A control loop that is ticked while somebody waits for an answer, as one in lockstep is.

    :param loop: control loop of the robot, whose controller is supervised
    :param slot: slot for the parameters
    """

    def __init__(self, loop: ControlLoop, slot: Slot) -> None:
        self._loop, self._slot = loop, slot
        self._arrived: list[Asked] = []
        loop.observers = (*loop.observers, self._observe)

    def window(self, request: Request, seconds: float) -> Iterator[Answer | Measured]:
        """Ask the robot for something, and let it run until it has answered.

        :param request: what to ask
        :param seconds: time to wait, which is not needed here
        :return: answers as they come; the last one is the window, or is final
        :raises RobotError: if the robot ends before that
        """
        answers: deque[Message] = deque()
        self._arrived.append(Asked(request, answers.append))
        while True:
            if not self._loop.tick():
                raise RobotError(f"the robot ended: {self._loop.driver.ended}")
            while answers:
                answer = answers.popleft()
                assert isinstance(answer, (Answer, Measured))
                yield answer
                if isinstance(answer, Measured) or answer.is_final:
                    return

    def close(self) -> None:
        """Nothing is open here."""

    def _observe(self, tick: LoopTick) -> None:
        assert isinstance(tick.controller, Supervisor)
        arrived, self._arrived = self._arrived, []
        self._slot.tick(tick, tick.controller, arrived)
