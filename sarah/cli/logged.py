"""Sessions whose robot is logged."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from sarah.logs.robot_log import RobotLog
from sarah.logs.simulated import SimulationLog, about_robot, check_written
from sarah.operation.window import Window
from sarah.recognition.logs import facts_of
from sarah.runs.session import SessionSpec
from sarah.training.operate import SessionResult

Watch = Callable[[Window], None]
Interrupted = Callable[[], bool]


def logged(
    run: Callable[..., SessionResult], path: Path, spec: SessionSpec, program: str
) -> Callable[[Watch, Interrupted], SessionResult]:
    """Function that runs a session as another one does, and logs its robot.

    :param run: function that runs it, as :func:`sarah.training.operate.operate` does from its third argument on
    :param path: path of the log, which must be new
    :param spec: specification of the session
    :param program: name of the program that runs it
    """

    def run_logged(watch: Watch, interrupted: Interrupted) -> SessionResult:
        about = about_robot(spec.config.robot, program, learner=spec.learner, **facts_of(spec.config, spec.seed))
        with RobotLog(path, about, waits=True) as log:
            observer = SimulationLog(log, spec.learner)

            def watch_both(window: Window) -> None:
                observer.window(window)
                watch(window)

            result = run(watch_both, interrupted, [observer])
        check_written(log, path)
        return result

    return run_logged
