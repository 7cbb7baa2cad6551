"""One simulation: an episode's specification in, its result out, the same bytes every time."""

from __future__ import annotations

from typing import Any

from sarah.control.hip_law import BalanceParameters, HipLaw
from sarah.control.pattern_generator import STAND_SECONDS, PatternGenerator, Phase, SteppingParameters
from sarah.episode.ending import BOX_HALF_WIDTH, LEAST_UPRIGHT, OSCILLATION_SECONDS, OSCILLATION_STEPS
from sarah.episode.gait import GaitRecord
from sarah.episode.motion import MotionRecord
from sarah.episode.push import DrawnPush, draw_push
from sarah.episode.result import EpisodeResult
from sarah.episode.reward import highest_return, reward_rate
from sarah.episode.spec import EpisodeConfig, EpisodeSpec
from sarah.episode.tasks import BALANCE, STEPPING, TASKS, Task
from sarah.episode.trace import Trace
from sarah.robot.description import ANKLE_JOINTS, describe_robot
from sarah.robot.reading import SensorReading, Vector
from sarah.simulation.engines import BuildSimulator, simulator_of
from sarah.simulation.randomisation import draw_conditions
from sarah.simulation.sensors import ImperfectSensors
from sarah.simulation.simulator import TorsoState


class Episode:
    """A robot in its world: :meth:`stand`, then :meth:`run`, then :meth:`close`.

    Whoever wants to look at the robot in between calls :meth:`start` and then :meth:`tick` until :attr:`termination`
    says how the episode ended.

    :param config: what all episodes of an experiment share
    :param seed: of this episode
    :param task: ``STEPPING``, or ``BALANCE``, in which the robot is pushed
    :param record_trace: whether to keep a trace of every control tick
    :param build: makes the simulator from robot, physics and conditions; by default the configuration's engine
    """

    generator: PatternGenerator
    """Of the joint targets, from :meth:`start` on."""
    standing: list[SensorReading]
    """What was sensed during the first second."""

    def __init__(
        self,
        config: EpisodeConfig,
        seed: int,
        task: Task = STEPPING,
        record_trace: bool = False,
        build: BuildSimulator | None = None,
    ) -> None:
        self.config = config
        self.task = task
        self.push: DrawnPush | None = draw_push(config.push, seed) if task == BALANCE else None
        self.termination: str | None = None
        self.robot = describe_robot(config.dimensions)
        conditions = draw_conditions(config.randomisation, seed)
        self.simulation = (build or simulator_of(config.engine))(self.robot, config.physics, conditions)
        self._truth = self.last_reading = self.simulation.read()
        self._dt = config.physics.control_dt
        self._pad_threshold = conditions.pad_threshold
        self._sensors = ImperfectSensors(
            conditions.acceleration_noise,
            conditions.angular_rate_noise,
            conditions.imu_bandwidth,
            conditions.pad_noise,
            conditions.delay_ticks,
            conditions.sensor_seed,
            self._dt,
        )
        self.standing = []
        self._first = self._last = self.simulation.torso_state()
        self._gait = GaitRecord(config.physics.control_rate)
        self._motion = MotionRecord(config.physics.control_rate)
        self._ticks = 0
        self._return = 0.0
        self._highest_return = highest_return(self.robot.standing_height, config.time_limit - STAND_SECONDS)
        self._trace: list[dict[str, Any]] | None = [] if record_trace else None

    def stand(self) -> SensorReading:
        """Stand for the first second.

        :return: the last reading of that second: the observation that the agent acts on
        """
        for _ in range(round(STAND_SECONDS / self._dt)):
            self.standing.append(self._sense())
            self.simulation.advance()
        return self.last_reading

    def run(self, parameters: tuple[float, ...]) -> EpisodeResult:
        """Let the pattern generator run until the episode ends.

        :param parameters: of the task
        :return: the result
        """
        self.start(parameters)
        while self.termination is None:
            self.tick()
        return self.result()

    def start(self, parameters: tuple[float, ...]) -> None:
        """Make the pattern generator, which knows what was sensed while standing.

        :param parameters: of the task: P1 to P5, or V1 to V4
        """
        learned = self.task.checked(parameters)
        stepping, balance = (self.config.stepping, learned) if self.task == BALANCE else (learned, None)
        self.generator = PatternGenerator(
            SteppingParameters(*stepping),
            self._pad_threshold,
            self._dt,
            HipLaw(BalanceParameters(*balance), self._dt) if balance else None,
        )
        for reading in self.standing:
            self.generator.sense(reading)

    def tick(self) -> None:
        """Sense, decide, act, simulate and judge one control tick."""
        simulation, generator, gait = self.simulation, self.generator, self._gait
        reading = self._sense()
        if self.termination is not None:
            return
        self._motion.tick(self._truth.acceleration, *simulation.actuator_motion())
        if generator.phase in (Phase.LIFT, Phase.LAND):
            gait.swing(simulation.sole_height(generator.swing.name.lower()))
        change = generator.tick(reading)
        if change is not None:
            gait.phase_change(self._ticks, change)
        simulation.set_targets(generator.targets)
        force = self._push_now()
        if force is not None:
            simulation.push(force)
        if self._trace is not None:
            self._record(reading, force or (0.0, 0.0, 0.0))
        simulation.advance()
        self._ticks += 1
        self._judge()

    def result(self) -> EpisodeResult:
        """What has come out of the episode so far; of an episode that goes on, its ``termination`` is empty."""
        elapsed = self._ticks * self._dt
        return EpisodeResult(
            score=self._return / self._highest_return,
            episode_return=self._return,
            steps_per_second=self._gait.steps / elapsed if elapsed else 0.0,
            steps=self._gait.steps,
            duration=round(STAND_SECONDS + elapsed, 9),
            termination=self.termination or "",
            final_position=self._displacement(self._last),
            sole_clearance=self._gait.sole_clearance,
            event_driven_shift=self._gait.event_driven(Phase.SHIFT),
            event_driven_lift=self._gait.event_driven(Phase.LIFT),
            vibration=self._motion.vibration,
            actuator_power=self._motion.actuator_power,
            peak_hip_rate=self._motion.peak_hip_rate,
            peak_leg_speed=self._motion.peak_leg_speed,
            trace=None if self._trace is None else Trace.of(self._trace),
        )

    def close(self) -> None:
        """Give the physics engine's resources back."""
        self.simulation.close()

    def _sense(self) -> SensorReading:
        truth = self.simulation.read()
        if truth.is_finite:
            self._truth, self.last_reading = truth, self._sensors(truth)
        else:  # what has been sensed stays
            self.termination = "diverged"
        return self.last_reading

    def _push_now(self) -> Vector | None:
        """The push's force in N, if its time has come."""
        if self.push is None:
            return None
        since_begin = STAND_SECONDS + self._ticks * self._dt - self.push.begin
        is_now = -self._dt / 2 <= since_begin < self.push.duration - self._dt / 2
        return self.push.force if is_now else None

    def _judge(self) -> None:
        """Add this tick's reward, and see whether the episode ends."""
        elapsed = self._ticks * self._dt
        torso = self.simulation.torso_state()
        self.termination = self._termination(torso, self._gait.steps, STAND_SECONDS + elapsed)
        if self.termination == "diverged":  # the result keeps to the last finite state
            return
        self._last = torso
        frequency = self._gait.steps_per_second(self._ticks)
        self._return += reward_rate(*self._displacement(torso), frequency, self.config.reward_form) * self._dt

    def _displacement(self, torso: TorsoState) -> tuple[float, float, float]:
        """Torso position as equation 2 wants it: x and y from the start, z over the floor."""
        x, y, z = torso.position
        return (x - self._first.position[0], y - self._first.position[1], z)

    def _termination(self, torso: TorsoState, steps: int, time: float) -> str | None:
        if not torso.is_finite:
            return "diverged"
        (x, y, z), (start_x, start_y, start_z) = torso.position, self._first.position
        if max(abs(x - start_x), abs(y - start_y), abs(z - start_z)) > BOX_HALF_WIDTH:
            return "left_box"
        if torso.upright < LEAST_UPRIGHT:
            return "fell"
        half_tick = self._dt / 2
        if steps < OSCILLATION_STEPS and time > OSCILLATION_SECONDS - half_tick:
            return "no_oscillation"
        return "time_limit" if time > self.config.time_limit - half_tick else None

    def _record(self, reading: SensorReading, push: Vector) -> None:
        assert self._trace is not None
        generator, torso = self.generator, self.simulation.torso_state()
        self._trace.append(
            {
                "time": STAND_SECONDS + self._ticks * self._dt,
                "position": torso.position,
                "orientation": torso.orientation,
                "joints": self._truth.joints,
                "ankles": self.simulation.joint_positions(ANKLE_JOINTS),
                "targets": generator.targets,
                "pressures": reading.pressures,
                "acceleration": reading.acceleration,
                "angular_rate": reading.angular_rate,
                "phase": generator.phase.value,
                "support": generator.support.value,
                "stable_x": generator.stable_x,
                "tilt": generator.tilt,
                "rate": generator.rate,
                "steps_per_second": self._gait.steps_per_second(self._ticks),
                "push": push,
                "score": self._return / self._highest_return,
            }
        )


def simulate(spec: EpisodeSpec, record_trace: bool = False) -> EpisodeResult:
    """Simulate one episode, from a fresh world to its end.

    :param spec: everything that the result depends on; the same spec gives the same bytes in any process
    :param record_trace: whether the result has a :class:`~sarah.episode.trace.Trace`
    :return: the result
    :raises SimulationError: if there is nothing to trace, because the robot did not even stand
    """
    episode = Episode(spec.config, spec.seed, TASKS[spec.task], record_trace)
    try:
        episode.stand()
        return episode.run(spec.parameters)
    finally:
        episode.close()
