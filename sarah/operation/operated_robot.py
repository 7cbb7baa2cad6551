"""What learners know of a robot in operation, simulated or not: windows, until its time is over."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable

from sarah.operation.settings import OperationConfig, Parameters
from sarah.operation.window import Window
from sarah.recorded.journal import Journal


class OperatedRobot(ABC):
    """A robot whose parameters may change between windows.

    :param config: settings of the operation
    :param watch: function that is called with every window
    :param journal: journal of the windows, of which those that it knows are not run again
    """

    def __init__(
        self,
        config: OperationConfig,
        watch: Callable[[Window], None] | None = None,
        journal: Journal | None = None,
    ) -> None:
        self.config = config
        self.seconds = 0.0
        """Time of operation so far, in s."""
        self.windows = 0
        """Number of windows so far."""
        self._watch = watch
        self._journal = journal
        self._stages_over = 0

    @property
    def is_over(self) -> bool:
        """Whether the operation's time is over."""
        return self.config.stages_over(self.seconds) == len(self.config.stages)

    @property
    def windows_left(self) -> float:
        """Number of windows that the time of the present stage is enough for if the robot does not fall."""
        stages = self.config.stages
        minutes = stages[min(self.config.stages_over(self.seconds), len(stages) - 1)]
        seconds = self.config.settle_seconds + self.config.measure_seconds
        return max(0.0, 60.0 * minutes - self.seconds) / seconds

    def run(self, parameters: Parameters) -> Window:
        """Run one window, from where the robot is now.

        :param parameters: P1 to P5 and V1 to V4
        :raises ConfigurationError: if a parameter is not within its box
        :raises ResumeError: if the window that the journal knows had others
        """
        window = self._measured(parameters) if self._journal is None else self._recorded(self._journal, parameters)
        if self._watch is not None:
            self._watch(window)
        return window

    def skip(self, window: Window) -> None:
        """Go on as after a window that is known.

        :param window: result of the next window
        """
        self._count(window)

    def leave(self, parameters: Parameters) -> None:  # noqa: B027  # a simulated robot ends with its operation
        """Leave the robot with parameters, for a robot that goes on after its operation; here nothing happens.

        :param parameters: P1 to P5 and V1 to V4
        """

    def close(self) -> None:  # noqa: B027  # not every robot has some
        """Give resources back; here there are none."""

    @abstractmethod
    def _measured(self, parameters: Parameters) -> Window:
        """Run one window that is not known, and count it."""

    def _count(self, window: Window) -> None:
        self.windows += 1
        self.seconds = window.end

    def _recorded(self, journal: Journal, parameters: Parameters) -> Window:
        while self._stages_over < self.config.stages_over(self.seconds):
            journal.extend(self.windows + self._stages_over, self.config.stages[self._stages_over + 1])
            self._stages_over += 1
        request = {"index": self.windows + self._stages_over, "parameters": list(parameters)}
        window = journal.known(request, Window.of_plain)
        if window is not None:
            self.skip(window)
            return window
        window = self._measured(parameters)
        journal.add(request, window.plain())
        return window
