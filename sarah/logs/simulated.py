"""Logs of simulated robots: of an episode, and of a robot in operation."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from pathlib import Path

from sarah.control.hip_law import LOCKED_HIPS
from sarah.control.pattern_generator import Phase, PhaseChange
from sarah.control.supervisor import State, Supervisor
from sarah.episode.ending import ending_words
from sarah.episode.episode import Episode
from sarah.episode.result import EpisodeResult
from sarah.episode.robot_settings import RobotSettings
from sarah.episode.running_robot import Observer, RunningRobot
from sarah.episode.spec import EpisodeSpec
from sarah.episode.task_answers import controller_of
from sarah.errors import ConfigurationError
from sarah.logs.robot_log import RobotLog
from sarah.operation.settings import PARAMETERS
from sarah.operation.window import Window
from sarah.robot.reading import Vector
from sarah.versions import SIMULATING, versions

REASONS = {"standing": "put up", "stepping": "stood for a second", "fallen": "lay down"}
"""Reasons for the states of a simulated robot, which has no supervisor."""


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
        self._state, self._stood = "", 0.0
        self._parameters: Mapping[str, float] = {}

    @property
    def seconds(self) -> float:
        """Time of the next tick, in s."""
        return round(self._begin + self._ticks * self._dt, 9)

    def decided(self, robot: RunningRobot, change: PhaseChange | None, force: Vector | None) -> None:
        """Log the tick, and the changes of phase and state in it."""
        generator, self._dt = robot.generator, robot.config.physics.control_dt
        seconds = self.seconds
        state = "standing" if generator.phase is Phase.STAND else "stepping"
        if generator.phase is Phase.STAND:
            self._stood = seconds + self._dt
        if isinstance(generator, Supervisor):
            self._follow(generator, seconds)
        else:
            self._enter("fallen" if generator.has_fallen else state)
        if change is not None:
            self._log.phase_change(seconds, change, generator.stance)
        self._log.tick(
            seconds=seconds,
            reading=robot.last_reading,
            reading_seconds=seconds,
            targets=generator.targets,
            state=self._state,
            phase=generator.phase,
            stance=generator.stance,
            tilt=generator.tilt,
            rate=generator.rate,
            late_seconds=0.0,
        )
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
            self._enter("fallen", "fell")
        self._log.window(window.end, window.plain())
        self._begin, self._ticks = window.end, 0

    def end(self, termination: str) -> None:
        """Log the end of an episode.

        :param termination: way in which it ended
        """
        self._enter("ended", ending_words(termination))

    def _follow(self, supervisor: Supervisor, seconds: float) -> None:
        """Log what a supervisor did."""
        if not self._state:
            self._enter(State.STANDING.value)
        if supervisor.state_change is not None:
            state, before, reason = supervisor.state_change
            self._log.state(seconds, state.value, before.value, reason)
        self._state = supervisor.state.value

    def _enter(self, state: str, reason: str = "") -> None:
        if state != self._state:
            self._log.state(self.seconds, state, self._state, reason or REASONS[state])
            self._state = state


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
