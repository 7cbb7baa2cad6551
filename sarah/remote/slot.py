"""The slot for new parameters: one place, in which the newest push or window waits for the next swap of legs.

It is called from the control loop alone, in each tick, and knows neither sockets nor threads.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import NamedTuple

from sarah.control.hip_law import BalanceParameters
from sarah.control.pattern_generator import STAND_SECONDS, SteppingParameters
from sarah.control.supervisor import ASKED_TO_STAND, State, Supervisor
from sarah.drivers.loop import LoopTick
from sarah.operation.settings import controller_parameters
from sarah.remote.answers import Answer, Measured, Message, Outcome
from sarah.remote.measurement import Measurement, Meter
from sarah.remote.moment import Moment, present
from sarah.remote.requests import LARGEST_CHANGE, Request, merged, too_large

UPRIGHT_SECONDS = 2.0
"""Time for which a robot that fell must stand upright before a learner's window lets it step again, in s."""
ASKED_SECONDS = 5.0
"""Time for which the window of a robot that has fallen or is to stand waits, before its learner has to ask again, in s:
a learner that has gone moves nothing."""
LEARNER_SECONDS = 10.0
"""Time after a learner's last window for which the robot is its alone, in s of the computer's clock."""


class Asked(NamedTuple):
    """A request and the way back.

    :param request: what the robot is asked
    :param reply: function that takes the answers to it, or the telemetry
    """

    request: Request
    reply: Callable[[Message], None]


@dataclass
class Waiting:
    """A request that waits in the slot.

    :param asked: the request
    :param since: time since the robot began at which it came, in s
    :param hindered_ticks: number of ticks for which something has kept the robot from it
    """

    asked: Asked
    since: float
    hindered_ticks: int = 0


@dataclass(frozen=True)
class Trial:
    """Parameters that are applied and not proven yet.

    :param parameters: the parameters
    :param asked: request for them
    """

    parameters: tuple[SteppingParameters, BalanceParameters]
    asked: Asked


class Slot:
    """One place for new parameters. Call :meth:`tick` once per tick of the control loop, after the controller's tick.

    They are applied in the tick in which a step begins, or at once while the robot stands or has fallen. In the first
    second they wait, because the loop gives the robot its own parameters at the end of it. A window that somebody asked
    for then runs; it lets a robot step again that has stopped by itself, but not one that somebody asked to stand.

    :param dt: control period, in s
    :param largest_change: largest change of a parameter, as a share of its range
    :param meter: what windows are measured by; without it they are refused
    :param clock: clock by which a learner counts as gone, in s
    """

    def __init__(
        self,
        dt: float,
        largest_change: float = LARGEST_CHANGE,
        meter: Meter | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._standing_ticks, self._upright_needed = round(STAND_SECONDS / dt), round(UPRIGHT_SECONDS / dt)
        self._asked_ticks = round(ASKED_SECONDS / dt)
        self._largest_change, self._meter, self._clock = largest_change, meter, clock
        self._waiting: Waiting | None = None
        self._trial: Trial | None = None
        self._window: tuple[Measurement, Asked] | None = None
        self._learner, self._heard = "", float("-inf")
        self._waited_since: float | None = None
        self._ticks = self._upright_ticks = 0
        self._is_held = False

    @property
    def is_idle(self) -> bool:
        """Whether nothing waits, is tried or is measured."""
        return self._waiting is None and self._trial is None and self._window is None

    def tick(self, tick: LoopTick, supervisor: Supervisor, arrived: Iterable[Asked] = ()) -> None:
        """Do what was asked, as far as it can be done in this tick.

        :param tick: what happened in the tick
        :param supervisor: controller of the loop
        :param arrived: requests that have come since the last tick, in their order
        """
        moment = Moment(self._ticks, tick, supervisor)
        self._ticks += 1
        self._watch(moment)
        for asked in arrived:
            self._take(asked, moment)
        self._judge(moment)
        self._measure(moment)
        self._apply(moment)

    def close(self, reason: str) -> None:
        """Answer those that still wait: the control loop has ended.

        :param reason: reason for it
        """
        waiting = None if self._waiting is None else self._waiting.asked
        trial = None if self._trial is None else self._trial.asked
        for asked in (waiting, trial, None if self._window is None else self._window[1]):
            if asked is not None:
                asked.reply(Answer(Outcome.ENDED, reason))
        self._waiting = self._trial = self._window = None

    def _watch(self, moment: Moment) -> None:
        """Keep in mind whether somebody asked the robot to stand, and for how long one that fell has been upright."""
        supervisor = moment.supervisor
        if supervisor.state_change is not None and supervisor.state_change.reason == ASKED_TO_STAND:
            self._is_held = True
        is_up_again = supervisor.has_fallen and supervisor.is_upright
        self._upright_ticks = self._upright_ticks + 1 if is_up_again else 0

    def _take(self, asked: Asked, moment: Moment) -> None:
        """Stand or step, or put parameters into the slot."""
        supervisor, kind = moment.supervisor, asked.request.kind
        if kind == "stand":
            self._is_held = True
            if supervisor.has_fallen:
                words = "the robot has fallen: it does not step before sarah-push --step"
                asked.reply(moment.answer(Outcome.REFUSED, words))
                return
            if not supervisor.is_waiting:
                supervisor.stand()
            asked.reply(moment.answer(Outcome.APPLIED))
        elif kind == "step":
            if not supervisor.is_waiting:
                is_stopping = self._is_held or supervisor.state is State.STOPPING
                words = "stops: ask again when it stands" if is_stopping else "steps already"
                asked.reply(moment.answer(Outcome.REFUSED, f"the robot {words}"))
                return
            self._is_held = False
            supervisor.step()
            asked.reply(moment.answer(Outcome.APPLIED))
        elif self._is_operated_by_another(asked.request.learner):
            asked.reply(moment.answer(Outcome.BUSY, "a learner operates the robot"))
        elif reason := self._refusal(asked, supervisor):
            asked.reply(moment.answer(Outcome.REFUSED, reason))
        else:
            self._put(asked, moment)

    def _put(self, asked: Asked, moment: Moment) -> None:
        """Put parameters into the slot. A learner that asks for a window again has lost the one before."""
        overtaken = moment.answer(Outcome.OVERTAKEN, "newer parameters came before it was applied")
        if self._waiting is not None:
            self._waiting.asked.reply(overtaken)
        since = moment.tick.seconds
        if self._waited_since is not None and asked.request.kind == "window" and self._is_heard:
            since = self._waited_since
        self._waiting, self._waited_since = Waiting(asked, since), None
        if asked.request.kind == "window":
            self._learner = asked.request.learner
        if self._window is not None:
            self._window[1].reply(moment.answer(Outcome.OVERTAKEN, "newer parameters came before it was over"))
            self._window = None

    def _is_operated_by_another(self, learner: str) -> bool:
        """Whether a window of another learner waits or runs, or has just been."""
        is_at_it = self._window is not None or (
            self._waiting is not None and self._waiting.asked.request.kind == "window"
        )
        return learner != self._learner and (is_at_it or self._is_heard)

    @property
    def _is_heard(self) -> bool:
        """Whether the last window of a learner is not long over."""
        return self._clock() < self._heard + LEARNER_SECONDS

    def _refusal(self, asked: Asked, supervisor: Supervisor) -> str:
        """Reason to refuse parameters, once the robot has some of its own to compare them with."""
        if asked.request.kind == "window" and self._meter is None:
            return "this robot measures no windows"
        if self._ticks <= self._standing_ticks:
            return ""
        return too_large(asked.request.values, present(supervisor), self._largest_change)

    def _judge(self, moment: Moment) -> None:
        """Tell what became of the parameters on trial, once that is known."""
        trial, supervisor = self._trial, moment.supervisor
        if trial is None:
            return
        reason = supervisor.state_change.reason if supervisor.state_change else ""
        if supervisor.asked != trial.parameters:
            answer = moment.answer(Outcome.REPLACED, reason)
        elif supervisor.state is State.STOPPING or supervisor.is_waiting:
            answer = moment.answer(Outcome.STOPPED, reason)
        elif supervisor.is_proven:
            answer = moment.answer(Outcome.KEPT)
        else:
            return
        self._trial = None
        trial.asked.reply(answer)

    def _measure(self, moment: Moment) -> None:
        """Go on with the window that is measured, and answer once it is over, or once somebody stops the robot."""
        if self._window is None:
            return
        measurement, asked = self._window
        message = moment.answer(Outcome.STOPPED, ASKED_TO_STAND) if self._is_held else measurement.tick(moment)
        if message is not None:
            self._window, self._heard = None, self._clock()
            asked.reply(message)
            if isinstance(message, Measured) and self._meter is not None:
                self._meter.watch(measurement.parameters, message)

    def _apply(self, moment: Moment) -> None:
        """Give the robot the parameters that wait, if this is the tick for it."""
        waiting, supervisor = self._waiting, moment.supervisor
        if waiting is None or self._ticks <= self._standing_ticks or not moment.is_swap:
            return
        asked = waiting.asked
        if asked.request.kind == "window" and (hindrance := self._hindrance(supervisor)):
            self._let_wait(waiting, moment, hindrance)
            return
        self._waiting = None
        if reason := self._refusal(asked, supervisor):  # the supervisor may have put others back meanwhile
            asked.reply(moment.answer(Outcome.REFUSED, reason))
            return
        supervisor.set_parameters(*controller_parameters(merged(asked.request.values, present(supervisor))))
        if self._trial is not None:
            self._trial.asked.reply(moment.answer(Outcome.OVERTAKEN, "newer parameters came before it was proven"))
            self._trial = None
        if asked.request.kind == "window":
            self._begin_window(asked, moment, waiting.since)
        else:
            self._begin_trial(asked, moment)

    def _let_wait(self, waiting: Waiting, moment: Moment, hindrance: str) -> None:
        """Tell a learner why its window waits, and forget the window if it is not asked for again."""
        is_over = waiting.hindered_ticks >= self._asked_ticks
        if is_over or waiting.hindered_ticks == 0:
            waiting.asked.reply(moment.answer(Outcome.WAITING, hindrance, is_over))
        waiting.hindered_ticks += 1
        if is_over:
            self._waiting, self._waited_since, self._heard = None, waiting.since, self._clock()

    def _hindrance(self, supervisor: Supervisor) -> str:
        """Reason for which a window cannot begin yet; empty if it can."""
        if self._is_held:
            return "somebody asked the robot to stand: sarah-push --step lets it go on"
        truth = None if self._meter is None else self._meter.truth
        lies = truth is not None and truth.has_fallen
        if lies or (supervisor.has_fallen and self._upright_ticks < self._upright_needed):
            return "the robot has fallen: it goes on when somebody has set it upright"
        return ""

    def _begin_window(self, asked: Asked, moment: Moment, since: float) -> None:
        """Let a robot step that has stopped by itself, and measure."""
        assert self._meter is not None and asked.request.window is not None
        measurement = Measurement(self._meter, asked.request.window, moment, since)
        moment.supervisor.step()
        self._window = measurement, asked
        asked.reply(moment.answer(Outcome.APPLIED, is_final=False))

    def _begin_trial(self, asked: Asked, moment: Moment) -> None:
        """Watch what becomes of pushed parameters, if the robot steps. A learner that pushes leaves the robot."""
        supervisor = moment.supervisor
        self._trial = None if supervisor.is_waiting else Trial(supervisor.asked, asked)
        reason = "they are tried once the robot steps" if supervisor.is_waiting else ""
        asked.reply(moment.answer(Outcome.APPLIED, reason, self._trial is None))
        self._learner, self._heard = "", float("-inf")
