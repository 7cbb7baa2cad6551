"""The recording of a robot that runs: everything that an episode's result says about it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sarah.control.pattern_generator import PhaseChange
from sarah.episode.gait import GaitRecord
from sarah.episode.motion import MotionRecord
from sarah.episode.result import EpisodeResult
from sarah.episode.running_robot import Observer, RunningRobot
from sarah.episode.trace import Trace
from sarah.robot.description import ANKLE_JOINTS
from sarah.robot.reading import Vector


@dataclass
class Return:
    """Reward integrated over time.

    :param ceiling: highest value that it can have at the end
    :param value: value so far
    """

    ceiling: float
    value: float = 0.0

    @property
    def score(self) -> float:
        """Value over its ceiling; what a fall cuts off counts as nothing."""
        return self.value / self.ceiling


class Recording(Observer):
    """Record of gait, motion and, if it is wanted, every control tick.

    :param robot: robot that :attr:`observers` are to observe
    :param begin: time of the first tick, in s
    :param returned: return, which its owner adds to
    :param record_trace: whether to record every control tick in a trace
    """

    def __init__(self, robot: RunningRobot, begin: float, returned: Return, record_trace: bool = True) -> None:
        physics = robot.config.physics
        self.gait = GaitRecord(physics.control_rate, robot.config.scale.time)
        self.start = robot.torso.position
        """Position of the torso's centre at the beginning, in m."""
        self._begin, self._dt = begin, physics.control_dt
        self._returned = returned
        self._motion = MotionRecord(physics.control_rate, robot.config.scale.time)
        self._rows: list[dict[str, Any]] | None = [] if record_trace else None

    @property
    def time(self) -> float:
        """Time at the end of the last tick, in s."""
        return self._begin + self.gait.ticks * self._dt

    @property
    def observers(self) -> tuple[Observer, ...]:
        """The records of gait and motion, and then this one."""
        return self.gait, self._motion, self

    def decided(self, robot: RunningRobot, change: PhaseChange | None, force: Vector | None) -> None:
        """Record a row of the trace."""
        if self._rows is not None:
            self._rows.append(self._row(robot, force))

    def _row(self, robot: RunningRobot, force: Vector | None) -> dict[str, Any]:
        """Row of a :class:`~sarah.episode.trace.Trace`."""
        generator, reading = robot.generator, robot.last_reading
        return {
            "time": self._begin + (self.gait.ticks - 1) * self._dt,
            "position": robot.torso.position,
            "orientation": robot.torso.orientation,
            "joints": robot.truth.joints,
            "ankles": robot.simulation.joint_positions(ANKLE_JOINTS),
            "targets": generator.targets,
            "pressures": reading.pressures,
            "acceleration": reading.acceleration,
            "angular_rate": reading.angular_rate,
            "phase": generator.phase.value,
            "stance": generator.stance.value,
            "stable_x": generator.stable_x,
            "tilt": generator.tilt,
            "rate": generator.rate,
            "steps_per_second": self.gait.steps_per_second(self.gait.ticks),  # as the tick's reward has it
            "push": force or (0.0, 0.0, 0.0),
            "score": self._returned.score,
        }

    def result(self, robot: RunningRobot, termination: str, before: float = 0.0) -> EpisodeResult:
        """Result of what was recorded.

        :param robot: robot that ran
        :param termination: way in which it ended
        :param before: time before the first tick that counts to the duration, in s
        :raises SimulationError: if there is nothing to trace
        """
        (x, y, z), (start_x, start_y, _) = robot.torso.position, self.start
        return EpisodeResult(
            termination=termination,
            final_position=(x - start_x, y - start_y, z),
            score=self._returned.score,
            episode_return=self._returned.value,
            trace=None if self._rows is None else Trace.of(self._rows),
            **vars(self.gait.metrics(before)),
            **vars(self._motion.metrics()),
        )
