"""A window that a robot measures of itself, tick by tick, as its control loop runs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from sarah.control.parameters import Parameters
from sarah.control.pattern_generator import STAND_SECONDS
from sarah.control.supervisor import PUT_BACK, State
from sarah.episode.reward import RewardSettings
from sarah.operation.window_record import FeltRecord, TrueRecord
from sarah.remote.answers import Measured
from sarah.remote.moment import Moment, present
from sarah.remote.requests import WindowTimes
from sarah.robot.description import describe_robot
from sarah.robot.reading import Vector

LONGEST_REASON = 200
"""Length up to which a window tells what the supervisor did, in characters."""


class Truth(Protocol):
    """What is true of a simulated robot."""

    @property
    def position(self) -> Vector:
        """Position of the torso's centre, in m."""

    @property
    def has_fallen(self) -> bool:
        """Whether it lies."""


class Meter:
    """What a robot measures windows by.

    :param config: settings of the robot, with those of the reward
    :param truth: what is true of it; ``None`` if nobody knows
    """

    def __init__(self, config: RewardSettings, truth: Truth | None = None) -> None:
        self.config, self.truth = config, truth
        self.watch: Callable[[Parameters, Measured], None] = lambda parameters, measured: None
        """Function that is called with every window and its parameters. It must not wait."""
        self.height = describe_robot(config.dimensions).standing_height
        """Height of the torso's centre over the floor while the robot stands, in m."""


class Measurement:
    """A window from the tick on in which its parameters are applied. Call :meth:`tick` in each tick after that.

    :param meter: what the robot measures by
    :param times: times of the window
    :param moment: tick in which the parameters are applied, which are the supervisor's from now on
    :param asked_seconds: time at which somebody asked for it since the robot began, in s
    """

    def __init__(self, meter: Meter, times: WindowTimes, moment: Moment, asked_seconds: float) -> None:
        config, dt = meter.config, meter.config.physics.control_dt
        stands = STAND_SECONDS if moment.supervisor.state is not State.STEPPING else 0.0
        settle, measure = round((stands + times.settle_seconds) / dt), round(times.measure_seconds / dt)
        self._truth, self._asked_seconds = meter.truth, asked_seconds
        self._began, self._first_tick = moment.tick.seconds, moment.number
        self._felt = FeltRecord(meter.height, config, settle, measure)
        self._true = TrueRecord(meter.height, config, measure)
        self._parameters, self._targets = moment.supervisor.asked, moment.supervisor.targets
        self._reasons: list[str] = []
        self.parameters = present(moment.supervisor)
        """P1 to P5 and V1 to V4 that are measured."""

    def tick(self, moment: Moment) -> Measured | None:
        """Record a tick, whose beginning is the end of the one before.

        :param moment: tick of the loop
        :return: the window, once it is over
        """
        supervisor, truth = moment.supervisor, self._truth
        is_first = moment.number == self._first_tick + 1
        frequency = None if is_first else self._felt.judge()
        if frequency is not None and truth is not None:
            self._true.judge(truth.position, frequency)
        self._note(moment)
        fell = supervisor.has_fallen or (truth is not None and truth.has_fallen)
        if fell or self._felt.is_over or supervisor.asked != self._parameters:
            return self._measured(moment, fell)
        reading = moment.tick.reading
        if reading is not None and reading.is_finite:
            self._felt.sensed(reading, self._targets)
        self._felt.decided(moment.tick.change)
        self._targets = supervisor.targets
        return None

    def _note(self, moment: Moment) -> None:
        """Keep in mind what the supervisor did, but for what follows by itself: it stands, and steps again."""
        change = moment.supervisor.state_change
        follows = ((State.STOPPING, State.STANDING), (State.STANDING, State.STEPPING))
        if change is not None and (change.before, change.state) not in follows:
            words = change.reason if change.reason.startswith(PUT_BACK) else f"{change.state.value}: {change.reason}"
            self._reasons.append(words)

    def _measured(self, moment: Moment, fell: bool) -> Measured:
        return Measured(
            observed_reward=self._felt.observed.score,
            score=None if self._truth is None else self._true.returned.score,
            fell=fell,
            felt=self._felt.felt(),
            seconds=round(moment.tick.seconds - self._asked_seconds, 9),
            began=round(self._began, 9),
            tick=self._first_tick,
            ticks=moment.number - self._first_tick - 1,
            reason="; ".join(dict.fromkeys(self._reasons))[:LONGEST_REASON],
        )
