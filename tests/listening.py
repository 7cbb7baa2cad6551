"""Robots that step by hand-made readings: one that listens, in a thread, and one whose slot is ticked by hand."""

import socket
import threading
from collections.abc import Iterator
from contextlib import closing, contextmanager
from typing import Any

from hand_made import BALANCE, DT, heard

from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import Phase, PhaseChange, SteppingParameters
from sarah.control.supervisor import State, Supervisor
from sarah.control.watches import SupervisorSettings
from sarah.drivers.driver import Driver, TimedReading
from sarah.drivers.loop import ControlLoop, LoopTick
from sarah.drivers.real_time import RealTime
from sarah.remote.answers import Measured
from sarah.remote.endpoints import Endpoint
from sarah.remote.requests import LearnedWith, Request, WindowTimes
from sarah.remote.server import Server
from sarah.remote.slot import Asked, Slot
from sarah.robot.reading import SensorReading

FIRST = 101
"""Number of ticks in which a push waits: the loop gives the robot its own parameters in the last of them."""
FASTER = 5
"""Number by which time passes faster than by the clock."""


class Rocking(Driver):
    """A robot that rocks from foot to foot, once it has stood."""

    def __init__(self) -> None:
        self.ticks = 0

    def now(self) -> float:
        return self.ticks * DT

    def read(self) -> TimedReading:
        self.ticks += 1
        return TimedReading(heard(self.ticks), self.now())

    def send(self, targets: tuple[float, ...]) -> None:
        pass


def steps() -> Supervisor:
    enabled = SupervisorSettings(enabled=True)
    return Supervisor(SteppingParameters(*PAPER_STEPPING), BALANCE, DT, settings=enabled)


class Rig:
    """A slot in a loop. Its supervisor hears a robot that rocks from foot to foot once it has stood."""

    def __init__(self, supervisor: Any = None, **of_slot: Any) -> None:
        self.supervisor: Any = supervisor or steps()
        self.now, self.ticks, self.swaps = 0.0, 0, list[int]()
        self.slot = Slot(DT, clock=lambda: self.now, **of_slot)

    def request(self, kind: str = "push", learner: str = "", **values: float) -> tuple[Asked, list[Any]]:
        """A request to arrive, and the answers to it, which grow."""
        window = WindowTimes(1.0, 2.0) if kind == "window" else None
        answers: list[Any] = []
        return Asked(Request(kind, values, window=window, learner=learner), answers.append), answers

    def ask(self, kind: str = "push", learner: str = "", **values: float) -> list[Any]:
        """Answers to something that is asked in one tick."""
        asked, answers = self.request(kind, learner, **values)
        self.step(1, asked)
        return answers

    def step(
        self, ticks: int = 1, *arrived: Asked, still: bool = False, gone: bool = False, lies: bool = False
    ) -> None:
        """Ticks of a robot that rocks, stands still, lies or has gone."""
        for _ in range(ticks):
            reading: SensorReading | None = None if gone else heard(self.ticks, still or lies)
            if reading is not None and lies:
                x, y, z = reading.acceleration
                reading = reading._replace(acceleration=(x, y + 9.0, z - 8.0))
            self.tick(*arrived, change=self.supervisor.tick(reading), reading=reading)
            arrived = ()

    def tick(self, *arrived: Asked, change: PhaseChange | None = None, reading: SensorReading | None = None) -> None:
        """One tick of the slot; notes where the legs swap, or begin to step."""
        if change is not None and change.ended in (Phase.STAND, Phase.LAND):
            self.swaps += [self.ticks] * (self.supervisor.state is State.STEPPING and self.ticks >= FIRST - 1)
        tick = LoopTick(self.ticks * DT, reading, 0.0, self.supervisor, change, 0.0)
        self.slot.tick(tick, self.supervisor, arrived)
        self.ticks += 1


def outcomes(answers: list[Any]) -> list[str]:
    return ["window" if isinstance(one, Measured) else one.outcome.value for one in answers]


def free_port() -> int:
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return int(found.getsockname()[1])


@contextmanager
def running(loop: ControlLoop) -> Iterator[None]:
    stop = threading.Event()

    def run() -> None:
        while not stop.is_set():
            loop.tick()

    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield
    finally:
        stop.set()
        thread.join()


@contextmanager
def robot(endpoint: Endpoint) -> Iterator[ControlLoop]:
    with closing(Server(endpoint, LearnedWith(), Slot(DT))) as server:
        supervisor = steps()
        loop = ControlLoop(Rocking(), supervisor, *supervisor.asked, DT, RealTime(DT / FASTER), [server])
        with running(loop):
            yield loop
