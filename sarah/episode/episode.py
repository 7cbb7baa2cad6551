"""One episode, tick by tick: its specification determines its result, byte for byte."""

from __future__ import annotations

from typing import Any

from sarah.control.hip_law import LOCKED_HIPS
from sarah.control.pattern_generator import STAND_SECONDS, Phase
from sarah.episode.gait import GaitRecord
from sarah.episode.motion import MotionRecord
from sarah.episode.push import PUSH_SHOWN_SECONDS
from sarah.episode.result import EpisodeResult
from sarah.episode.reward import highest_return
from sarah.episode.running_robot import RunningRobot
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.task_answers import controller_of, ending_of, push_of, reward_of
from sarah.episode.tasks import STEPPING, Task
from sarah.episode.tick import Tick
from sarah.episode.trace import Trace
from sarah.errors import check_type
from sarah.robot.reading import Vector
from sarah.simulation.build import BuildSimulator
from sarah.simulation.randomisation import Conditions
from sarah.simulation.simulator import TorsoState


class Episode(RunningRobot):
    """A robot in its world: :meth:`stand`, then :meth:`run`, then :meth:`close`.

    To observe the robot in between, call :meth:`start` and then :meth:`tick` until :attr:`termination` says how the
    episode ended.

    :param config: settings that all episodes of an experiment share, of the task's type
    :param seed: seed of this episode
    :param task: task that owns the parameters and the push
    :param record_trace: whether to record every control tick in a trace
    :param build: function that makes the simulator from robot, physics and conditions; by default that of the
        configuration's engine
    :param conditions: properties of robot and world; by default those that
        :func:`~sarah.episode.running_robot.conditions_of` draws from the seed
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
        self.push = push_of(task, task.checked_config(config, True), seed)
        super().__init__(config, seed, build, conditions)
        self._first = self._last = self.simulation.torso_state()
        self._gait = GaitRecord(config.physics.control_rate)
        self._motion = MotionRecord(config.physics.control_rate, config.scale.time)
        self._ticks = 0
        self._return = 0.0
        seconds = config.time_limit - STAND_SECONDS
        self._highest_return = (
            highest_return(self.robot.standing_height, seconds, config.reward_half_width)
            if task.best_reward is None
            else task.best_reward * seconds
        )
        self._trace: list[dict[str, Any]] | None = [] if record_trace else None

    def run(self, parameters: tuple[float, ...]) -> EpisodeResult:
        """Let the pattern generator run until the episode ends.

        :param parameters: values of the task's parameters, in order
        :return: the result
        """
        self.start(parameters)
        while self.termination is None:
            self.tick()
        return self.result()

    def start(self, parameters: tuple[float, ...]) -> None:
        """Give the pattern generator its parameters; it steps from the next tick on.

        :param parameters: values of the task's parameters, in order
        """
        stepping, balance = controller_of(self.task, parameters, self.config)
        self.generator.set_parameters(stepping, balance or LOCKED_HIPS)

    def tick(self) -> None:
        """Advance by one control tick: sense, decide, act, simulate and judge."""
        simulation, generator, gait = self.simulation, self.generator, self._gait
        reading = self.sense()
        if self.termination is not None:
            return
        self._motion.tick(self.truth.acceleration, *simulation.actuator_motion())
        if generator.phase in (Phase.LIFT, Phase.LAND):
            gait.swing(simulation.sole_height(generator.swing))
        change = generator.tick(reading)
        if change is not None:
            gait.phase_change(self._ticks, change)
        simulation.set_targets(generator.targets)
        force = self._push_now()
        if force is not None:
            simulation.push(force)
        if self._trace is not None:
            frequency = gait.steps_per_second(self._ticks + 1)  # as its reward has it
            score = self._return / self._highest_return
            self._trace.append(self.trace_row(STAND_SECONDS + self._ticks * self._dt, force, frequency, score))
        simulation.advance()
        self._ticks += 1
        self._judge()

    def result(self) -> EpisodeResult:
        """Result of the episode so far; while the episode goes on, its ``termination`` is empty."""
        elapsed = self._ticks * self._dt
        return EpisodeResult(
            score=self._return / self._highest_return,
            episode_return=self._return,
            steps_per_second=self._gait.steps / elapsed if elapsed else 0.0,
            duration=round(STAND_SECONDS + elapsed, 9),
            termination=self.termination or "",
            final_position=self._displacement(self._last),
            **self._gait.metrics(),
            **self._motion.metrics(),
            trace=None if self._trace is None else Trace.of(self._trace),
        )

    def _push_now(self) -> Vector | None:
        """Force of the push in N, while it lasts."""
        if self.push is None:
            return None
        since_begin = STAND_SECONDS + self._ticks * self._dt - self.push.begin
        is_now = -self._dt / 2 <= since_begin < self.push.duration - self._dt / 2
        return self.push.force if is_now else None

    def shown_push(self) -> Vector | None:
        """Force of the push that a picture shows now, in N, as :class:`~sarah.episode.trace.Trace` has it."""
        if self.push is None or not any(self.push.force):
            return None
        since_begin = STAND_SECONDS + self._ticks * self._dt - self.push.begin
        is_shown = -self._dt / 2 <= since_begin < max(self.push.duration, PUSH_SHOWN_SECONDS) - self._dt / 2
        return self.push.force if is_shown else None

    def _judge(self) -> None:
        """Add this tick's reward, and check whether the episode ends."""
        torso = self.simulation.torso_state()
        if not torso.is_finite:  # the result is that of the last finite state
            self.termination = "diverged"
            return
        self._last = torso
        tick = Tick(
            STAND_SECONDS + self._ticks * self._dt,
            self._first.position,
            torso,
            self._gait.steps,
            self._gait.steps_per_second(self._ticks),
            self.generator.phase,
            self.generator.stance,
            self.truth,
            self.last_reading,
            self.simulation,
            self.vertical,
        )
        self._return += reward_of(self.task, tick, self.config) * self._dt
        self.termination = ending_of(self.task, tick, self.config)
        if self.termination is None and tick.time > self.config.time_limit - self._dt / 2:
            self.termination = "time_limit"

    def _displacement(self, torso: TorsoState) -> tuple[float, float, float]:
        """Torso position as in equation 2: x and y from the start, z over the floor, in m."""
        x, y, z = torso.position
        return (x - self._first.position[0], y - self._first.position[1], z)


def simulate(spec: EpisodeSpec, record_trace: bool = False) -> EpisodeResult:
    """Simulate one episode, from a new world to its end.

    :param spec: specification, which determines the result: the same one gives the same bytes in any process
    :param record_trace: whether to record a :class:`~sarah.episode.trace.Trace` in the result
    :return: the result
    :raises ConfigurationError: if it is no specification
    :raises SimulationError: if there is nothing to trace, because the simulation diverged while the robot stood
    """
    check_type("spec", spec, EpisodeSpec)
    episode = Episode(spec.config, spec.seed, spec.task, record_trace)
    try:
        episode.stand()
        return episode.run(spec.parameters)
    finally:
        episode.close()
