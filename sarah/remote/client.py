"""The other side: ask a robot for something, and hear what becomes of it."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

from sarah.errors import RobotError
from sarah.remote.answers import Answer, Identity, Kind, Measured, Telemetry, from_json
from sarah.remote.endpoints import REQUESTS, TELEMETRY, Endpoint
from sarah.remote.requests import Request

WAIT_SECONDS = 30.0
"""Time to wait for all answers, in s: a swap of legs may take some, and new parameters are proven after five more."""
SILENT_SECONDS = 5.0
"""Time without telemetry after which a robot counts as gone, in s."""
ATTEMPTS, PAUSE_SECONDS = 20, 0.05
"""Number of times that a request is sent which the robot drops unread, as in a flood, and time between them, in s."""


class Client:
    """A connection to a robot, for a ``with`` statement.

    :param endpoint: where the robot listens
    :raises RobotError: if nobody does
    """

    def __init__(self, endpoint: Endpoint) -> None:
        self._endpoint = endpoint
        self._session = endpoint.opened(listens=False)

    def __enter__(self) -> Client:
        """Nothing happens."""
        return self

    def __exit__(self, *error: object) -> None:
        """Close the connection."""
        self.close()

    def close(self) -> None:
        """Close the connection."""
        self._session.close()

    def ask(self, request: Request, seconds: float = WAIT_SECONDS) -> Iterator[Answer]:
        """Ask the robot, and wait for its answers.

        :param request: what to ask
        :param seconds: time to wait for all of them, in s
        :return: answers as they come; the last one is final
        :raises RobotError: if it does not come
        """
        return self._answers(Answer, request, seconds)

    def window(self, request: Request, seconds: float) -> Iterator[Answer | Measured]:
        """Ask the robot for a window, and wait for it.

        :param request: request for a window
        :param seconds: time to wait for it, in s
        :return: answers as they come; the last one is the window, or is final
        :raises RobotError: if it does not come
        """
        return self._answers(Measured, request, seconds)

    def identity(self, seconds: float = WAIT_SECONDS) -> Identity:
        """Ask what robot it is.

        :param seconds: time to wait, in s
        :raises RobotError: if it does not say so
        """
        return self._told(Identity, Request("identity"), seconds)

    def state(self, seconds: float = WAIT_SECONDS) -> Telemetry:
        """Ask what the robot does.

        :param seconds: time to wait, in s
        :raises RobotError: if no answer comes
        """
        return self._told(Telemetry, Request("state"), seconds)

    def telemetry(self, seconds: float = SILENT_SECONDS) -> Iterator[Telemetry]:
        """What the robot does, twenty times a second; whoever is slow misses some.

        :param seconds: time without telemetry after which the robot counts as gone, in s
        :raises RobotError: if it has gone
        """
        import zenoh

        newest: Any = zenoh.handlers.RingChannel(1)
        subscriber: Any = self._session.declare_subscriber(TELEMETRY, newest)
        last = time.monotonic()
        try:
            while True:
                sample = subscriber.try_recv()
                if sample is not None:
                    last = time.monotonic()
                    yield from_json(Telemetry, sample.payload.to_bytes())
                elif time.monotonic() - last > seconds:
                    raise RobotError(f"the robot at {self._endpoint.address} has gone")
                else:
                    time.sleep(PAUSE_SECONDS / 5)
        finally:
            subscriber.undeclare()

    def _answers(self, kind: type[Kind], request: Request, seconds: float) -> Iterator[Answer | Kind]:
        """Answers up to the final one, or to a message of the kind that was asked for."""
        for reply in self._replies(request, seconds):
            answer = _answer_or(kind, reply)
            yield answer
            if not isinstance(answer, Answer) or answer.is_final:
                return
        raise RobotError(f"the robot at {self._endpoint.address} has gone before its last answer")

    def _told(self, kind: type[Kind], request: Request, seconds: float) -> Kind:
        """What the robot says, and nothing more."""
        for reply in self._replies(request, seconds):
            answer = _answer_or(kind, reply)
            if isinstance(answer, Answer):
                raise RobotError(answer.reason)
            return answer
        raise RobotError(f"the robot at {self._endpoint.address} has gone")

    def _replies(self, request: Request, seconds: float) -> Iterator[bytes]:
        """What the robot answers to a request, which is sent again if it was dropped unread."""
        for _ in range(ATTEMPTS):
            replies = self._replies_once(request, seconds)
            first = next(replies, None)
            if first is not None:
                yield first
                yield from replies
                return
            time.sleep(PAUSE_SECONDS)
        raise RobotError(
            f"no answer from {self._endpoint.address}: it is no sarah-robot, or more requests come than it reads"
        )

    def _replies_once(self, request: Request, seconds: float) -> Iterator[bytes]:
        import zenoh

        replies: Any = self._session.get(
            REQUESTS,
            payload=request.to_json(),
            timeout=seconds,
            consolidation=zenoh.ConsolidationMode.NONE,
            congestion_control=zenoh.CongestionControl.BLOCK,
        )
        for reply in replies:
            if reply.ok is None:
                raise RobotError(f"no answer from {self._endpoint.address} within {seconds:g} s")
            yield reply.ok.payload.to_bytes()


def _answer_or(kind: type[Kind], reply: bytes) -> Answer | Kind:
    """A reply, which is of some kind or an answer."""
    return from_json(Answer, reply) if b'"outcome"' in reply else from_json(kind, reply)
