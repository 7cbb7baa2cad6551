"""An operation with a folder: every window is recorded, and a session that was interrupted or is extended goes on."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from sarah.errors import TrainingInterruptedError
from sarah.operation.settings import PARAMETERS
from sarah.operation.window import Window
from sarah.runs.event_file import EventFile
from sarah.sessions.journal import SessionJournal
from sarah.sessions.session import SessionResult, SessionSpec, run_session
from sarah.sessions.session_folder import SessionFolder


def operate(
    folder: SessionFolder,
    spec: SessionSpec,
    watch: Callable[[Window], None] = lambda window: None,
    interrupted: Callable[[], bool] = lambda: False,
) -> SessionResult:
    """Run a session, or go on with it, and write its folder.

    :param folder: folder of the session
    :param spec: specification of the session
    :param watch: function that is called with every window, also with those that are known
    :param interrupted: function that says after every new window whether to stop
    :return: the result
    :raises ResumeError: if the folder was begun with another specification, code or versions, or is in use
    :raises TrainingInterruptedError: if ``interrupted`` asks to stop
    """
    with SessionJournal(folder.journal_path, spec) as journal:
        folder.remove_events()
        events = EventFile(folder.path)
        folder.write_windows(journal.known)
        for window in journal.known:
            _show(events, window)
            watch(window)

        def add(window: Window) -> None:
            journal.add(window)
            folder.append_window(window)
            _show(events, window)
            watch(window)
            if interrupted():
                raise TrainingInterruptedError("the session was interrupted")

        try:
            result = run_session(spec, journal.known, add)
        finally:
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
    with SessionJournal(folder.journal_path, before):
        folder.extend(extended)
    return extended


def add_frozen(folder: SessionFolder) -> None:
    """Have a session compared with the same one without learning, from its next process on.

    :param folder: folder of the session
    :raises ResumeError: if the session was begun with other code or versions, or is in use: nothing is changed then
    """
    spec = folder.spec()
    with SessionJournal(folder.journal_path, spec):
        folder.add_frozen(spec)


def _show(events: EventFile, window: Window) -> None:
    """Add a window to TensorBoard's curves, at its second of operation."""
    values = {f"parameters/{item.name}": value for item, value in zip(PARAMETERS, window.parameters, strict=True)}
    values |= {"operation/score": window.score, "operation/observed_reward": window.observed_reward}
    values |= {"operation/fell": float(window.fell), "operation/changes": float(window.changes)}
    events.add_points(values, round(window.end))


def _draw(folder: SessionFolder, spec: SessionSpec, result: SessionResult, frozen: Sequence[Window] = ()) -> None:
    from sarah.pictures.session_figure import draw_session  # slow to import because of matplotlib

    draw_session(result.windows, spec.config.changes, folder.picture_path, frozen)
