"""The robot that goes on: windows with changing parameters, in one world from each standing up to the next fall."""

from __future__ import annotations

import dataclasses
import random
from collections.abc import Callable
from functools import partial
from typing import Any

from sarah.control.pattern_generator import STAND_SECONDS
from sarah.episode.ending import LEAST_UPRIGHT
from sarah.episode.push import Push, draw_push
from sarah.episode.result import EpisodeResult
from sarah.episode.running_robot import RunningRobot, conditions_of
from sarah.operation.recording import Recording
from sarah.operation.settings import OperationConfig, Parameters, checked_parameters, controller_parameters
from sarah.operation.window import Window, WindowRecord
from sarah.robot.reading import Vector
from sarah.simulation.simulator import TorsoState

MOST_PUSHES = 2**20
"""Number of pushes of an operation after which those of the next seed would come."""


class RobotInOperation:
    """A robot whose parameters may change between windows. What it does follows from settings, seed and parameters.

    It is the same robot all the time: its masses, friction and sensor errors are drawn once. Its sensor noise is new
    each time that it is put up.

    :param config: settings of the operation
    :param seed: seed of robot, world, noise and pushes
    """

    def __init__(self, config: OperationConfig, seed: int) -> None:
        self.config = config
        self.seconds = 0.0
        """Time of operation so far, in s."""
        self.windows = 0
        """Number of windows so far."""
        self._seed = seed
        self._robot: RunningRobot | None = None
        self._changes = 0
        self._stands = 0
        self._since_standing: list[Window] = []

    def __getstate__(self) -> dict[str, Any]:
        """State of a copy, whose robot runs the windows since it stood up again before its next one."""
        return {**vars(self), "_robot": None, "_since_standing": list(self._since_standing)}

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

    def run(self, parameters: Parameters, recording: Recording | None = None) -> Window:
        """Run one window, from where the robot is now.

        :param parameters: P1 to P5 and V1 to V4
        :param recording: recording of every tick, if it is wanted
        :raises ConfigurationError: if a parameter is not within its box
        """
        parameters = checked_parameters(parameters)
        self._make_changes()
        if self._robot is None:
            self._robot = self._standing()
            for before in self._since_standing:  # known windows, which led to where the robot is now
                self._run(self._robot, before.parameters, before.begin, before is self._since_standing[0])
        window = self._run(self._robot, parameters, self.seconds, not self._since_standing, recording)
        self._count(window)
        return window

    def replay(self, window: Window) -> EpisodeResult:
        """Run one window again that is known, and record it.

        :param window: next window
        :return: it as the result of an episode, with a trace
        """
        changes = self.config.changes_by(self.seconds)
        recording = Recording(self.config.robot_after(changes))
        return recording.result(self.run(window.parameters, recording))

    def skip(self, window: Window) -> None:
        """Go on as after a window that is known.

        :param window: result of the next window
        """
        self._make_changes()
        self.close()  # its next window begins where this one ended: those since it stood up are run again
        self._count(window)

    def close(self) -> None:
        """Give the physics engine's resources back."""
        if self._robot is not None:
            self._robot.close()
            self._robot = None

    def _make_changes(self) -> None:
        """Put the robot up anew if something about it is different from now on."""
        changes = self.config.changes_by(self.seconds)
        if changes != self._changes:
            self._changes = changes
            self._put_up()

    def _put_up(self) -> None:
        self.close()
        self._stands += 1
        self._since_standing = []

    def _count(self, window: Window) -> None:
        self.windows += 1
        self.seconds = window.end
        self._since_standing.append(window)
        if window.fell:
            self._put_up()

    def _standing(self) -> RunningRobot:
        config = self.config.robot_after(self._changes)
        conditions = conditions_of(config, self._seed)
        noise = random.Random(f"noise {self._seed} {self._stands}").getrandbits(64)
        conditions = dataclasses.replace(conditions, sensors=dataclasses.replace(conditions.sensors, seed=noise))
        robot = RunningRobot(config, self._seed, conditions=conditions)
        robot.stand()
        return robot

    def _run(
        self,
        robot: RunningRobot,
        parameters: Parameters,
        begin: float,
        stands: bool,
        recording: Recording | None = None,
    ) -> Window:
        dt = robot.config.physics.control_dt
        settle, measure = round(self.config.settle_seconds / dt), round(self.config.measure_seconds / dt)
        push = self.config.robot_after(self._changes).push
        stood = STAND_SECONDS if stands else 0.0
        first = round((begin + stood) / dt)
        record = WindowRecord(robot.robot.standing_height, robot.config, settle, measure)
        robot.generator.set_parameters(*controller_parameters(parameters))
        ticks, fell = 0, False
        while ticks < settle + measure and not fell:
            force = self._force(push, first + ticks, dt)
            tell = None if recording is None else partial(recording.tick, robot, record, (first + ticks) * dt, force)
            fell = self._tick(robot, record, force, tell)
            ticks += 1
        seconds = stood + ticks * dt + (self.config.fall_seconds if fell else 0.0)
        return Window(
            index=self.windows,
            begin=begin,
            seconds=round(seconds, 9),
            changes=self._changes,
            parameters=parameters,
            score=record.score,
            observed_reward=record.observed_reward,
            fell=fell,
            felt=record.felt(),
        )

    def _tick(
        self, robot: RunningRobot, record: WindowRecord, force: Vector | None, tell: Callable[[], None] | None
    ) -> bool:
        """Advance by one control tick, and return whether the robot has fallen.

        :param robot: robot that runs
        :param record: record of the window
        :param force: force of a push in this tick, in N
        :param tell: function that is called once the targets are set
        """
        simulation, generator = robot.simulation, robot.generator
        before = generator.targets
        reading = robot.sense()
        if robot.termination is not None:
            return True
        record.sense(reading, before)
        change = generator.tick(reading)
        if change is not None:
            record.phase_change(change)
        simulation.set_targets(generator.targets)
        if force is not None:
            simulation.push(force)
        if tell is not None:
            tell()
        simulation.advance()
        torso = simulation.torso_state()
        if not torso.is_finite:
            return True
        record.judge(torso)
        return generator.has_fallen or is_down(torso, robot.vertical)

    def _force(self, push: Push, tick: int, dt: float) -> Vector | None:
        """Force of the push during a tick, in N, if there is one then.

        :param push: ranges of the pushes
        :param tick: number of the tick since the operation began
        :param dt: control period, in s
        """
        number, since = divmod(tick, round(self.config.push_seconds / dt))
        if number == 0 or since * dt > push.duration - dt / 2 or push.newtons == (0.0, 0.0):
            return None
        return draw_push(push, self._seed * MOST_PUSHES + number).force


def is_down(torso: TorsoState, vertical: Vector) -> bool:
    """Whether a robot has fallen, by the angle between its axis and gravity's vertical.

    :param torso: true state of the torso
    :param vertical: unit vector against gravity, in the world's frame
    """
    return sum(a * b for a, b in zip(torso.axis, vertical, strict=True)) < LEAST_UPRIGHT
