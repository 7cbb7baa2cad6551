"""Options that say where a robot listens."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from sarah.errors import ConfigurationError
from sarah.remote.endpoints import DEFAULT_ENDPOINT, Certificates, Endpoint

LISTEN = "--listen"
LIKE_AN_ADDRESS = re.compile(r"(tcp|tls|udp|quic|ws|unix[a-z-]*)/")
"""Beginning of an address, allowed or not."""


def with_endpoint(arguments: Sequence[str]) -> list[str]:
    """Arguments in which ``--listen`` has an address, also where none was given.

    :param arguments: arguments of a command
    """
    words: list[str] = []
    for word, following in zip(arguments, [*arguments[1:], ""], strict=True):
        words.append(word)
        if word == LISTEN and not LIKE_AN_ADDRESS.match(following):
            words.append(DEFAULT_ENDPOINT)
    return words


def endpoint_of(address: str, authority: Path | None, certificate: Path | None, key: Path | None) -> Endpoint:
    """Endpoint that options name, and the certificates for it.

    :param address: address at which a robot listens
    :param authority: certificate of the authority that has signed both sides' certificates
    :param certificate: own certificate
    :param key: private key of that certificate
    :raises ConfigurationError: if the address is not allowed, or some of the files are not given
    """
    if authority is None and certificate is None and key is None:
        return Endpoint(address)
    if authority is None or certificate is None or key is None:
        raise ConfigurationError("TLS needs certificates of both sides: give --authority, --certificate and --key")
    return Endpoint(address, Certificates(authority, certificate, key))
