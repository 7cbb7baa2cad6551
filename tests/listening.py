"""A robot that steps by hand-made readings in a thread, and listens."""

import socket
import threading
from collections.abc import Iterator
from contextlib import closing, contextmanager

from hand_made import BALANCE, DT, heard

from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import SteppingParameters
from sarah.control.supervisor import Supervisor
from sarah.control.watches import SupervisorSettings
from sarah.drivers.driver import Driver, TimedReading
from sarah.drivers.loop import ControlLoop
from sarah.drivers.real_time import RealTime
from sarah.remote.endpoints import Endpoint
from sarah.remote.requests import LearnedWith
from sarah.remote.server import Server
from sarah.remote.slot import Slot

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


def free_port() -> int:
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return int(found.getsockname()[1])


@contextmanager
def robot(endpoint: Endpoint) -> Iterator[ControlLoop]:
    """A robot that steps and listens."""
    stepping, stop = SteppingParameters(*PAPER_STEPPING), threading.Event()
    controller = Supervisor(stepping, BALANCE, DT, settings=SupervisorSettings(enabled=True))
    with closing(Server(endpoint, LearnedWith(), Slot(DT))) as server:
        loop = ControlLoop(Rocking(), controller, stepping, BALANCE, DT, RealTime(DT / FASTER), [server])

        def run() -> None:
            while not stop.is_set():
                loop.tick()

        thread = threading.Thread(target=run)
        thread.start()
        try:
            yield loop
        finally:
            stop.set()
            thread.join()
