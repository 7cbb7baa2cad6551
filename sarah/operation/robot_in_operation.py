"""The robot that goes on: windows with changing parameters, in one world from each standing up to the next fall."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from sarah.control.pattern_generator import STAND_SECONDS
from sarah.control.supervisor import Supervisor
from sarah.episode.ending import is_fallen
from sarah.episode.push import Push, draw_push
from sarah.episode.recording import Recording
from sarah.episode.result import EpisodeResult
from sarah.episode.robot_settings import conditions_put_up
from sarah.episode.running_robot import Observer, RunningRobot
from sarah.operation.operated_robot import OperatedRobot
from sarah.operation.settings import BOX, OperationConfig, Parameters, controller_parameters
from sarah.operation.window import Window
from sarah.operation.window_record import WindowRecord
from sarah.recorded.journal import Journal
from sarah.robot.reading import Vector

MOST_PUSHES = 2**20
"""Number of pushes of an operation after which those of the next seed would come."""


class RobotInOperation(OperatedRobot):
    """A simulated robot in operation. What it does follows from settings, seed and parameters.

    It is the same robot all the time: its masses, friction and sensor errors are drawn once. Its sensor noise is new
    each time that it is set upright.

    :param config: settings of the operation
    :param seed: seed of robot, world, noise and pushes
    :param watch: function that is called with every window
    :param journal: journal of the windows, of which those that it knows are not simulated again
    :param observers: further records of what the robot does, in each window that is not known, with standing before it
    """

    def __init__(
        self,
        config: OperationConfig,
        seed: int,
        watch: Callable[[Window], None] | None = None,
        journal: Journal | None = None,
        observers: Sequence[Observer] = (),
    ) -> None:
        super().__init__(config, watch, journal)
        self._seed = seed
        self._observers = tuple(observers)
        self._robot: RunningRobot | None = None
        self._changes = 0
        self._stands = 0
        self._since_standing: list[Window] = []

    def __getstate__(self) -> dict[str, Any]:
        """State of a copy, whose robot runs the windows since it stood up again before its next one, unobserved."""
        return {**vars(self), "_robot": None, "_since_standing": list(self._since_standing), "_observers": ()}

    def replay(self, window: Window) -> EpisodeResult:
        """Run one window again that is known, and record it.

        :param window: next window
        :return: it as the result of an episode, with a trace
        """
        result = self._run_next(window.parameters, record=True)[1]
        assert result is not None
        return result

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
        super()._count(window)
        self._since_standing.append(window)
        if window.fell:
            self._put_up()

    def _standing(self) -> RunningRobot:
        config = self.config.robot_after(self._changes)
        conditions = conditions_put_up(config, self._seed, self._stands)
        robot = RunningRobot(config, self._seed, conditions=conditions)
        robot.observers = () if self._since_standing else self._observers
        robot.stand()
        return robot

    def _measured(self, parameters: Parameters) -> Window:
        return self._run_next(parameters)[0]

    def _run_next(self, parameters: Parameters, record: bool = False) -> tuple[Window, EpisodeResult | None]:
        parameters = BOX.checked(parameters)
        self._make_changes()
        if self._robot is None:
            self._robot = self._standing()
            for before in self._since_standing:  # known windows, which led to where the robot is now
                self._run(self._robot, before.parameters, before.begin, before is self._since_standing[0])
        stands = not self._since_standing
        window, result = self._run(self._robot, parameters, self.seconds, stands, record, self._observers)
        self._count(window)
        return window, result

    def _run(
        self,
        robot: RunningRobot,
        parameters: Parameters,
        begin: float,
        stands: bool,
        record_trace: bool = False,
        observers: Sequence[Observer] = (),
    ) -> tuple[Window, EpisodeResult | None]:
        dt = robot.config.physics.control_dt
        settle, measure = round(self.config.settle_seconds / dt), round(self.config.measure_seconds / dt)
        config = self.config.robot_after(self._changes)
        stood = STAND_SECONDS if stands else 0.0
        first = round((begin + stood) / dt)
        record = WindowRecord(robot, config, settle, measure)
        recording = Recording(robot, first * dt, record.true.returned) if record_trace else None
        robot.observers = (record, *(() if recording is None else recording.observers), *observers)
        robot.generator.set_parameters(*controller_parameters(parameters))
        if isinstance(robot.generator, Supervisor):  # if it has stopped, each window asks it to step again
            robot.generator.step()
        ticks = 0
        while ticks < settle + measure and robot.termination is None:
            robot.tick(self._force(config.push, first + ticks, dt))
            if robot.termination is None:
                record.judge(robot.torso.position)
                if robot.generator.has_fallen or is_fallen(robot.torso.upright(robot.vertical)):
                    robot.termination = "fell"
            ticks += 1
        fell = robot.termination is not None
        window = Window(
            index=self.windows,
            begin=begin,
            seconds=round(stood + ticks * dt + (self.config.fall_seconds if fell else 0.0), 9),
            changes=self._changes,
            parameters=parameters,
            score=record.true.returned.score,
            observed_reward=record.own.observed.score,
            fell=fell,
            felt=record.own.felt(),
        )
        termination = robot.termination or "time_limit"
        return window, None if recording is None else recording.result(robot, termination)

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
