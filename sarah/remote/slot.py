"""The slot for new parameters: one place, in which the newest push waits for the next swap of legs.

It is called from the control loop alone, in each tick, and knows neither sockets nor threads.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import astuple, dataclass
from typing import NamedTuple

from sarah.control.hip_law import BalanceParameters
from sarah.control.parameters import Parameters
from sarah.control.pattern_generator import STAND_SECONDS, Phase, SteppingParameters
from sarah.control.supervisor import State, Supervisor
from sarah.drivers.loop import LoopTick
from sarah.operation.settings import controller_parameters
from sarah.remote.answers import Answer, Outcome, Telemetry
from sarah.remote.requests import LARGEST_CHANGE, Request, merged, too_large


class Asked(NamedTuple):
    """A request and the way back.

    :param request: what the robot is asked
    :param reply: function that takes the answers to it, or the telemetry
    """

    request: Request
    reply: Callable[[Answer | Telemetry], None]


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

    A push is applied in the tick in which a step begins, or at once while the robot stands or has fallen. In the first
    second it waits, because the loop gives the robot its own parameters at the end of it.

    :param dt: control period, in s
    :param largest_change: largest change of a parameter, as a share of its range
    """

    def __init__(self, dt: float, largest_change: float = LARGEST_CHANGE) -> None:
        self._standing_ticks = round(STAND_SECONDS / dt)
        self._largest_change = largest_change
        self._waiting: Asked | None = None
        self._trial: Trial | None = None
        self._ticks = 0

    def tick(self, tick: LoopTick, supervisor: Supervisor, arrived: Iterable[Asked] = ()) -> None:
        """Do what was asked, as far as it can be done in this tick.

        :param tick: what happened in the tick
        :param supervisor: controller of the loop
        :param arrived: requests that have come since the last tick, in their order
        """
        moment = Moment(self._ticks, tick, supervisor)
        self._ticks += 1
        for asked in arrived:
            self._take(asked, moment)
        self._judge(moment)
        self._apply(moment)

    def close(self, reason: str) -> None:
        """Answer those that still wait: the control loop has ended.

        :param reason: reason for it
        """
        for asked in (self._waiting, None if self._trial is None else self._trial.asked):
            if asked is not None:
                asked.reply(Answer(Outcome.ENDED, reason))
        self._waiting = self._trial = None

    def _take(self, asked: Asked, moment: Moment) -> None:
        """Stand or step, or put a push into the slot."""
        supervisor, kind = moment.supervisor, asked.request.kind
        if kind == "stand":
            if supervisor.has_fallen:
                asked.reply(moment.answer(Outcome.REFUSED, "the robot has fallen"))
                return
            if not supervisor.is_waiting:
                supervisor.stand()
            asked.reply(moment.answer(Outcome.APPLIED))
        elif kind == "step":
            if not supervisor.is_waiting:
                words = "stops: ask again when it stands" if supervisor.state is State.STOPPING else "steps already"
                asked.reply(moment.answer(Outcome.REFUSED, f"the robot {words}"))
                return
            supervisor.step()
            asked.reply(moment.answer(Outcome.APPLIED))
        elif reason := self._refusal(asked, supervisor):
            asked.reply(moment.answer(Outcome.REFUSED, reason))
        else:
            if self._waiting is not None:
                self._waiting.reply(moment.answer(Outcome.OVERTAKEN, "newer parameters came before it was applied"))
            self._waiting = asked

    def _refusal(self, asked: Asked, supervisor: Supervisor) -> str:
        """Reason to refuse a push, once the robot has parameters of its own to compare it with."""
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

    def _apply(self, moment: Moment) -> None:
        """Give the robot the parameters that wait, if this is the tick for it."""
        asked, supervisor = self._waiting, moment.supervisor
        if asked is None or self._ticks <= self._standing_ticks or not moment.is_swap:
            return
        self._waiting = None
        if reason := self._refusal(asked, supervisor):  # the supervisor may have put others back meanwhile
            asked.reply(moment.answer(Outcome.REFUSED, reason))
            return
        supervisor.set_parameters(*controller_parameters(merged(asked.request.values, present(supervisor))))
        if self._trial is not None:
            self._trial.asked.reply(moment.answer(Outcome.OVERTAKEN, "newer parameters came before it was proven"))
        self._trial = None if supervisor.is_waiting else Trial(supervisor.asked, asked)
        reason = "they are tried once the robot steps" if supervisor.is_waiting else ""
        asked.reply(moment.answer(Outcome.APPLIED, reason, self._trial is None))


class Moment(NamedTuple):
    """A tick of the control loop.

    :param number: number of the tick, from 0
    :param tick: what happened in it
    :param supervisor: controller of the loop
    """

    number: int
    tick: LoopTick
    supervisor: Supervisor

    @property
    def is_swap(self) -> bool:
        """Whether new parameters can be applied: a step begins, or the robot stands or has fallen."""
        if self.supervisor.state is State.STEPPING:
            return self.tick.change is not None and self.tick.change.ended in (Phase.STAND, Phase.LAND)
        return self.supervisor.state is not State.STOPPING

    def answer(self, outcome: Outcome, reason: str = "", is_final: bool = True) -> Answer:
        """Answer of this tick.

        :param outcome: what became of the request
        :param reason: reason for it
        :param is_final: whether no other answer follows
        """
        state, phase = self.supervisor.state.value, self.supervisor.phase.value
        return Answer(outcome, reason, is_final, self.number, round(self.tick.seconds, 4), state, phase)


def present(supervisor: Supervisor) -> Parameters:
    """Values of P1 to P5 and V1 to V4 that a robot was given.

    :param supervisor: its controller
    """
    stepping, balance = supervisor.asked
    return (*astuple(stepping), *astuple(balance))
