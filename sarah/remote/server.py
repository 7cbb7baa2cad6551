"""The robot's side: requests come in, answers and telemetry go out, and the control loop never waits for either.

Zenoh keeps the newest requests in a ring. A thread of the server's takes them out, reads and checks them, and hands
them over; it also sends what the loop has to say. Loop and thread share three queues only.
"""

from __future__ import annotations

import contextlib
import threading
import time
from collections import deque
from collections.abc import Callable
from queue import Empty, SimpleQueue
from typing import Any

from sarah.control.supervisor import Supervisor
from sarah.drivers.loop import LoopTick
from sarah.errors import ConfigurationError, SarahError
from sarah.remote.answers import Answer, Identity, Message, Outcome, Telemetry, to_json
from sarah.remote.endpoints import REQUESTS, TELEMETRY, Endpoint
from sarah.remote.reporter import RATE, Reporter
from sarah.remote.requests import LARGEST_BYTES, LearnedWith, Request, read_request
from sarah.remote.slot import Asked, Slot

RING = 64
"""Number of requests that wait to be read; of more, the oldest get no answer."""
READ_SECONDS = 0.005
"""Time from one request that is read to the next, in s: reading holds the interpreter, which the loop needs."""
MOST_LEAVING = 256
"""Number of messages that wait to be sent, beyond which telemetry is left out."""


class Server:
    """Observer of a control loop that lets others ask the robot for something. It has to be closed.

    In lockstep it holds the loop up while the robot has nothing to do: a simulated robot then waits for its learner.

    :param endpoint: where it listens
    :param robot: controller and robot that parameters must have been learned with
    :param slot: slot for the parameters
    :param identity: what robot it is; without it nobody is told
    :param in_lockstep: function that says whether the loop is held up while there is nothing to do
    :raises RobotError: if it cannot listen there
    """

    def __init__(
        self,
        endpoint: Endpoint,
        robot: LearnedWith,
        slot: Slot,
        identity: Identity | None = None,
        in_lockstep: Callable[[], bool] = lambda: False,
    ) -> None:
        self._slot, self._reporter, self._robot = slot, Reporter(), robot
        self._identity, self._in_lockstep = identity, in_lockstep
        self._arrived: deque[Asked] = deque()
        self._readers: deque[Asked] = deque()
        self._has_arrived = threading.Event()
        self._leaving: SimpleQueue[Callable[[], None]] = SimpleQueue()
        self._is_closed = False
        self.failure = ""
        """First mistake that came up while a request was read or something was sent; empty while all is well."""
        self._session = endpoint.opened(listens=True)
        try:
            self._listen()
        except BaseException:
            self._session.close()
            raise
        self.thread = threading.Thread(target=self._serve, name="sarah-remote", daemon=True)
        self.thread.start()

    def _listen(self) -> None:
        from zenoh import CongestionControl, handlers

        self._queries: Any = self._session.declare_queryable(REQUESTS, handlers.RingChannel(RING))
        self._topic = self._session.declare_publisher(TELEMETRY, congestion_control=CongestionControl.DROP)

    def __call__(self, tick: LoopTick) -> None:
        """Do what was asked since the last tick.

        :param tick: what happened in a tick of the loop
        """
        supervisor = tick.controller
        assert isinstance(supervisor, Supervisor), "a robot that listens has a supervisor"
        is_due = self._reporter.tick(tick, supervisor)
        while self._slot.is_idle and not self._arrived and self._in_lockstep():
            self._tell(tick, supervisor, is_due=True)
            self._has_arrived.wait(1.0 / RATE)
            self._has_arrived.clear()
        self._slot.tick(tick, supervisor, _emptied(self._arrived))
        self._tell(tick, supervisor, is_due)

    def _tell(self, tick: LoopTick, supervisor: Supervisor, is_due: bool) -> None:
        """Say what the robot does, to those that asked and, if it is due, to everybody."""
        is_due = is_due and self._leaving.qsize() < MOST_LEAVING
        if is_due or self._readers:
            telemetry = self._reporter.telemetry(tick, supervisor)
            for asked in _emptied(self._readers):
                asked.reply(telemetry)
            if is_due:
                self._leaving.put(lambda: self._publish(telemetry))

    def close(self, reason: str = "the robot's program has ended") -> None:
        """Answer those that wait, and let go of the address.

        :param reason: what they are told
        """
        self._is_closed = True
        self.thread.join()  # from here on nothing arrives
        self._slot.close(reason)
        for asked in (*self._arrived, *self._readers):
            asked.reply(Answer(Outcome.ENDED, reason))
        self._send(time.monotonic())
        self._session.close()

    def _serve(self) -> None:
        """Receive and send until the server is closed."""
        while not self._is_closed:
            try:
                self._send(time.monotonic() + READ_SECONDS)
                if (query := self._queries.try_recv()) is not None:
                    self._receive(query)
            except Exception as error:  # a robot that steps has to stay within reach, whatever it is
                self.failure = self.failure or f"{type(error).__name__}: {error}"

    def _send(self, end: float) -> None:
        """Send what there is, and wait for more until a time."""
        with contextlib.suppress(Empty):
            while True:
                self._leaving.get(timeout=max(0.0, end - time.monotonic()))()

    def _receive(self, query: Any) -> None:
        """Read and check a request, and hand it over."""
        try:
            request = self._checked(query.payload)
        except SarahError as error:
            _reply(query, Answer(Outcome.REFUSED, " ".join(str(error).split())))
            return
        if request.kind == "identity":
            _reply(query, self._identity or Answer(Outcome.REFUSED, "this robot does not say what it is"))
            return
        came = self._readers if request.kind == "state" else self._arrived
        came.append(Asked(request, lambda message: self._leaving.put(lambda: _reply(query, message))))
        self._has_arrived.set()

    def _checked(self, payload: Any) -> Request:
        """Request of a message, which must be for this robot."""
        if payload is None or len(payload) > LARGEST_BYTES:
            size = 0 if payload is None else len(payload)
            raise ConfigurationError(f"a message has 1 to {LARGEST_BYTES} bytes, not {size}")
        request = read_request(payload.to_bytes())
        difference = "" if request.learned_with is None else request.learned_with.difference(self._robot)
        if difference:
            raise ConfigurationError(f"learned with another robot or controller: {difference}")
        return request

    def _publish(self, telemetry: Telemetry) -> None:
        from zenoh import ZError

        with contextlib.suppress(ZError):
            self._topic.put(to_json(telemetry))


def _emptied(queue: deque[Asked]) -> list[Asked]:
    """What a queue has had, to which another thread adds."""
    return [queue.popleft() for _ in range(len(queue))]


def _reply(query: Any, message: Message) -> None:
    """Send an answer; whoever asked may have gone."""
    from zenoh import ZError

    with contextlib.suppress(ZError):
        query.reply(REQUESTS, to_json(message))
    if not isinstance(message, Answer) or message.is_final:
        query.drop()
