"""A learner and its robot: the same windows through a socket as in one process, and what happens if the robot goes."""

import dataclasses
import math
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from typing import Any

import pytest
from listening import free_port, running
from operated import quick

from sarah.drivers.loop import ControlLoop
from sarah.drivers.simulated_robot import simulated_loop
from sarah.episode.from_mapping import from_mapping
from sarah.episode.push import NO_PUSH
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.errors import ConfigurationError, RobotError
from sarah.operation.settings import SHIPPED, OperationConfig
from sarah.operation.window import FELT, Window
from sarah.remote.answers import Answer, Measured, Outcome
from sarah.remote.client import Client
from sarah.remote.driven_robot import DrivenRobot
from sarah.remote.endpoints import Endpoint
from sarah.remote.identity import identity_of, settings_of
from sarah.remote.measurement import Meter
from sarah.remote.remote_robot import Connection, RemoteRobot
from sarah.remote.requests import LearnedWith, Request
from sarah.remote.server import Server
from sarah.remote.slot import Slot
from sarah.training.session_learners import LEARNERS


def simulated(engine: str) -> tuple[ControlLoop, Slot, BalanceConfig]:
    """A robot with weak servos and coarse physics."""
    settings = {"engine": engine, "physics": {"rate": 200, "solver_iterations": 5}, "supervisor": {"enabled": True}}
    weak = {"randomisation": {"actuator_bandwidth": 12.0}, "box_half_width": 100.0, "push": {"newtons": 0.0}}
    config = from_mapping(BalanceConfig(push=NO_PUSH), {**settings, **weak})
    robot, loop = simulated_loop(EpisodeSpec(SHIPPED[5:], 3, BALANCE, config), goes_on=True)
    return loop, Slot(loop.dt, 1.0, Meter(config, robot)), config


def learn(learner: str, config: OperationConfig, connect: Callable[[], Connection]) -> list[Window]:
    windows: list[Window] = []
    with closing(RemoteRobot(config, connect, "learner", windows.append, pause=lambda seconds: None)) as robot:
        robot.leave(LEARNERS[learner](robot, SHIPPED, 0))
    return windows


@pytest.mark.parametrize("learner", ["careful", "random"])
def test_windows_through_a_socket_are_those_of_one_process(engine: str, learner: str) -> None:
    pytest.importorskip("zenoh")
    loop, slot, settings = simulated(engine)
    config = dataclasses.replace(quick(minutes=0.15), robot=settings_of(identity_of(settings, "it", True, True)))
    driven = DrivenRobot(loop, slot)
    expected = learn(learner, config, lambda: driven)
    loop.driver.close()
    endpoint, is_over = Endpoint(f"tcp/127.0.0.1:{free_port()}"), threading.Event()
    loop, slot, _ = simulated(engine)
    with closing(Server(endpoint, LearnedWith(), slot, None, lambda: not is_over.is_set())) as server:
        loop.observers = (*loop.observers, server)
        with running(loop):
            try:
                found = learn(learner, config, lambda: Client(endpoint))
            finally:
                is_over.set()
    loop.driver.close()
    assert found == expected and len(found) > 4
    assert all(window.score is not None for window in found) and any(window.observed_reward > 0.1 for window in found)
    assert any(window.fell for window in found) == (learner == "random")


MEASURED = Measured(0.8, None, False, (0.0,) * len(FELT), 6.1, 3.0, 300, 600, "")


class Scripted:
    """A connection that answers what a test says, or breaks."""

    def __init__(self, script: Sequence[Any]) -> None:
        self.script = list(script)
        self.requests: list[Request] = []

    def __call__(self) -> "Scripted":
        if self.script and self.script[0] == "nobody":
            self.script.pop(0)
            raise RobotError("no robot listens")
        return self

    def window(self, request: Request, seconds: float) -> Iterator[Answer | Measured]:
        self.requests.append(request)
        while True:
            message = self.script.pop(0)
            if message == "breaks":
                raise RobotError("the robot has gone")
            yield message

    def close(self) -> None:
        pass


APPLIED = Answer(Outcome.APPLIED, "", False)


def remote(script: Sequence[Any], gone_seconds: float = 60.0) -> tuple[RemoteRobot, Scripted, list[str]]:
    connection, said = Scripted(script), list[str]()
    robot = RemoteRobot(
        quick(), connection, "me", gone_seconds=gone_seconds, say=said.append, pause=lambda seconds: None
    )
    return robot, connection, said


OVERTAKEN = Answer(Outcome.OVERTAKEN, "newer parameters came before it was over")
REFUSED = Answer(Outcome.REFUSED, "P1 would change by 1.9")


@pytest.mark.parametrize(
    ("script", "words"),
    [
        ([APPLIED, OVERTAKEN], "another process operates the robot for the same session"),
        ([REFUSED], "the robot refuses the parameters of window 0: P1 would change by 1"),
        (["nobody"] * 3, "gave up after 0 s"),  # a robot that has gone for long
        (["breaks"], "gave up after 0 s"),
        ([Answer(Outcome.ENDED, "the robot has gone")], "gave up after 0 s"),
    ],
)
def test_what_ends_a_session_is_not_asked_again(script: list[Any], words: str) -> None:
    robot, connection, _ = remote(script, gone_seconds=0.0)
    with pytest.raises(ConfigurationError if script == [REFUSED] else RobotError, match=words):
        robot.run(SHIPPED)
    assert len(connection.requests) == (script != ["nobody"] * 3) and robot.windows == 0


def test_a_lost_window_is_asked_for_again_and_one_hears_why() -> None:
    lost = [APPLIED, "breaks", "nobody", "nobody", Answer(Outcome.BUSY, "a learner operates the robot")]
    stood = [APPLIED, Answer(Outcome.STOPPED, "asked to stand"), Answer(Outcome.WAITING, "it stands", False)]
    waited = [Answer(Outcome.WAITING, "it stands"), Answer(Outcome.WAITING, "it stands", False)]
    robot, connection, said = remote(
        [*lost, *stood, *waited, APPLIED, dataclasses.replace(MEASURED, reason="stopping: stale")]
    )
    window = robot.run(SHIPPED)
    assert (window.index, window.begin, window.seconds, window.observed_reward) == (0, 0.0, 6.1, 0.8)
    assert window.score is None and window.worth == 0.8 and window.parameters == SHIPPED
    assert robot.seconds == 6.1 and robot.windows == 1
    assert len(connection.requests) == 5 and len(set(map(Request.to_json, connection.requests))) == 1
    assert [words.partition(";")[0] for words in said] == [
        "the robot has gone",
        "no robot listens",
        "busy: a learner operates the robot",
        "the robot has the parameters of window 0",
        "stopped: asked to stand",
        "it stands",
        "the robot has the parameters of window 0",
        "window 0: stopping: stale",
    ]


def test_a_window_of_things_that_are_no_numbers_is_none() -> None:
    for change in ({"felt": ("a",) * len(FELT)}, {"felt": ()}, {"seconds": 0.0}, {"score": math.nan}, {"fell": 1}):
        with pytest.raises(ValueError):
            dataclasses.replace(MEASURED, **change)
