"""The slot for new parameters, by hand-made ticks: when a push is applied, and what its pusher hears."""

from dataclasses import replace
from typing import Any

import pytest
from hand_made import BALANCE, DT
from hypothesis import given, settings
from hypothesis import strategies as st
from listening import FIRST, Rig, outcomes

from sarah.control.hip_law import BalanceParameters
from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import Phase, PhaseChange, SteppingParameters
from sarah.control.supervisor import State
from sarah.remote.answers import Outcome
from sarah.remote.moment import present

SWAP = PhaseChange(Phase.LAND, by_sensors=True, is_step=True)


def test_it_is_applied_when_legs_swap_and_kept_in_five_seconds() -> None:
    rig = Rig()
    rig.step(300)
    swaps = len(rig.swaps)
    answers = rig.ask(V1=0.5, P4=0.3)
    assert answers == [] and present(rig.supervisor)[5] == BALANCE.V1
    while len(rig.swaps) == swaps:
        rig.step()
    (applied,) = answers
    assert applied.outcome is Outcome.APPLIED and applied.tick == rig.swaps[-1] and not applied.is_final
    assert applied.seconds == pytest.approx(rig.swaps[-1] * DT)
    assert (applied.state, applied.phase) == ("stepping", "shift")
    assert present(rig.supervisor) == (0.4, 1.3, 0.1, 0.3, 1.0, 0.5, *present(rig.supervisor)[6:])
    rig.step(600)
    _, kept = answers
    assert kept.outcome is Outcome.KEPT and kept.is_final and kept.tick == rig.swaps[swaps] + 501


def test_one_that_does_not_step_is_replaced_and_one_hears_why() -> None:
    rig = Rig()
    rig.step(800)  # the first ones are proven
    answers = rig.ask(P1=2.0, P2=2.0)
    rig.step(99)
    rig.step(400, still=True)
    assert outcomes(answers) == ["applied", "replaced"]
    assert answers[1].reason == "the parameters before are back: no step for 2.0 s"
    assert present(rig.supervisor)[:2] == PAPER_STEPPING[:2]


def test_a_robot_that_stands_takes_them_and_tries_them_later() -> None:
    rig = Rig()
    first = rig.ask(V1=0.2)
    rig.step(49)
    assert first == []  # the loop's own would take their place
    rig.step(51)
    assert [answer.tick for answer in first] == [FIRST - 1]
    rig.step(100)
    rig.ask("stand")
    rig.step(19)
    assert outcomes(first) == ["applied", "stopped"] and first[1].reason == "asked to stand"
    assert rig.supervisor.is_waiting
    assert outcomes(rig.ask("stand")) == ["applied"] and rig.supervisor.is_waiting
    (applied,) = rig.ask(V1=0.3)
    assert applied.outcome is Outcome.APPLIED and applied.is_final and applied.reason
    assert outcomes(rig.ask("step")) == ["applied"] and outcomes(rig.ask("step")) == ["refused"]
    rig.step(150)
    assert rig.supervisor.state is State.STEPPING and rig.supervisor.generator.hips.parameters.V1 == 0.3


def test_one_asked_to_stand_in_the_same_tick_does_not_step() -> None:
    rig = Rig()
    rig.step(300)
    (stand, answers), (step, others) = rig.request("stand"), rig.request("step")
    rig.step(1, stand, step)
    assert outcomes(answers) == ["applied"] and others[0].reason == "the robot stops: ask again when it stands"
    rig.step(100)
    assert rig.supervisor.is_waiting


def test_newer_parameters_take_the_slot_and_the_place_on_trial() -> None:
    rig = Rig()
    rig.step(300)
    (first, answers), (second, others) = rig.request(V1=0.1), rig.request(V1=0.2)
    rig.step(101, first, second)
    third = rig.ask(V1=0.3)
    rig.step(99)
    assert [outcomes(one) for one in (answers, others, third)] == [["overtaken"], ["applied", "overtaken"], ["applied"]]
    rig.slot.close("the end")
    assert outcomes(third) == ["applied", "ended"] and third[1].reason == "the end"


def test_a_large_change_is_refused_also_if_others_came_back() -> None:
    rig = Rig()
    rig.step(300)
    (first, _), (second, overtaken) = rig.request(V3=-1.5), rig.request(V1=-2.0)
    rig.step(1, first, second)
    applied = rig.ask(V1=-2.0, V3=2.0)
    rig.step(100)
    assert outcomes(overtaken) == ["overtaken"] and outcomes(applied) == ["applied"]
    (refused,) = rig.ask(V3=-1.7)
    assert refused.outcome is Outcome.REFUSED
    assert refused.reason == "V3 would change by 3.7, and may change by 3.6"
    asked, answers = rig.request(V2=-1.8)
    rig.tick(asked)
    rig.supervisor.set_parameters(balance=replace(BALANCE, V2=1.9))
    rig.step(100)
    assert outcomes(answers) == ["refused"] and present(rig.supervisor)[6] == 1.9


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


def test_a_push_of_the_first_second_is_compared_with_the_own() -> None:
    rig = Rig()
    answers = rig.ask(V1=-1.9)
    rig.step(49)
    rig.supervisor.set_parameters(balance=replace(BALANCE, V1=1.9))  # the loop's
    rig.step(100)
    assert outcomes(answers) == ["refused"]


def test_a_robot_that_has_fallen_takes_them_and_does_not_stand() -> None:
    rig = scripted(State.FALLEN)
    (stand, answers), (push, others) = rig.request("stand"), rig.request(V1=0.4)
    rig.tick(stand, push)
    assert outcomes(answers) == ["refused"] and outcomes(others) == ["applied"] and others[0].state == "fallen"


def test_a_robot_that_stops_takes_nothing_before_it_stands() -> None:
    rig = scripted(State.STOPPING)
    (step, answers), (push, others) = rig.request("step"), rig.request(V1=0.4)
    rig.tick(step, push, change=SWAP)
    assert outcomes(answers) == ["refused"] and "ask again when it stands" in answers[0].reason and others == []
    rig.supervisor.happens("stopped")
    rig.tick()
    assert outcomes(others) == ["applied"]


EVENTS = ("nothing", "nothing", "swap", "push", "push", "prove", "put back", "stop", "stopped", "step")


@settings(max_examples=200)
@given(st.lists(st.sampled_from(EVENTS), max_size=40))
def test_each_pusher_gets_one_final_answer_and_the_newest_wins(events: list[str]) -> None:
    rig, arrivals, heard = scripted(), list[int](), list[list[Any]]()
    for event in events:
        rig.supervisor.happens(event)
        arrived = []
        if event == "push":
            arrivals.append(rig.ticks)
            asked, answers = rig.request(V1=round(0.01 * len(arrivals), 2))
            arrived.append(asked)
            heard.append(answers)
        rig.tick(*arrived, change=SWAP if event == "swap" else None)
    rig.slot.close("the end")
    for arrival, (*before, last) in zip(arrivals, heard, strict=True):
        assert last.is_final and not any(answer.is_final for answer in before) and len(before) <= 1
        applied = [answer for answer in (*before, last) if answer.outcome is Outcome.APPLIED]
        if applied and applied[0].state == "stepping":
            assert applied[0].tick == next(swap for swap in rig.swaps if swap >= arrival)
    ticks = [answers[0].tick for answers in heard if answers[0].outcome is Outcome.APPLIED]
    assert len(set(ticks)) == len(ticks) and ticks == sorted(ticks, key=lambda tick: tick or 0)
