"""A session: its specification determines its windows, byte for byte, as a whole."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

from sarah.episode.from_mapping import convert_fields
from sarah.errors import ConfigurationError, check_type, check_whole, unknown_name
from sarah.operation.robot_in_operation import RobotInOperation
from sarah.operation.settings import BOX, SHIPPED, OperationConfig, Parameters
from sarah.operation.window import Window
from sarah.process import apart
from sarah.sessions.watched import WatchedRobot
from sarah.training.session_learners import LEARNERS

LARGEST_SEED = 2**31 - 1
FORMER_LEARNERS = {"gp": "careful"}
"""Names of learners by their former ones, which are read for one release more."""


@dataclass(frozen=True)
class SessionSpec:
    """The specification of a session: everything that its result depends on.

    :param parameters: P1 to P5 and V1 to V4 that the robot begins with
    :param learner: name of the learner, one of :data:`~sarah.training.session_learners.LEARNERS`
    :param seed: seed of robot, world, noise, pushes and learner; a whole number, not negative
    :param config: settings of the operation
    :raises ConfigurationError: naming what is not allowed
    """

    parameters: Parameters = SHIPPED
    learner: str = "careful"
    seed: int = 0
    config: OperationConfig = field(default_factory=OperationConfig)

    def __post_init__(self) -> None:
        """Convert values to their types, and refuse invalid specifications."""
        convert_fields(self)
        BOX.checked(self.parameters)
        object.__setattr__(self, "learner", FORMER_LEARNERS.get(self.learner, self.learner))
        if self.learner not in LEARNERS:
            raise ConfigurationError(unknown_name("learner", str(self.learner), LEARNERS))
        object.__setattr__(self, "seed", check_whole("seed", self.seed, 0, LARGEST_SEED))

    def extended_to(self, minutes: float) -> SessionSpec:
        """The session with a longer duration: it goes on from where it ended.

        :param minutes: the longer duration, what is over included, in min
        """
        return replace(self, config=self.config.extended_to(minutes))

    def frozen(self) -> SessionSpec:
        """The same robot in the same world, with the parameters of the beginning all along."""
        return replace(self, learner="none")


@dataclass(frozen=True)
class SessionResult:
    """The result of a session.

    :param windows: all windows, in order
    :param parameters: parameters that the learner leaves the robot with
    """

    windows: tuple[Window, ...]
    parameters: Parameters

    @property
    def falls(self) -> int:
        """Number of falls."""
        return sum(window.fell for window in self.windows)

    def mean_score(self, begin: float = 0.0, end: float = float("inf")) -> float:
        """Mean score of the windows that ended within a span of time.

        :param begin: time of operation, in min
        :param end: time of operation, in min
        """
        scores = [window.score for window in self.windows if 60.0 * begin < window.end <= 60.0 * end]
        return sum(scores) / len(scores) if scores else float("nan")


def run_session(
    spec: SessionSpec,
    known: tuple[Window, ...] = (),
    watch: Callable[[Window], None] = lambda window: None,
) -> SessionResult:
    """Operate a robot from standing to the end of the operation's time.

    :param spec: specification, which determines the result: the same one gives the same bytes in any process
    :param known: first windows of this session, from an earlier process, which are not simulated again
    :param watch: function that is called with every window that is new
    :return: the result
    :raises ResumeError: if the learner asks for other parameters than a known window has
    """
    check_type("spec", spec, SessionSpec)
    with apart() as outside:

        def watch_outside(window: Window) -> None:
            with outside():
                watch(window)

        robot = WatchedRobot(RobotInOperation(spec.config, spec.seed), known, watch_outside)
        try:
            parameters = LEARNERS[spec.learner](robot, spec.parameters, spec.seed)
        finally:
            robot.close()
    return SessionResult(tuple(robot.windows), parameters)
