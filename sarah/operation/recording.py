"""The recording of a window, tick by tick, as an episode has it: for the viewer."""

from __future__ import annotations

from typing import Any

from sarah.control.pattern_generator import Phase
from sarah.episode.motion import MotionRecord
from sarah.episode.result import EpisodeResult
from sarah.episode.running_robot import RunningRobot
from sarah.episode.settings import EpisodeConfig
from sarah.episode.trace import Trace
from sarah.operation.window import Window, WindowRecord
from sarah.robot.reading import Vector


class Recording:
    """Everything that an episode records and a window does not: trace, clearance, vibration and effort.

    :param robot: settings of the robot
    """

    def __init__(self, robot: EpisodeConfig) -> None:
        self._motion = MotionRecord(robot.physics.control_rate, robot.scale.time)
        self._dt = robot.physics.control_dt
        self._rows: list[dict[str, Any]] = []
        self._record: WindowRecord

    def tick(self, robot: RunningRobot, record: WindowRecord, time: float, force: Vector | None) -> None:
        """Record a tick, in which the targets are set.

        :param robot: robot that runs
        :param record: record of the window
        :param time: time of operation, in s
        :param force: force of a push, in N
        """
        simulation, generator = robot.simulation, robot.generator
        self._motion.tick(robot.truth.acceleration, *simulation.actuator_motion())
        if generator.phase in (Phase.LIFT, Phase.LAND):
            record.gait.swing(simulation.sole_height(generator.swing))
        frequency = record.gait.steps_per_second(len(self._rows) + 1)  # as an episode's trace has it
        self._rows.append(robot.trace_row(time, force, frequency, record.score))
        self._record = record

    def result(self, window: Window) -> EpisodeResult:
        """The window as the result of an episode.

        :param window: window that was recorded
        :raises SimulationError: if it had no tick
        """
        trace = Trace.of(self._rows)
        x, y, z = (trace.position[-1] - (*trace.position[0][:2], 0.0)).tolist()
        seconds, metrics = round(len(trace) * self._dt, 9), self._record.gait.metrics()
        return EpisodeResult(
            termination="fell" if window.fell else "time_limit",
            final_position=(x, y, z),
            score=window.score,
            steps_per_second=metrics["steps"] / seconds,
            episode_return=self._record.window_return,
            duration=seconds,
            trace=trace,
            **metrics,
            **self._motion.metrics(),
        )
