"""The learner's side: a robot that runs by itself, and is asked for one window after the other."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Protocol

from sarah.errors import ConfigurationError, RobotError
from sarah.operation.operated_robot import OperatedRobot
from sarah.operation.settings import BOX, OperationConfig, Parameters
from sarah.operation.window import Window
from sarah.recorded.journal import Journal
from sarah.remote.answers import Answer, Measured, Outcome
from sarah.remote.client import WAIT_SECONDS
from sarah.remote.requests import Request, WindowTimes

SLOWEST = 10.0
"""Times as long as a window lasts that a simulated robot may take for it."""
RETRY_SECONDS = 1.0
"""Time after which a lost window is asked for again, in s."""
GONE_SECONDS = 120.0
"""Default of the time after which a learner gives up a robot that has gone, in s."""
LOST = (Outcome.STOPPED, Outcome.ENDED, Outcome.BUSY)
"""What becomes of a window that has to be asked for again."""
GONE = (Outcome.ENDED, Outcome.BUSY)
"""Answers of a robot that its learner does not have."""


class Connection(Protocol):
    """A connection to a robot."""

    def window(self, request: Request, seconds: float) -> Iterator[Answer | Measured]:
        """Ask for a window, or for something that has answers alone."""

    def close(self) -> None:
        """Close it."""


class RemoteRobot(OperatedRobot):
    """A robot that measures windows of itself, and goes on without its learner.

    A window that is lost is asked for again: because the connection broke, because the robot's program ended, or
    because somebody stopped the robot.

    :param config: settings of the operation
    :param connect: function that opens a connection to the robot
    :param learner: name of the learner, by which the robot tells learners apart
    :param watch: function that is called with every window
    :param journal: journal of the windows, of which those that it knows are not asked for again
    :param gone_seconds: time after which a robot that has gone is given up, in s
    :param say: function that is called with what happens, in words
    :param pause: function that waits for some seconds; what it raises ends the wait for the robot
    """

    def __init__(
        self,
        config: OperationConfig,
        connect: Callable[[], Connection],
        learner: str,
        watch: Callable[[Window], None] | None = None,
        journal: Journal | None = None,
        gone_seconds: float = GONE_SECONDS,
        say: Callable[[str], None] = lambda words: None,
        pause: Callable[[float], None] = time.sleep,
    ) -> None:
        super().__init__(config, watch, journal)
        self._connect, self._learner = connect, learner
        self._gone_seconds, self._say, self._pause = gone_seconds, say, pause
        self._times = WindowTimes(config.settle_seconds, config.measure_seconds)
        self._connection: Connection | None = None
        self._gone_since: float | None = None
        self._said = ""

    def leave(self, parameters: Parameters) -> None:
        """Leave the robot with parameters. From then on others may push some.

        :param parameters: P1 to P5 and V1 to V4
        :raises RobotError: if it has gone
        :raises ConfigurationError: if it refuses them
        """
        self._patiently(Request("push", self._named(parameters), learner=self._learner))

    def close(self) -> None:
        """Close the connection; the robot goes on."""
        if self._connection is not None:
            self._connection.close()
            self._connection = None

    def _measured(self, parameters: Parameters) -> Window:
        request = Request("window", self._named(parameters), window=self._times, learner=self._learner)
        measured = self._patiently(request)
        assert isinstance(measured, Measured)
        if measured.reason:
            self._say(f"window {self.windows}: {measured.reason}")
        window = Window(
            index=self.windows,
            begin=self.seconds,
            seconds=measured.seconds,
            changes=0,
            parameters=parameters,
            score=measured.score,
            observed_reward=measured.observed_reward,
            fell=measured.fell,
            felt=tuple(measured.felt),
        )
        self._count(window)
        return window

    @staticmethod
    def _named(parameters: Parameters) -> dict[str, float]:
        return dict(zip(BOX.names, BOX.checked(parameters), strict=True))

    def _patiently(self, request: Request) -> Answer | Measured:
        """Ask, and again after what was lost, until the robot has been gone for too long.

        :raises RobotError: if it has, or another process asks for the same learner
        :raises ConfigurationError: if it refuses
        """
        self._gone_since = None
        while True:
            try:
                answer = self._asked(request)
            except RobotError as error:
                self.close()
                self._gone_since = self._gone_since or time.monotonic()
                reason = str(error)
            else:
                if isinstance(answer, Answer) and answer.outcome is Outcome.WAITING:
                    continue
                if isinstance(answer, Measured) or answer.outcome not in LOST:
                    break
                reason = f"{answer.outcome.value}: {answer.reason}"
            if self._gone_since is not None and time.monotonic() >= self._gone_since + self._gone_seconds:
                raise RobotError(f"{reason}; gave up after {self._gone_seconds:g} s")
            self._say_once(f"{reason}; asking again, for {self._gone_seconds:g} s")
            self._pause(RETRY_SECONDS)
        if isinstance(answer, Answer) and answer.outcome is Outcome.OVERTAKEN:
            raise RobotError("another process operates the robot for the same session, such as a copy of its folder")
        if isinstance(answer, Answer) and answer.outcome is Outcome.REFUSED:
            raise ConfigurationError(f"the robot refuses the parameters of window {self.windows}: {answer.reason}")
        self._said = ""
        return answer

    def _asked(self, request: Request) -> Answer | Measured:
        """What became of a request: the window, or an answer that says whether parameters are applied."""
        if self._connection is None:
            self._connection = self._connect()
        window_seconds = self._times.settle_seconds + self._times.measure_seconds
        for answer in self._connection.window(request, WAIT_SECONDS + SLOWEST * window_seconds):
            if isinstance(answer, Measured):
                return answer
            self._gone_since = (self._gone_since or time.monotonic()) if answer.outcome in GONE else None
            if answer.outcome is Outcome.APPLIED and self._said:
                self._say_once(f"the robot has the parameters of window {self.windows}")
            if answer.outcome is Outcome.WAITING:
                self._say_once(answer.reason)
                self._pause(0.0)
            if answer.is_final or request.window is None:
                return answer
        raise RobotError("the robot did not answer to the end")

    def _say_once(self, words: str) -> None:
        """Say what has not just been said."""
        if words != self._said:
            self._said = words
            self._say(words)
