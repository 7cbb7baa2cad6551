"""Windows that a robot measures of itself, by hand-made ticks: when they begin, what ends them, and who may ask."""

from typing import Any

import pytest
from hand_made import DT
from hypothesis import given, settings
from hypothesis import strategies as st
from listening import Rig, outcomes

from sarah.control.parameters import PAPER_STEPPING
from sarah.control.supervisor import State
from sarah.episode.push import PushedConfig
from sarah.operation.window import FELT
from sarah.remote.answers import Answer, Measured, Outcome
from sarah.remote.measurement import Meter
from sarah.remote.moment import present
from sarah.remote.slot import LEARNER_SECONDS, Slot

MEASURES: dict[str, Any] = {"largest_change": 1.0, "meter": Meter(PushedConfig())}


def window(rig: Rig, learner: str = "one", **values: float) -> list[Any]:
    return rig.ask("window", learner, **values)


@pytest.fixture
def rig() -> Rig:
    rig = Rig(**MEASURES)
    rig.step(300)
    return rig


def test_a_window_settles_and_is_measured_from_a_swap_of_legs_on(rig: Rig) -> None:
    answers = window(rig, V1=0.5)
    asked = rig.ticks - 1
    rig.step(400)
    applied, found = answers
    assert applied.outcome is Outcome.APPLIED and not applied.is_final and applied.tick == found.tick
    assert present(rig.supervisor)[5] == 0.5
    assert found.ticks == 300 and found.began == pytest.approx(found.tick * DT) and found.tick > asked
    assert found.seconds == pytest.approx((found.tick + 301 - asked) * DT)
    assert 0.3 < found.observed_reward < 1.0 and found.score is None and not found.fell and not found.reason
    felt = dict(zip(FELT, found.felt, strict=True))
    assert felt["steps_per_second"] == pytest.approx(3.0, abs=0.6) and felt["a_z_mean"] == pytest.approx(9.81, abs=0.1)
    assert rig.slot.is_idle


def test_a_robot_that_stopped_steps_again_after_a_second(rig: Rig) -> None:
    rig.supervisor.stand("a fault")
    rig.step(100)
    assert rig.supervisor.is_waiting
    answers = window(rig, V1=0.5)
    rig.step(402)
    assert outcomes(answers) == ["applied", "window"] and answers[1].ticks == 400
    assert rig.supervisor.state is State.STEPPING


def test_one_that_stops_is_measured_to_the_end_and_told(rig: Rig) -> None:
    answers = window(rig, V1=0.5)
    rig.step(50)
    rig.step(350, gone=True)
    assert outcomes(answers) == ["applied", "window"]
    assert answers[1].ticks == 300 and answers[1].observed_reward < 0.3 and "stopping: stale" in answers[1].reason


def test_parameters_that_were_put_back_end_their_window(rig: Rig) -> None:
    rig.step(500)  # the first ones are proven
    answers = window(rig, P1=2.0, P2=2.0)
    while not answers:
        rig.step(1)
    rig.step(300, still=True)
    assert outcomes(answers) == ["applied", "window"]
    assert answers[1].reason.startswith("the parameters before are back: no step for 2.0 s")
    assert answers[1].ticks < 300 and answers[1].observed_reward < 0.3
    assert present(rig.supervisor)[:2] == PAPER_STEPPING[:2]


def test_who_lets_the_robot_stand_stops_the_learner(rig: Rig) -> None:
    answers = window(rig, V1=0.5)
    rig.step(100)
    assert outcomes(rig.ask("stand")) == ["applied"] and outcomes(answers) == ["applied", "stopped"]
    rig.step(100)
    again = window(rig, V1=0.5)
    rig.step(300)
    assert outcomes(again) == ["waiting"] and rig.supervisor.is_waiting
    assert again[0].reason == "somebody asked the robot to stand: sarah-push --step lets it go on"
    rig.ask("step")
    rig.step(500)
    assert outcomes(again)[-2:] == ["applied", "window"]


def test_the_robot_is_its_learners_until_that_leaves_it(rig: Rig) -> None:
    first = window(rig, V1=0.5)
    assert outcomes(window(rig, learner="two", V1=0.4)) == ["busy"] == outcomes(rig.ask("push", V1=0.4))
    again = window(rig, V1=0.6)
    rig.step(400)
    assert outcomes(first)[-1] == "overtaken" and outcomes(again)[-1] == "window"
    assert outcomes(rig.ask("push", V1=0.4)) == ["busy"]
    rig.now += LEARNER_SECONDS
    two = window(rig, learner="two", V1=0.4)
    rig.step(400)
    assert outcomes(two)[-1] == "window" and outcomes(window(rig, V1=0.5)) == ["busy"]
    left = rig.ask("push", "two", V1=0.3)
    rig.step(99)
    one = window(rig, V1=0.5)
    rig.step(400)
    assert outcomes(left) == ["applied", "overtaken"] and outcomes(one)[-1] == "window"


@pytest.mark.parametrize("somebody_objects", [False, True])
def test_a_robot_that_fell_steps_again_if_nobody_objects(rig: Rig, somebody_objects: bool) -> None:
    answers = window(rig, V1=0.5)
    rig.step(200, lies=True)
    assert outcomes(answers) == ["applied", "window"] and answers[1].fell and rig.supervisor.has_fallen
    if somebody_objects:
        assert outcomes(rig.ask("stand")) == ["refused"]
    again = window(rig, V1=0.5)
    rig.step(150, still=True)
    assert outcomes(again) == ["waiting"] and rig.supervisor.has_fallen
    if somebody_objects:
        rig.step(300, still=True)
        assert outcomes(again) == ["waiting"] and rig.supervisor.has_fallen
        rig.ask("step")
    rig.step(900, still=True)
    assert outcomes(again)[-2:] == ["applied", "window"]


def test_a_learner_that_has_gone_moves_no_robot_put_up_later(rig: Rig) -> None:
    window(rig, V1=0.5)
    rig.step(200, lies=True)
    again = window(rig, V1=0.5)
    rig.step(600, lies=True)
    assert outcomes(again) == ["waiting", "waiting"] and again[1].is_final and rig.slot.is_idle
    rig.step(500, still=True)
    assert rig.supervisor.has_fallen
    assert outcomes(rig.ask("push", V1=0.4)) == ["busy"]
    rig.now += LEARNER_SECONDS
    assert outcomes(rig.ask("push", V1=0.4)) == ["applied"] and rig.supervisor.has_fallen


def test_the_time_of_waiting_counts_from_the_first_request_on(rig: Rig) -> None:
    window(rig, V1=0.5)
    rig.step(200, lies=True)
    first = rig.ticks
    window(rig, V1=0.5)
    rig.step(600, lies=True)
    again = window(rig, V1=0.5)
    rig.step(800, still=True)
    assert again[-1].seconds == pytest.approx((again[-1].tick + again[-1].ticks + 1 - first) * DT)


class Lying:
    """What is true of a robot that lies, until a test puts it up."""

    position, has_fallen = (0.0, 0.0, 0.9), True


def test_a_robot_that_lies_is_measured_once_it_is_put_up(rig: Rig) -> None:
    truth = Lying()
    rig.slot = Slot(DT, 1.0, Meter(PushedConfig(), truth))
    rig.step(110)
    answers = window(rig, V1=0.5)
    rig.step(300)
    assert outcomes(answers) == ["waiting"] and answers[0].reason.startswith("the robot has fallen")
    truth.has_fallen = False
    rig.step(200)
    truth.has_fallen = True
    rig.step(5)
    assert outcomes(answers) == ["waiting", "applied", "window"] and answers[2].fell
    assert 0.0 < answers[2].ticks * DT < 2.0 and answers[2].score is not None


def test_a_robot_without_a_meter_measures_nothing() -> None:
    rig = Rig()
    (answer,) = window(rig, V1=0.5)
    assert isinstance(answer, Answer) and answer.reason == "this robot measures no windows"


EVENTS = ("one", "one", "two", "push", "stand", "step", "still", "gone", "late", "nothing")


@settings(max_examples=20)
@given(st.lists(st.sampled_from(EVENTS), max_size=25))
def test_whoever_asks_gets_one_last_answer_whatever_happens(events: list[str]) -> None:
    rig, asked = Rig(**MEASURES), list[list[Any]]()
    rig.step(150)
    for event in events:
        if event in ("one", "two"):
            asked.append(window(rig, learner=event, V1=round(0.01 * len(asked), 2)))
        elif event == "push":
            asked.append(rig.ask("push", V1=round(0.01 * len(asked), 2)))
        elif event in ("stand", "step"):
            asked.append(rig.ask(event))
        elif event == "late":
            rig.now += LEARNER_SECONDS
        rig.step(70, still=event == "still", gone=event == "gone")
    rig.slot.close("the end")
    for answers in asked:
        is_last = [isinstance(one, Measured) or one.is_final for one in answers]
        assert sum(is_last) == 1 and is_last[-1]
    windows = [one for answers in asked for one in answers if isinstance(one, Measured)]
    assert all(0 < window.ticks <= 400 and 0.0 <= window.observed_reward <= 1.0 for window in windows)
