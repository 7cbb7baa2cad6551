"""The web server of the page."""

from __future__ import annotations

import contextlib
import io
import socket
from collections.abc import Iterator

import viser

from sarah.errors import ConfigurationError


@contextlib.contextmanager
def serving(host: str, port: int) -> Iterator[viser.ViserServer]:
    """Serve an empty page while the context lasts.

    :param host: address to serve the page at
    :param port: port to serve the page at; the next free one if it is taken
    :return: the server
    :raises ConfigurationError: if this machine cannot listen at the address
    """
    try:
        socket.create_server((host, 0)).close()  # viser itself would try for ever
    except OSError as error:
        raise ConfigurationError(f"cannot serve a page at {host!r}: {error.strerror or error}") from error
    with _silence():
        server = viser.ViserServer(host=host, port=port, label="SARAH", verbose=False)
    server.gui.configure_theme(show_logo=False, show_share_button=False)
    try:
        yield server
    finally:
        with _silence():
            server.stop()


def _silence() -> contextlib.AbstractContextManager[object]:
    """Hide viser's banners; the command prints the address of the page."""
    return contextlib.redirect_stdout(io.StringIO())
