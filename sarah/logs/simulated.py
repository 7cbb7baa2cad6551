"""Logs of simulated robots: of an episode, and of a robot in operation."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from pathlib import Path

from sarah.control.hip_law import LOCKED_HIPS
from sarah.control.pattern_generator import Phase, PhaseChange
from sarah.episode.ending import ending_words
from sarah.episode.episode import Episode
from sarah.episode.result import EpisodeResult
from sarah.episode.robot_settings import RobotSettings
from sarah.episode.running_robot import Observer, RunningRobot
from sarah.episode.spec import EpisodeSpec
from sarah.episode.task_answers import controller_of
from sarah.errors import ConfigurationError
from sarah.logs.controller_log import ControllerLog
from sarah.logs.robot_log import RobotLog
from sarah.operation.settings import PARAMETERS
from sarah.operation.window import Window
from sarah.robot.reading import Vector
from sarah.versions import SIMULATING, versions


def about_robot(config: RobotSettings, program: str, **facts: str) -> dict[str, str]:
    """Facts about a run, for its log.

    :param config: settings of robot, world and controller
    :param program: name of the program that writes the log
    :param facts: further facts, by name
    """
    texts = {"dimensions": dict(config.dimensions), "controller": dataclasses.asdict(config.controller)}
    texts |= {"versions": versions(SIMULATING)}
    described = {name: json.dumps(value) for name, value in texts.items()}
    return {"program": program, "engine": config.engine, "dt": repr(config.physics.control_dt), **described, **facts}


class SimulationLog(Observer):
    """Observer that logs what a simulated robot does.

    :param log: log, whose run begins with the robot's first tick
    :param by: name of who gives the robot its parameters
    """

    def __init__(self, log: RobotLog, by: str) -> None:
        self._log, self._by = log, by
        self._begin, self._ticks, self._dt = 0.0, 0, 0.0
        self._stood = 0.0
        self._controller_log = ControllerLog(log)
        self._parameters: Mapping[str, float] = {}

    @property
    def seconds(self) -> float:
        """Time of the next tick, in s."""
        return round(self._begin + self._ticks * self._dt, 9)

    def decided(self, robot: RunningRobot, change: PhaseChange | None, force: Vector | None) -> None:
        """Log the tick, and the changes of phase and state in it."""
        self._dt, seconds = robot.config.physics.control_dt, self.seconds
        if robot.generator.phase is Phase.STAND:
            self._stood = seconds + self._dt
        self._controller_log.tick(seconds, robot.generator, change, robot.last_reading, seconds)
        self._ticks += 1

    def asked(self, seconds: float, values: Mapping[str, float]) -> None:
        """Log parameters, unless the robot has them already. They are applied when it has stood.

        :param seconds: time at which they were asked for, in s
        :param values: their values by name
        """
        if values != self._parameters:
            self._parameters = values
            self._log.parameters(round(max(seconds, self._stood), 9), values, seconds, self._by, True, "")

    def window(self, window: Window) -> None:
        """Log a window that is over.

        :param window: result of the window; the next one begins at its end
        """
        named = zip(PARAMETERS, window.parameters, strict=True)
        self.asked(window.begin, {parameter.name: value for parameter, value in named})
        if window.fell:
            self._controller_log.enter(self.seconds, "fallen", "fell")
        self._log.window(window.end, window.plain())
        self._begin, self._ticks = window.end, 0

    def end(self, termination: str) -> None:
        """Log the end of an episode.

        :param termination: way in which it ended
        """
        self._controller_log.enter(self.seconds, "ended", ending_words(termination))


def log_episode(spec: EpisodeSpec, path: Path, program: str) -> EpisodeResult:
    """Simulate an episode, and log it from the beginning of its standing.

    :param spec: specification of the episode
    :param path: path of the log, which must be new
    :param program: name of the program that does it
    :return: the result, as :func:`~sarah.episode.episode.simulate` has it
    :raises ConfigurationError: if the log cannot be written
    """
    about = about_robot(spec.config, program, task=spec.task.reference, seed=str(spec.seed))
    with RobotLog(path, about, waits=True) as log, Episode.of(spec) as episode:
        observer = SimulationLog(log, program)
        episode.robot.observers = (observer,)
        episode.stand()
        episode.robot.observers = (*episode.robot.observers, observer)
        stepping, balance = controller_of(spec.task, spec.parameters, spec.config)
        observer.asked(0.0, {**vars(stepping), **vars(balance or LOCKED_HIPS)})
        result = episode.run(spec.parameters)
        observer.end(result.termination)
    check_written(log, path)
    return result


def check_written(log: RobotLog, path: Path) -> None:
    """Refuse a log that is not complete.

    :param log: log that has been closed
    :param path: its path
    :raises ConfigurationError: if it could not be written
    """
    if log.failure is not None:
        raise ConfigurationError(f"cannot write {path} to its end: {log.failure}")
