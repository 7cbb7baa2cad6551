"""Robots that run in real time and listen, for what is sent to them."""

import contextlib
import dataclasses
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import psutil

from experiments.record import ResultError
from sarah.control.pattern_generator import Phase
from sarah.control.supervisor import Supervisor
from sarah.drivers.loop import LoopTick
from sarah.drivers.real_time import RealTime
from sarah.drivers.simulated_robot import simulated_loop
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.push import NO_PUSH
from sarah.episode.spec import EpisodeSpec
from sarah.errors import RobotError
from sarah.remote.client import Client
from sarah.remote.endpoints import Endpoint
from sarah.remote.requests import LearnedWith
from sarah.remote.server import Server
from sarah.remote.slot import Slot

COMMAND = "import sys; from sarah.cli.{0} import main; sys.argv[0] = 'sarah-{0}'; main()"


@dataclass(frozen=True)
class Robot:
    """A robot that runs and listens.

    :param endpoint: where it listens
    :param process: its process
    :param swaps: ticks in which its legs have swapped, if that is known
    """

    endpoint: Endpoint
    process: psutil.Process
    swaps: Sequence[int] = ()

    @property
    def memory_mib(self) -> float:
        """Memory of its process, in MiB."""
        return float(self.process.memory_info().rss / 2**20)


def free_port() -> Endpoint:
    """An address at which nobody listens yet."""
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return Endpoint(f"tcp/127.0.0.1:{found.getsockname()[1]}")


@contextlib.contextmanager
def in_a_process(*options: str) -> Iterator[Robot]:
    """A robot that has begun to step, in a process of its own."""
    endpoint = free_port()
    words = ["balance", "--engine", "mujoco", "--real-time", "--listen", endpoint.address, "--seconds", "3590"]
    with running("robot", *words, *options) as process:
        _wait_for(endpoint)
        yield Robot(endpoint, psutil.Process(process.pid))


@contextlib.contextmanager
def running(command: str, *words: str) -> Iterator[subprocess.Popen[bytes]]:
    """A command of the package, which is killed in the end."""
    silent: dict[str, Any] = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    process = subprocess.Popen([sys.executable, "-c", COMMAND.format(command), *words], **silent)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def _wait_for(endpoint: Endpoint) -> None:
    """Wait until a robot steps."""
    for _ in range(300):
        time.sleep(0.1)
        with contextlib.suppress(RobotError), Client(endpoint) as client:
            if client.state().seconds > 2.0:
                return
    raise ResultError("the robot does not begin")


@contextlib.contextmanager
def in_this_process(stands: bool) -> Iterator[Robot]:
    """A robot in a thread of this process."""
    shipped = PARAMETER_SETS["balance"].spec
    config: Any = shipped.task.config_of(shipped.config, engine="mujoco", push=NO_PUSH, time_limit=3600.0)
    supervisor = dataclasses.replace(config.supervisor, enabled=True)
    config = dataclasses.replace(config, supervisor=supervisor)
    endpoint, dt, stop = free_port(), config.physics.control_dt, threading.Event()
    swaps: list[int] = []
    count = iter(range(10**9))

    def look(tick: LoopTick) -> None:
        number = next(count)
        if tick.change is not None and tick.change.ended is Phase.LAND:
            swaps.append(number)

    with contextlib.closing(Server(endpoint, LearnedWith.of(config), Slot(dt))) as server:
        spec = EpisodeSpec(shipped.parameters, 0, shipped.task, config)
        robot, loop = simulated_loop(spec, pacing=RealTime(dt), observers=[look, server], goes_on=True)
        assert isinstance(loop.controller, Supervisor)
        if stands:
            loop.controller.stand()

        def run() -> None:
            while loop.tick() and not stop.is_set():
                pass

        thread = threading.Thread(target=run)
        thread.start()
        try:
            _wait_for(endpoint)
            yield Robot(endpoint, psutil.Process(), swaps)
        finally:
            stop.set()
            thread.join()
            robot.off()
