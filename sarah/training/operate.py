"""Sessions: a learner renews the parameters of a robot in operation, and a folder records every window."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

from sarah.episode.running_robot import Observer
from sarah.errors import ResumeError, TrainingInterruptedError, check_type
from sarah.operation.operated_robot import OperatedRobot
from sarah.operation.robot_in_operation import RobotInOperation
from sarah.operation.settings import PARAMETERS, Parameters
from sarah.operation.window import Window
from sarah.process import apart
from sarah.recognition.recognition import Recognition, read_recognition
from sarah.recorded.journal import Journal
from sarah.runs.event_file import EventFile
from sarah.runs.session import SessionSpec
from sarah.runs.session_folder import SessionFolder
from sarah.training.session_learners import learner_of

MakeRobot = Callable[..., OperatedRobot]
"""Function that makes a robot of what :class:`~sarah.operation.robot_in_operation.RobotInOperation` is made of."""


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
        """Mean score of the windows that ended within a span of time; of a robot without scores, the observed reward.

        :param begin: time of operation, in min
        :param end: time of operation, in min
        """
        scores = [window.worth for window in self.windows if 60.0 * begin < window.end <= 60.0 * end]
        return sum(scores) / len(scores) if scores else float("nan")


def run_session(
    spec: SessionSpec,
    watch: Callable[[Window], None] = lambda window: None,
    journal: Journal | None = None,
    observers: Sequence[Observer] = (),
    make_robot: MakeRobot = RobotInOperation,
    recognition: Recognition | None = None,
) -> SessionResult:
    """Operate a robot from standing to the end of the operation's time.

    :param spec: specification, which determines the result: the same one gives the same bytes in any process
    :param watch: function that is called with every window
    :param journal: journal of the session, whose windows are not simulated again; without one nothing is recorded
    :param observers: further records of what the robot does, in each window that is simulated
    :param make_robot: function that makes the robot; by default it is simulated
    :param recognition: recognition that the specification names, if it names one
    :return: the result
    :raises ResumeError: if the recognition is another one, or if the learner asks for other parameters than a window of
        the journal has
    """
    check_type("spec", spec, SessionSpec)
    if spec.recognition != ("" if recognition is None else recognition.identity):
        raise ResumeError(
            f"the session has recognition {spec.recognition or 'of the package'}, and another one is given"
        )
    windows: list[Window] = []
    with apart() as outside:

        def watch_outside(window: Window) -> None:
            windows.append(window)
            with outside():
                watch(window)

        robot = make_robot(spec.config, spec.seed, watch_outside, journal, observers)
        try:
            parameters = learner_of(spec.learner, recognition)(robot, spec.parameters, spec.seed)
            robot.leave(parameters)
        finally:
            robot.close()
    return SessionResult(tuple(windows), parameters)


def operate(
    folder: SessionFolder,
    spec: SessionSpec,
    watch: Callable[[Window], None] = lambda window: None,
    interrupted: Callable[[], bool] = lambda: False,
    observers: Sequence[Observer] = (),
    make_robot: MakeRobot = RobotInOperation,
) -> SessionResult:
    """Run a session, or go on with it, and write its folder.

    :param folder: folder of the session
    :param spec: specification of the session
    :param watch: function that is called with every window, also with those that are known
    :param interrupted: function that says after every window whether to stop
    :param observers: further records of what the robot does, in each window that is simulated
    :param make_robot: function that makes the robot; by default it is simulated
    :return: the result
    :raises ResumeError: if the folder was begun with another specification, code or versions, or is in use
    :raises TrainingInterruptedError: if ``interrupted`` asks to stop
    """
    with folder.journal_of(spec) as journal:
        events: EventFile | None = None

        def record(window: Window) -> None:
            nonlocal events
            if events is None:
                folder.remove_records()
                events = EventFile(folder.path)
            folder.append_window(window)
            _show(events, window)

        def add(window: Window) -> None:
            watch(window)
            journal.hold(partial(record, window))
            if interrupted():
                raise TrainingInterruptedError("the session was interrupted")

        try:
            recognition = read_recognition(folder.recognition_path) if spec.recognition else None
            result = run_session(spec, add, journal, observers, make_robot, recognition)
            journal.check_asked()
        finally:
            if events is not None:
                events.close()
        _draw(folder, spec, result)
        folder.write_parameters(result.parameters)
        return result


def compare_frozen(
    folder: SessionFolder,
    spec: SessionSpec,
    result: SessionResult,
    watch: Callable[[Window], None] = lambda window: None,
    interrupted: Callable[[], bool] = lambda: False,
) -> SessionResult:
    """Run a session without learning, or go on with it, in the folder of the one with it, whose picture shows both.

    :param folder: folder of the session with learning
    :param spec: specification of the session with learning
    :param result: result of the session with learning
    :param watch: function that is called with every window, also with those that are known
    :param interrupted: function that says after every new window whether to stop
    :return: the result without learning
    :raises ResumeError: if the session without learning was begun otherwise, or is in use
    :raises TrainingInterruptedError: if ``interrupted`` asks to stop
    """
    if folder.frozen is None:
        folder.add_frozen(spec)
    frozen = SessionFolder.open(folder.frozen_path)
    if frozen.spec() != spec.frozen():
        frozen.extend(spec.frozen())
    without = operate(frozen, spec.frozen(), watch, interrupted)
    _draw(folder, spec, result, without.windows)
    return without


def extend(folder: SessionFolder, minutes: float) -> SessionSpec:
    """Make a finished session one that goes on for longer.

    :param folder: folder of the session
    :param minutes: the longer duration, what is over included, in min
    :return: specification to go on with
    :raises ConfigurationError: if the duration is not allowed
    :raises ResumeError: if the session was begun with other code or versions, or is in use: nothing is changed then
    """
    before = folder.spec()
    extended = before.extended_to(minutes)
    with folder.journal_of(before):
        folder.extend(extended)
    return extended


def add_frozen(folder: SessionFolder) -> None:
    """Have a session compared with the same one without learning, from its next process on.

    :param folder: folder of the session
    :raises ResumeError: if the session was begun with other code or versions, or is in use: nothing is changed then
    """
    spec = folder.spec()
    with folder.journal_of(spec):
        folder.add_frozen(spec)


def _show(events: EventFile, window: Window) -> None:
    """Add a window to TensorBoard's curves, at its second of operation."""
    values = {f"parameters/{item.name}": value for item, value in zip(PARAMETERS, window.parameters, strict=True)}
    values |= {} if window.score is None else {"operation/score": window.score}
    values |= {"operation/observed_reward": window.observed_reward}
    values |= {"operation/fell": float(window.fell), "operation/changes": float(window.changes)}
    events.add_points(values, round(window.end))


def _draw(folder: SessionFolder, spec: SessionSpec, result: SessionResult, frozen: Sequence[Window] = ()) -> None:
    from sarah.pictures.session_figure import draw_session  # slow to import because of matplotlib

    draw_session(result.windows, spec.config.changes, folder.picture_path, frozen)
