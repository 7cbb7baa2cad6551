"""Do messages disturb a robot that runs?

The robot is simulated in real time by ``sarah-robot --listen``, in a process of its own. For single pushes the control
loop runs in this process, which knows in which ticks its legs swap.
"""

from __future__ import annotations

import contextlib
import dataclasses
import random
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import psutil
from pandas import DataFrame

from benchmarks.timing import Timing
from experiments.experiment import EPISODE
from experiments.record import ResultError, Row
from experiments.tables import shown, table
from sarah.control.pattern_generator import Phase
from sarah.drivers.loop import LoopTick
from sarah.drivers.real_time import RealTime
from sarah.drivers.simulated_robot import simulated_loop
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.push import NO_PUSH
from sarah.episode.spec import EpisodeSpec
from sarah.errors import RobotError, SarahError
from sarah.remote.answers import Telemetry
from sarah.remote.client import Client
from sarah.remote.endpoints import REQUESTS, Endpoint
from sarah.remote.requests import LearnedWith, Request, read_request
from sarah.remote.server import Server
from sarah.remote.slot import Slot

NEAR = {"V1": (0.5, 0.9), "V2": (0.0, 0.5), "V3": (0.4, 0.8), "V4": (-0.5, 0.2)}
"""Ranges of V1 to V4 with which the robot steps well."""
LARGEST_LAG = 3
"""Number of ticks after which a request must have arrived."""
COMMAND = "import sys; from sarah.cli.{0} import main; sys.argv[0] = 'sarah-{0}'; main()"
COLUMNS = ("messages", "answers", "time_s", "late_ticks", "grown_mib")
GARBAGE, FLOOD, KILLED, TWO = "garbage", "a flood", "killed pushers", "two pushers at once"
ONE = "single pushes, own loop"


@dataclass(frozen=True)
class Pushes(Timing):
    """A robot that runs, and what is sent to it.

    :param seconds: time of a flood, and that for which nothing is sent, in s
    :param garbage: number of messages that are no requests for this robot
    :param rate: messages per second
    :param kills: number of pushers that are killed
    :param pushes: number of single pushes, and of each of two pushers
    """

    depends_on = (*EPISODE, "sarah/drivers", "sarah/remote")
    seconds: float = 20.0
    garbage: int = 20_000
    rate: float = 1000.0
    kills: int = 20
    pushes: int = 200

    def cases(self) -> list[Row]:
        """What is sent."""
        return [{"sent": sent} for sent in ("nothing", GARBAGE, FLOOD, KILLED, TWO, ONE)]

    def rows(self, sent: str) -> Iterator[Row]:
        """What the robot does meanwhile.

        :param sent: what is sent
        """
        with in_this_process() if sent == ONE else in_a_process() as robot, Client(robot.endpoint) as client:
            before, memory = client.state(), robot.memory_mib
            messages, answers = self._send(sent, robot)
            after = client.state()
            _check(sent, before, after)
            late, grown = after.late_ticks - before.late_ticks, robot.memory_mib - memory
            seconds = after.seconds - before.seconds
            yield dict(zip(COLUMNS, (messages, answers, seconds, late, grown), strict=True))

    def _send(self, sent: str, robot: Robot) -> tuple[int, int]:
        """Send the messages of a case, and count them and the answers to them."""
        generator = random.Random(0)
        if sent == GARBAGE:
            return flood(robot, [garbage(generator) for _ in range(self.garbage)], self.rate)
        if sent == FLOOD:
            refused = Request("push", {"V1": 0.7}, LearnedWith(control_rate=50)).to_json()
            return flood(robot, [refused] * round(self.seconds * self.rate), self.rate)
        if sent == KILLED:
            return kill(robot, self.kills)
        if sent == TWO:
            return two(robot, self.pushes)
        if sent == ONE:
            return single(robot, self.pushes, generator)
        time.sleep(self.seconds)
        return 0, 0


FULL = Pushes()
QUICK = Pushes(seconds=0.5, garbage=100, rate=200.0, kills=1, pushes=2)


@dataclass(frozen=True)
class Robot:
    """A robot that runs and listens.

    :param endpoint: where it listens
    :param process: its process
    :param swaps: ticks in which its legs have swapped, if that is known
    """

    endpoint: Endpoint
    process: psutil.Process
    swaps: list[int]

    @property
    def memory_mib(self) -> float:
        """Memory of its process, in MiB."""
        return float(self.process.memory_info().rss / 2**20)


def _free_port() -> Endpoint:
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return Endpoint(f"tcp/127.0.0.1:{found.getsockname()[1]}")


@contextlib.contextmanager
def in_a_process() -> Iterator[Robot]:
    """A robot that has begun to step, in a process of its own."""
    endpoint = _free_port()
    words = ["balance", "--engine", "mujoco", "--real-time", "--listen", endpoint.address]
    silent: dict[str, Any] = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    process = subprocess.Popen([sys.executable, "-c", COMMAND.format("robot"), *words, "--seconds", "3600"], **silent)
    try:
        _wait_for(endpoint)
        yield Robot(endpoint, psutil.Process(process.pid), [])
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
def in_this_process() -> Iterator[Robot]:
    """A robot that has begun to step, in a thread of this process."""
    shipped = PARAMETER_SETS["balance"].spec
    config: Any = shipped.task.config_of(shipped.config, engine="mujoco", push=NO_PUSH, time_limit=3600.0)
    supervisor = dataclasses.replace(config.supervisor, enabled=True)
    config = dataclasses.replace(config, supervisor=supervisor, box_half_width=100.0)
    endpoint, dt, stop = _free_port(), config.physics.control_dt, threading.Event()
    swaps: list[int] = []
    count = iter(range(10**9))

    def look(tick: LoopTick) -> None:
        number = next(count)
        if tick.change is not None and tick.change.ended is Phase.LAND:
            swaps.append(number)

    with contextlib.closing(Server(endpoint, LearnedWith.of(config), Slot(dt))) as server:
        spec = EpisodeSpec(shipped.parameters, 0, shipped.task, config)
        robot, loop = simulated_loop(spec, pacing=RealTime(dt), observers=[look, server])

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


def garbage(generator: random.Random) -> bytes:
    """A message that is cut, fuzzed, out of the box, of another schema, or for another robot; never one to follow."""
    values = {name: generator.uniform(*ends) for name, ends in NEAR.items()}
    while True:
        other = LearnedWith(control_rate=generator.choice((100, 50)))
        message = bytearray(Request("push", values, other).to_json())
        for _ in range(generator.choice((0, 1, 1, 3, 30))):
            message[generator.randrange(len(message))] = generator.randrange(256)
        cut = bytes(message[: generator.choice((len(message), generator.randrange(len(message))))])
        try:
            request = read_request(cut)
        except SarahError:
            return cut
        if (
            request.kind == "push"
            and request.learned_with is not None
            and request.learned_with.difference(LearnedWith())
        ):
            return cut


def flood(robot: Robot, messages: list[bytes], rate: float) -> tuple[int, int]:
    """Send messages at a steady rate."""
    answers, begin = list[bool](), time.monotonic()
    with contextlib.closing(robot.endpoint.opened(listens=False)) as session:
        for number, message in enumerate(messages):
            while number >= (time.monotonic() - begin) * rate:
                time.sleep(0.002)
            session.get(REQUESTS, lambda reply: answers.append(reply.ok is not None), payload=message, timeout=5)
        time.sleep(0.5)
    return len(messages), sum(answers)


def kill(robot: Robot, number: int) -> tuple[int, int]:
    """Kill pushers after their push is applied, before they hear whether it is kept."""
    for index in range(number):
        words = [f"{0.6 + 0.01 * (index % 20):.2f},0.4,0.7,-0.4", "--to", robot.endpoint.address]
        command = [sys.executable, "-c", COMMAND.format("push"), *words]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            if not process.stdout.readline().startswith("applied"):
                raise ResultError("a push was not applied")
            process.kill()
    return number, number


def two(robot: Robot, number: int) -> tuple[int, int]:
    """Let two pushers push at once, each of them again as soon as it has its last answer."""
    answers: list[str] = []

    def push(seed: int) -> None:
        generator = random.Random(seed)
        with Client(robot.endpoint) as client:
            for _ in range(number):
                answers.append([answer.outcome.value for answer in client.ask(near(generator))][-1])

    threads = [threading.Thread(target=push, args=(seed,)) for seed in (1, 2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    if not set(answers) <= {"kept", "overtaken"}:
        raise ResultError(f"two pushers heard {set(answers)}")
    return 2 * number, len(answers)


def single(robot: Robot, number: int, generator: random.Random) -> tuple[int, int]:
    """Push at any time; each push has to be applied at the first swap of legs after it has come."""
    for _ in range(number):
        time.sleep(generator.uniform(0.0, 0.3))
        with Client(robot.endpoint) as client:
            sent = client.state().tick
            applied = next(iter(client.ask(near(generator)))).tick
        missed = [swap for swap in robot.swaps if sent + LARGEST_LAG <= swap < (applied or 0)]
        if applied not in robot.swaps or missed:
            raise ResultError(f"a push of tick {sent} was applied in tick {applied}, and the legs swapped in {missed}")
    return number, number


def near(generator: random.Random) -> Request:
    """A push of parameters with which the robot steps well."""
    return Request("push", {name: round(generator.uniform(*ends), 3) for name, ends in NEAR.items()})


def _check(sent: str, before: Telemetry, after: Telemetry) -> None:
    if after.state != "stepping" or after.reason != "stood for a second":
        raise ResultError(f"{sent}: the robot is {after.state}: {after.reason}")
    if sent in ("nothing", GARBAGE, FLOOD) and before.parameters != after.parameters:
        raise ResultError(f"{sent}: the parameters are {dict(after.parameters)}")


def answer(rows: DataFrame) -> str:
    """How much the robot was disturbed."""
    ticks, messages = 100.0 * rows.time_s, int(rows.messages.sum())
    alone, single_ones = rows.sent == "nothing", rows.sent == ONE
    late, without = (rows.late_ticks[which].sum() / ticks[which].sum() for which in (~alone & ~single_ones, alone))
    return (
        f"Hardly. {shown(late, '.2%')} of the ticks were late with messages, and {shown(without, '.2%')} without. "
        f"{messages:,} messages changed parameters only where they were valid pushes, and each single push was applied "
        "at the first swap of legs after it had come."
    )


def effects(rows: DataFrame) -> str:
    """The same by what was sent."""
    caption = "A robot in real time, and what was sent to it. The last loop has no real-time scheduling."
    return table(rows, list(rows.columns), caption, time_s=".0f", grown_mib=".1f")
