"""A network that can be lost: a relay between a robot and who talks to it, which can stop to forward."""

import contextlib
import socket
import threading
from types import TracebackType

from sarah.remote.endpoints import Endpoint

from .listening_robots import free_port

CHUNK = 2**16
"""Most bytes that are forwarded at once."""


class Relay:
    """A relay of one TCP address, for a ``with`` statement.

    :param target: address that it forwards to
    """

    def __init__(self, target: Endpoint) -> None:
        self.endpoint = free_port()
        """Where it listens."""
        self._target = _host_and_port(target)
        self._forwards = threading.Event()
        self._forwards.set()
        self._listener = socket.create_server(_host_and_port(self.endpoint))
        self._open = [self._listener]
        threading.Thread(target=self._accept, daemon=True).start()

    def __enter__(self) -> "Relay":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for one in self._open:
            one.close()
        self.go_on()

    def stop(self) -> None:
        """Forward nothing; connections stay open."""
        self._forwards.clear()

    def go_on(self) -> None:
        """Forward again, also what came meanwhile."""
        self._forwards.set()

    def _accept(self) -> None:
        with contextlib.suppress(OSError):
            while True:
                near, _ = self._listener.accept()
                self._forwards.wait()
                far = socket.create_connection(self._target)
                self._open += [near, far]
                for ends in ((near, far), (far, near)):
                    threading.Thread(target=self._forward, args=ends, daemon=True).start()

    def _forward(self, near: socket.socket, far: socket.socket) -> None:
        with contextlib.suppress(OSError):
            while data := near.recv(CHUNK):
                self._forwards.wait()
                far.sendall(data)
            far.shutdown(socket.SHUT_WR)


def _host_and_port(endpoint: Endpoint) -> tuple[str, int]:
    host, _, port = endpoint.address.partition("/")[2].rpartition(":")
    return host, int(port)
