"""The slot for new parameters, by hand-made ticks: when a push is applied, and what its pusher hears."""

from dataclasses import replace
from typing import Any

import pytest
from hand_made import BALANCE, DT, heard
from hypothesis import given, settings
from hypothesis import strategies as st

from sarah.control.hip_law import BalanceParameters
from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import Phase, PhaseChange, SteppingParameters
from sarah.control.supervisor import State, Supervisor
from sarah.control.watches import SupervisorSettings
from sarah.drivers.loop import LoopTick
from sarah.remote.answers import Outcome
from sarah.remote.moment import present
from sarah.remote.requests import Request
from sarah.remote.slot import Asked, Slot

SWAP = PhaseChange(Phase.LAND, by_sensors=True, is_step=True)
FIRST = 101
"""Number of ticks in which a push waits: the loop gives the robot its own parameters in the last of them."""


class Rig:
    """A slot in a loop, whose supervisor is ticked with readings, or set to a state by hand."""

    def __init__(self, supervisor: Any = None) -> None:
        settings = SupervisorSettings(enabled=True)
        steps = Supervisor(SteppingParameters(*PAPER_STEPPING), BALANCE, DT, settings=settings)
        self.supervisor: Any = supervisor or steps
        self.slot = Slot(DT)
        self.ticks = 0
        self.swaps: list[int] = []
        self.answers: list[list[Any]] = []

    def ask(self, kind: str = "push", **values: float) -> Asked:
        self.answers.append([])
        return Asked(Request(kind, values), self.answers[-1].append)

    def tick(self, *arrived: Asked, change: PhaseChange | None = None) -> None:
        if (
            change is not None
            and change.ended in (Phase.STAND, Phase.LAND)
            and self.supervisor.state is State.STEPPING
            and self.ticks >= FIRST - 1
        ):
            self.swaps.append(self.ticks)
        seen = LoopTick(self.ticks * DT, None, 0.0, self.supervisor, change, 0.0)
        self.slot.tick(seen, self.supervisor, arrived)
        self.ticks += 1

    def step(self, ticks: int = 1, *arrived: Asked, still: bool = False) -> None:
        """Ticks of a robot that rocks from foot to foot, once it has stood, or that stands still."""
        for _ in range(ticks):
            change = self.supervisor.tick(heard(self.ticks, still))
            self.tick(*arrived, change=change)
            arrived = ()

    def outcomes(self, index: int = -1) -> list[str]:
        return [answer.outcome.value for answer in self.answers[index]]


def test_it_is_applied_when_the_legs_swap_and_kept_after_five_seconds() -> None:
    rig = Rig()
    rig.step(300)
    swaps = len(rig.swaps)
    rig.step(1, rig.ask(V1=0.5, P4=0.3))
    assert rig.outcomes() == [] and present(rig.supervisor)[5] == BALANCE.V1
    while len(rig.swaps) == swaps:
        rig.step()
    (applied,) = rig.answers[-1]
    assert applied.outcome is Outcome.APPLIED and applied.tick == rig.swaps[-1] and not applied.is_final
    assert applied.seconds == pytest.approx(rig.swaps[-1] * DT) and (applied.state, applied.phase) == (
        "stepping",
        "shift",
    )
    assert present(rig.supervisor) == (0.4, 1.3, 0.1, 0.3, 1.0, 0.5, *present(rig.supervisor)[6:])
    rig.step(600)
    _, kept = rig.answers[-1]
    assert kept.outcome is Outcome.KEPT and kept.is_final and kept.tick == rig.swaps[swaps] + 501


def test_one_that_does_not_step_is_replaced_and_its_pusher_hears_why() -> None:
    rig = Rig()
    rig.step(800)  # the first ones are proven
    rig.step(100, rig.ask(P1=2.0, P2=2.0))
    rig.step(400, still=True)
    assert rig.outcomes() == ["applied", "replaced"]
    assert rig.answers[-1][1].reason == "the parameters before are back: no step for 2.0 s"
    assert present(rig.supervisor)[:2] == PAPER_STEPPING[:2]


def test_a_robot_that_stands_takes_them_at_once_and_tries_them_when_it_steps() -> None:
    rig = Rig()
    rig.step(50, rig.ask(V1=0.2))
    assert rig.outcomes() == []  # the loop's own would take their place
    rig.step(51)
    assert [answer.tick for answer in rig.answers[0]] == [FIRST - 1]
    rig.step(100)
    rig.step(20, rig.ask("stand"))
    assert rig.outcomes(0) == ["applied", "stopped"] and rig.answers[0][1].reason == "asked to stand"
    assert rig.supervisor.is_waiting
    rig.step(1, rig.ask("stand"))
    assert rig.outcomes() == ["applied"] and rig.supervisor.is_waiting
    rig.step(1, rig.ask(V1=0.3))
    assert rig.outcomes() == ["applied"] and rig.answers[-1][0].is_final and rig.answers[-1][0].reason
    rig.step(1, rig.ask("step"))
    rig.step(1, rig.ask("step"))
    assert rig.outcomes(-2) == ["applied"] and rig.outcomes() == ["refused"]
    rig.step(150)
    assert rig.supervisor.state is State.STEPPING and rig.supervisor.generator.hips.parameters.V1 == 0.3


def test_one_that_was_asked_to_stand_in_the_same_tick_does_not_step_already() -> None:
    rig = Rig()
    rig.step(300)
    rig.step(1, rig.ask("stand"), rig.ask("step"))
    assert rig.outcomes(0) == ["applied"] and rig.answers[1][0].reason == "the robot stops: ask again when it stands"
    rig.step(100)
    assert rig.supervisor.is_waiting


def test_newer_parameters_take_the_slot_and_the_place_on_trial() -> None:
    rig = Rig()
    rig.step(300)
    rig.step(1, rig.ask(V1=0.1), rig.ask(V1=0.2))
    rig.step(100)
    rig.step(100, rig.ask(V1=0.3))
    assert (
        rig.outcomes(0) == ["overtaken"]
        and rig.outcomes(1) == ["applied", "overtaken"]
        and rig.outcomes(2) == ["applied"]
    )
    rig.slot.close("the end")
    assert rig.outcomes(2) == ["applied", "ended"] and rig.answers[2][1].reason == "the end"


def test_a_large_change_is_refused_also_when_others_came_back_meanwhile() -> None:
    rig = Rig()
    rig.step(300)
    rig.step(1, rig.ask(V3=-1.5), rig.ask(V1=-2.0))
    rig.step(1, rig.ask(V1=-2.0, V3=2.0))
    rig.step(100)
    assert rig.outcomes(1) == ["overtaken"] and rig.outcomes(2) == ["applied"]
    rig.step(1, rig.ask(V3=-1.7))
    assert rig.outcomes() == ["refused"]
    assert rig.answers[-1][0].reason == "V3 would change by 3.7, and may change by 3.6"
    rig.tick(rig.ask(V2=-1.8))
    rig.supervisor.set_parameters(balance=replace(BALANCE, V2=1.9))
    rig.step(100)
    assert rig.outcomes() == ["refused"] and present(rig.supervisor)[6] == 1.9


class Scripted:
    """A supervisor whose state a test sets."""

    def __init__(self, state: State = State.STEPPING) -> None:
        self.state, self.phase, self.state_change = state, Phase.SHIFT, None
        self.asked = SteppingParameters(*PAPER_STEPPING), BALANCE
        self.proven = self.asked
        self.is_waiting, self.is_upright = state is State.FALLEN, True

    @property
    def has_fallen(self) -> bool:
        return self.state is State.FALLEN

    @property
    def is_proven(self) -> bool:
        return self.asked == self.proven

    def set_parameters(self, stepping: SteppingParameters, balance: BalanceParameters) -> None:
        self.asked = stepping, balance

    def happens(self, event: str) -> None:
        """What a supervisor may do in a tick."""
        if event == "prove" and self.state is State.STEPPING:
            self.proven = self.asked
        elif event == "put back" and self.state is State.STEPPING:
            self.asked = self.proven
        elif event == "stop" and self.state is State.STEPPING:
            self.state = State.STOPPING
        elif event == "stopped" and self.state is State.STOPPING:
            self.state, self.is_waiting = State.STANDING, True
        elif event == "step" and self.is_waiting:
            self.state, self.is_waiting = State.STEPPING, False


def scripted(state: State = State.STEPPING) -> Rig:
    rig = Rig(Scripted(state))
    for _ in range(FIRST):
        rig.tick()
    return rig


def test_a_push_of_the_first_second_is_compared_with_the_robots_own_parameters() -> None:
    rig = Rig()
    rig.step(50, rig.ask(V1=-1.9))
    rig.supervisor.set_parameters(balance=replace(BALANCE, V1=1.9))  # the loop's
    rig.step(100)
    assert rig.outcomes() == ["refused"]


def test_a_robot_that_has_fallen_takes_them_and_does_not_stand() -> None:
    rig = scripted(State.FALLEN)
    rig.tick(rig.ask("stand"), rig.ask(V1=0.4))
    assert rig.outcomes(0) == ["refused"] and rig.outcomes(1) == ["applied"] and rig.answers[1][0].state == "fallen"


def test_a_robot_that_stops_takes_nothing_before_it_stands() -> None:
    rig = scripted(State.STOPPING)
    rig.tick(rig.ask("step"), rig.ask(V1=0.4), change=SWAP)
    assert rig.outcomes(0) == ["refused"] and "ask again when it stands" in rig.answers[0][0].reason
    assert rig.outcomes(1) == []
    rig.supervisor.happens("stopped")
    rig.tick()
    assert rig.outcomes(1) == ["applied"]


EVENTS = ("nothing", "nothing", "swap", "push", "push", "prove", "put back", "stop", "stopped", "step")


@settings(max_examples=200)
@given(st.lists(st.sampled_from(EVENTS), max_size=40))
def test_each_pusher_gets_one_final_answer_and_the_newest_wins(events: list[str]) -> None:
    rig, arrivals = scripted(), list[int]()
    for event in events:
        rig.supervisor.happens(event)
        arrived = []
        if event == "push":
            arrivals.append(rig.ticks)
            arrived.append(rig.ask(V1=round(0.01 * len(arrivals), 2)))
        rig.tick(*arrived, change=SWAP if event == "swap" else None)
    rig.slot.close("the end")
    for arrival, (*before, last) in zip(arrivals, rig.answers, strict=True):
        assert last.is_final and not any(answer.is_final for answer in before) and len(before) <= 1
        applied = [answer for answer in (*before, last) if answer.outcome is Outcome.APPLIED]
        if applied and applied[0].state == "stepping":
            assert applied[0].tick == next(swap for swap in rig.swaps if swap >= arrival)
    ticks = [answers[0].tick for answers in rig.answers if answers[0].outcome is Outcome.APPLIED]
    assert len(set(ticks)) == len(ticks) and ticks == sorted(ticks, key=lambda tick: tick or 0)
