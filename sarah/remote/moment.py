"""A tick of a control loop, as it matters to requests from outside."""

from __future__ import annotations

from dataclasses import astuple
from typing import NamedTuple

from sarah.control.parameters import Parameters
from sarah.control.pattern_generator import Phase
from sarah.control.supervisor import State, Supervisor
from sarah.drivers.loop import LoopTick
from sarah.remote.answers import Answer, Outcome


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
