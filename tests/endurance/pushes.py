"""Do messages disturb a robot that runs?

The robot is simulated in real time by ``sarah-robot --listen``, in a process of its own. For single pushes the control
loop runs in this process, which knows in which ticks its legs swap. A network that is gone is a relay that forwards
nothing: what is sent arrives when it is back.
"""

import contextlib
import random
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from pandas import DataFrame

from benchmarks.timing import Timing
from experiments.experiment import EPISODE
from experiments.record import ResultError, Row
from experiments.tables import shown, table
from sarah.errors import SarahError
from sarah.remote.answers import Telemetry
from sarah.remote.client import Client
from sarah.remote.endpoints import REQUESTS
from sarah.remote.requests import LearnedWith, Request, read_request

from .listening_robots import COMMAND, Robot, free_port, in_a_process, in_this_process, running
from .relay import Relay

NEAR = {"V1": (0.5, 0.9), "V2": (0.0, 0.5), "V3": (0.4, 0.8), "V4": (-0.5, 0.2)}
"""Ranges of V1 to V4 with which the robot steps well."""
LARGEST_LAG = 3
"""Number of ticks after which a request must have arrived."""
COLUMNS = ("messages", "answers", "time_s", "late_ticks", "grown_mib")
NOTHING, WATCHED, GARBAGE, FLOOD, GONE = "nothing", "nothing, log and viewer", "garbage", "a flood", "network gone"
KILLED, TWO = "killed pushers", "two pushers at once"
STEPPING, STANDING = "single pushes, own loop", "single pushes, standing, own loop"
IN_THIS_PROCESS = (STEPPING, STANDING)


@dataclass(frozen=True)
class Pushes(Timing):
    """A robot that runs, and what is sent to it.

    :param seconds: time of a flood, that for which nothing is sent, and that without a network, in s
    :param garbage: number of messages that are no requests for this robot
    :param rate: messages per second
    :param kills: number of pushers that are killed
    :param pushes: number of single pushes, and of each of two pushers
    """

    depends_on = (*EPISODE, "sarah/drivers", "sarah/remote")
    seconds: float = 60.0
    garbage: int = 100_000
    rate: float = 1000.0
    kills: int = 100
    pushes: int = 1000

    def cases(self) -> list[Row]:
        names = (NOTHING, WATCHED, GARBAGE, FLOOD, GONE, KILLED, TWO, *IN_THIS_PROCESS)
        return [{"sent": name} for name in names]

    def rows(self, sent: str) -> Iterator[Row]:
        with self._robot(sent) as robot, Client(robot.endpoint) as client:
            before, memory = client.state(), robot.memory_mib
            messages, answers = self._send(sent, robot)
            after = client.state()
            _check(sent, before, after)
            late, grown = after.late_ticks - before.late_ticks, robot.memory_mib - memory
            seconds = after.seconds - before.seconds
            yield dict(zip(COLUMNS, (messages, answers, seconds, late, grown), strict=True))

    @contextlib.contextmanager
    def _robot(self, sent: str) -> Iterator[Robot]:
        """The robot of a case."""
        with contextlib.ExitStack() as stack:
            if sent in IN_THIS_PROCESS:
                yield stack.enter_context(in_this_process(stands=sent == STANDING))
            elif sent == WATCHED:
                log = Path(stack.enter_context(tempfile.TemporaryDirectory())) / "robot.mcap"
                robot = stack.enter_context(in_a_process("--log", str(log)))
                page = free_port().address.rpartition(":")[2]
                stack.enter_context(running("view", "--robot", robot.endpoint.address, "--port", page))
                time.sleep(5.0)  # until the viewer has begun
                yield robot
            else:
                yield stack.enter_context(in_a_process())

    def _send(self, sent: str, robot: Robot) -> tuple[int, int]:
        """Send the messages of a case, and count them and the answers to them."""
        generator = random.Random(0)
        if sent == GARBAGE:
            return flood(robot, [garbage(generator) for _ in range(self.garbage)], self.rate)
        if sent == FLOOD:
            refused = Request("push", {"V1": 0.7}, LearnedWith(control_rate=50)).to_json()
            return flood(robot, [refused] * round(self.seconds * self.rate), self.rate)
        if sent == GONE:
            return gone(robot, self.seconds)
        if sent == KILLED:
            return kill(robot, self.kills)
        if sent == TWO:
            return two(robot, self.pushes)
        if sent == STEPPING:
            return single(robot, self.pushes, generator)
        if sent == STANDING:
            return standing(robot, self.pushes, generator)
        time.sleep(self.seconds)
        return 0, 0


FULL = Pushes()
QUICK = Pushes(seconds=0.5, garbage=100, rate=200.0, kills=1, pushes=2)


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


def standing(robot: Robot, number: int, generator: random.Random) -> tuple[int, int]:
    """Push at any time to a robot that stands; each push has to be applied as soon as it has come."""
    with Client(robot.endpoint) as client:
        for _ in range(number):
            time.sleep(generator.uniform(0.0, 0.05))
            sent = client.state().tick
            applied = next(iter(client.ask(near(generator)))).tick
            if applied is None or applied - sent > LARGEST_LAG:
                raise ResultError(f"a push to a robot that stood in tick {sent} was applied in tick {applied}")
    return number, number


def gone(robot: Robot, seconds: float) -> tuple[int, int]:
    """Push, lose the network while the robot tries the parameters, and push again when it is back."""
    generator = random.Random(0)
    with Relay(robot.endpoint) as relay, Client(relay.endpoint) as client:
        first = next(iter(client.ask(near(generator))))
        relay.stop()
        time.sleep(seconds)
        relay.go_on()
        answers = [*client.ask(near(generator))]
    return 2, len([first, *answers[:1]])


def near(generator: random.Random) -> Request:
    """A push of parameters with which the robot steps well."""
    return Request("push", {name: round(generator.uniform(*ends), 3) for name, ends in NEAR.items()})


def _check(sent: str, before: Telemetry, after: Telemetry) -> None:
    if (after.state, after.reason) != (before.state, before.reason):
        raise ResultError(f"{sent}: the robot is {after.state}: {after.reason}")
    if sent in (NOTHING, WATCHED, GARBAGE, FLOOD) and before.parameters != after.parameters:
        raise ResultError(f"{sent}: the parameters are {dict(after.parameters)}")


def answer(rows: DataFrame) -> str:
    """How much the robot was disturbed."""
    messages, own = int(rows.messages.sum()), rows.sent.isin(IN_THIS_PROCESS)
    shares = rows.late_ticks / (100.0 * rows.time_s)
    of_nothing, watched, of_messages = (
        shown(float(shares[which].max()), ".2%")
        for which in (rows.sent == NOTHING, rows.sent == WATCHED, ~own & ~rows.sent.isin([NOTHING, WATCHED]))
    )
    return (
        f"Hardly. With messages at most {of_messages} of the ticks were late, without messages {of_nothing}, and with "
        f"a log and a viewer {watched}. Of {messages:,} messages only valid pushes changed parameters. Each single "
        "push was applied at the next swap of legs, or at once while the robot stood."
    )


def effects(rows: DataFrame) -> str:
    """The same by what was sent."""
    caption = "A robot in real time, and what was sent to it. The loops of the last rows have no real-time scheduling."
    return table(rows, list(rows.columns), caption, time_s=".0f", grown_mib=".1f")
