"""One episode, tick by tick: its specification determines its result, byte for byte."""

from __future__ import annotations

from contextlib import AbstractContextManager

from sarah.control.hip_law import LOCKED_HIPS
from sarah.control.pattern_generator import STAND_SECONDS, PhaseChange
from sarah.episode.push import PUSH_SHOWN_SECONDS
from sarah.episode.recording import Recording, Return
from sarah.episode.result import EpisodeResult
from sarah.episode.reward import highest_return
from sarah.episode.running_robot import RunningRobot
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.task_answers import controller_of, ending_of, push_of, reward_of
from sarah.episode.tasks import STEPPING, Task
from sarah.episode.tick import Tick
from sarah.errors import check_type
from sarah.robot.reading import SensorReading, Targets, Vector
from sarah.simulation.build import BuildSimulator
from sarah.simulation.randomisation import Conditions
from sarah.simulation.world import HoldsWorld


class Episode(HoldsWorld, AbstractContextManager["Episode"]):
    """An episode of a robot: :meth:`stand`, then :meth:`run`. The end of a ``with`` block closes its world.

    To observe the robot in between, call :meth:`start` and then :meth:`tick` until :attr:`termination` says how the
    episode ended.

    :param config: settings that all episodes of an experiment share, of the task's type
    :param seed: seed of this episode
    :param task: task that owns the parameters and the push
    :param record_trace: whether to record every control tick in a trace
    :param build: function that makes the simulator from robot, physics and conditions; by default that of the
        configuration's engine
    :param conditions: properties of robot and world; by default those that
        :func:`~sarah.episode.robot_settings.conditions_of` draws from the seed
    """

    def __init__(
        self,
        config: EpisodeConfig,
        seed: int,
        task: Task = STEPPING,
        record_trace: bool = False,
        build: BuildSimulator | None = None,
        conditions: Conditions | None = None,
    ) -> None:
        self.task = task
        self.config = config
        self.push = push_of(task, task.checked_config(config, True), seed)
        self.robot = RunningRobot(config, seed, build, conditions)
        """Robot in its world, with what it senses, its controller and its simulation."""
        seconds = config.time_limit - STAND_SECONDS
        self._return = Return(
            highest_return(self.robot.description.standing_height, seconds, config)
            if task.best_reward is None
            else task.best_reward * seconds
        )
        self._dt = config.physics.control_dt
        self._recording = Recording(self.robot, STAND_SECONDS, self._return, record_trace)

    @classmethod
    def of(cls, spec: EpisodeSpec, record_trace: bool = False) -> Episode:
        """Make the episode of a specification.

        :param spec: specification, whose parameters are for :meth:`start` or :meth:`run`
        :param record_trace: whether to record every control tick in a trace
        :raises ConfigurationError: if it is no specification
        """
        check_type("spec", spec, EpisodeSpec)
        return cls(spec.config, spec.seed, spec.task, record_trace)

    def __exit__(self, *error: object) -> None:
        """Close the world."""
        self.close()

    @property
    def termination(self) -> str | None:
        """Way in which the episode ended; ``None`` while it goes on."""
        return self.robot.termination

    def stand(self) -> SensorReading:
        """Stand for the first second, which is not recorded.

        :return: the last reading of that second, which an agent acts on
        """
        reading = self.robot.stand()
        self.record()
        return reading

    def record(self) -> None:
        """Record from the next tick on, which :meth:`stand` does at its end."""
        self.robot.observers = self._recording.observers

    def run(self, parameters: tuple[float, ...]) -> EpisodeResult:
        """Let the pattern generator run until the episode ends.

        :param parameters: values of the task's parameters, in order
        :return: the result
        """
        self.start(parameters)
        while self.robot.termination is None:
            self.tick()
        return self.result()

    def start(self, parameters: tuple[float, ...]) -> None:
        """Give the pattern generator its parameters; it steps from the next tick on.

        :param parameters: values of the task's parameters, in order
        """
        stepping, balance = controller_of(self.task, parameters, self.config)
        self.robot.generator.set_parameters(stepping, balance or LOCKED_HIPS)

    def tick(self) -> None:
        """Advance by one control tick, with the push if it is its time, and judge."""
        if self.robot.sense():
            change = self.robot.generator.tick(self.robot.last_reading)
            self.act(self.robot.generator.targets, change)

    def act(self, targets: Targets, change: PhaseChange | None) -> None:
        """Advance by one control tick of which the robot has already sensed and decided.

        :param targets: joint targets in the order of ``ACTUATED_JOINTS``, in rad and m
        :param change: end of a phase that the controller reported
        """
        self.robot.act(targets, change, self._push_within(0.0))
        if self.robot.termination is None:
            self._judge()

    def result(self) -> EpisodeResult:
        """Result of the episode so far; while the episode goes on, its ``termination`` is empty."""
        return self._recording.result(self.robot, self.termination or "", before=STAND_SECONDS)

    def shown_push(self) -> Vector | None:
        """Force of the push that a picture shows now, in N, as :class:`~sarah.episode.trace.Trace` has it."""
        force = self._push_within(PUSH_SHOWN_SECONDS)
        return force if force and any(force) else None

    def close(self) -> None:
        """Give the physics engine's resources back."""
        self.robot.close()

    def _push_within(self, shortest: float) -> Vector | None:
        """Force of the push in N, while it lasts, and for some seconds after its beginning at least."""
        if self.push is None:
            return None
        half_tick = self._dt / 2
        since_begin = self._recording.time - self.push.begin
        return self.push.force if -half_tick <= since_begin < max(self.push.duration, shortest) - half_tick else None

    def _judge(self) -> None:
        """Add this tick's reward, and check whether the episode ends."""
        robot, recording = self.robot, self._recording
        tick = Tick(
            recording.time,
            recording.start,
            robot.torso,
            recording.gait.steps,
            recording.gait.steps_per_second(recording.gait.ticks),
            robot.generator.phase,
            robot.generator.stance,
            robot.truth,
            robot.last_reading,
            robot.simulation,
            robot.vertical,
        )
        self._return.value += reward_of(self.task, tick, self.config) * self._dt
        robot.termination = ending_of(self.task, tick, self.config)
        if robot.termination is None and tick.time > self.config.time_limit - self._dt / 2:
            robot.termination = "time_limit"


def simulate(spec: EpisodeSpec, record_trace: bool = False) -> EpisodeResult:
    """Simulate one episode, from a new world to its end.

    :param spec: specification, which determines the result: the same one gives the same bytes in any process
    :param record_trace: whether to record a :class:`~sarah.episode.trace.Trace` in the result
    :return: the result
    :raises ConfigurationError: if it is no specification
    :raises SimulationError: if there is nothing to trace, because the simulation diverged while the robot stood
    """
    with Episode.of(spec, record_trace) as episode:
        episode.stand()
        return episode.run(spec.parameters)
