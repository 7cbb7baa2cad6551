"""Where a robot can be reached: the addresses that are allowed, and Zenoh's settings for them.

Nothing is discovered: no multicast, no gossip. An address of this machine's loopback or a Unix socket needs nothing
more; any other one needs TLS with certificates of both sides.
"""

from __future__ import annotations

import ipaddress
import json
import os
import re
import stat
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sarah.errors import ConfigurationError, RobotError, shortened

if TYPE_CHECKING:
    from zenoh import Session


DEFAULT_ENDPOINT = "tcp/127.0.0.1:7447"
"""Endpoint of a robot, unless another one is given."""
TCP, TLS, UNIX = "tcp", "tls", "unixsock-stream"
SCHEMES = (TCP, TLS, UNIX)
EXAMPLES = "tcp/127.0.0.1:7447, unixsock-stream//run/user/1000/sarah.sock or tls/robot.local:7447"
REQUESTS, TELEMETRY = "sarah/robot/request", "sarah/robot/telemetry"
"""Keys of Zenoh for requests and telemetry."""
OPEN_SECONDS = 2.0
"""Time in which a robot must be reached, in s."""
LARGEST_TRANSPORT_BYTES = 65536
"""Length of a message in bytes beyond which Zenoh does not put it together."""
MOST_SESSIONS = 32
"""Number of programs that are connected at the same time."""
ROBOTS_ALONE = {
    "enabled": True,
    "default_permission": "allow",
    "rules": [
        {
            "id": "robot's",
            "permission": "deny",
            "flows": ["ingress"],
            "messages": ["put", "delete", "declare_queryable", "reply"],
            "key_exprs": ["**"],
        }
    ],
    "subjects": [{"id": "everybody"}],
    "policies": [{"rules": ["robot's"], "subjects": ["everybody"]}],
}
"""What Zenoh does not take from those who reach a robot: answers and telemetry are the robot's alone."""
BLOCKED_MICROSECONDS = 200_000
"""Time for which a program that does not read its answers is waited for, before its connection is closed, in us."""


@dataclass(frozen=True)
class Certificates:
    """Files in PEM format for TLS: one's own certificate, and the authority that has signed those of both sides.

    :param authority: certificate of the authority; whoever has a certificate of it is let in
    :param certificate: own certificate
    :param key: private key of that certificate
    """

    authority: Path
    certificate: Path
    key: Path


@dataclass(frozen=True)
class Endpoint:
    """An address at which a robot listens, and the certificates for it.

    :param address: protocol, a slash and the address, as Zenoh writes it
    :param certificates: certificates, which TLS needs
    :raises ConfigurationError: if the address is not allowed
    """

    address: str = DEFAULT_ENDPOINT
    certificates: Certificates | None = None

    def __post_init__(self) -> None:
        """Refuse what others could reach without a certificate."""
        scheme, _, rest = self.address.partition("/")
        if scheme not in SCHEMES or not rest or re.search(r"[#?;,\s]", rest):
            raise ConfigurationError(f"an endpoint is such as {EXAMPLES}, not {shortened(self.address)}")
        if scheme == UNIX:
            _check_path(Path(rest))
            return
        host = re.fullmatch(r"(\[[0-9a-fA-F:]+\]|[\w.-]+):([0-9]{1,5})", rest)
        if host is None or not 0 < int(host[2]) < 65536:
            raise ConfigurationError(f"an endpoint is such as {EXAMPLES}, not {shortened(self.address)}")
        if scheme == TCP and not _is_loopback(host[1]):
            raise ConfigurationError(
                f"{self.address} can be reached from other machines: it needs tls/{rest}, with --authority, "
                "--certificate and --key"
            )
        if scheme == TLS:
            _check_certificates(self.certificates)

    def configuration(self, listens: bool) -> dict[str, Any]:
        """Settings of Zenoh.

        :param listens: whether this is the robot's side
        """
        scheme = self.address.partition("/")[0]
        address = self.address.replace("tcp/localhost:", "tcp/127.0.0.1:")
        ends = {"endpoints": [address], "timeout_ms": 0, "exit_on_failure": True}  # one attempt
        none: dict[str, Any] = {"endpoints": []}
        link: dict[str, Any] = {
            "protocols": [scheme],
            "rx": {"max_message_size": LARGEST_TRANSPORT_BYTES},
            "tx": {"queue": {"congestion_control": {"block": {"wait_before_close": BLOCKED_MICROSECONDS}}}},
        }
        if self.certificates is not None and scheme == TLS:
            link["tls"] = _tls(self.certificates, "listen" if listens else "connect")
        return {
            "mode": "peer" if listens else "client",
            "listen": ends if listens else none,
            "connect": none if listens else ends,
            "scouting": {"multicast": {"enabled": False}, "gossip": {"enabled": False}, "delay": 0},
            "adminspace": {"enabled": False},
            **({"access_control": ROBOTS_ALONE} if listens else {}),
            "transport": {
                "link": link,
                "unicast": {"max_sessions": MOST_SESSIONS, "open_timeout": round(1000 * OPEN_SECONDS)},
                "shared_memory": {"enabled": False},
            },
        }

    def check_installed(self) -> None:
        """Refuse to go on without Zenoh.

        :raises ConfigurationError: naming the extra
        """
        if find_spec("zenoh") is None:
            raise ConfigurationError("this needs the extra remote: pip install '.[remote]' in the clone")

    def opened(self, listens: bool) -> Session:
        """Open a session of Zenoh, which has to be closed.

        :param listens: whether this is the robot's side
        :raises RobotError: if the address is taken, or nobody is there
        """
        self.check_installed()
        import zenoh

        settings = zenoh.Config.from_json5(json.dumps(self.configuration(listens)))
        try:
            with _own_files_only():
                return zenoh.open(settings)
        except zenoh.ZError as error:
            if listens:
                raise RobotError(f"cannot listen at {self.address}: {_first_words(error)}") from None
            refused = ", or refuses this certificate" if self.address.startswith(TLS) else ""
            raise RobotError(f"no robot listens at {self.address}{refused}") from None


def _is_loopback(host: str) -> bool:
    try:
        return host == "localhost" or ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False


def _check_path(path: Path) -> None:
    """Refuse a path of a Unix socket that cannot be one."""
    if not path.is_absolute() or not path.parent.is_dir() or len(os.fsencode(path)) > 100:
        raise ConfigurationError(
            f"a Unix socket needs an absolute path in a folder that exists, not {str(path)!r:.120}"
        )
    if path.exists() and not stat.S_ISSOCK(path.stat().st_mode):
        raise ConfigurationError(f"{path} is there and is no socket")


def _check_certificates(certificates: Certificates | None) -> None:
    if certificates is None:
        raise ConfigurationError("TLS needs certificates of both sides: give --authority, --certificate and --key")
    for name, path in vars(certificates).items():
        if not path.is_file():
            raise ConfigurationError(f"--{name}: there is no file {path}")


def _tls(certificates: Certificates, side: str) -> Mapping[str, Any]:
    return {
        "root_ca_certificate": str(certificates.authority),
        f"{side}_certificate": str(certificates.certificate),
        f"{side}_private_key": str(certificates.key),
        "enable_mtls": True,
        "verify_name_on_connect": True,
    }


@contextmanager
def _own_files_only() -> Iterator[None]:
    """Context in which new files, and Unix sockets, are the user's alone."""
    before = os.umask(0o077)
    try:
        yield
    finally:
        os.umask(before)


def _first_words(error: Exception) -> str:
    """What Zenoh says, without the places in its sources."""
    return re.sub(r" at /\S+\.rs:\d+\.?", "", " ".join(str(error).split())).strip(" .]")[:200]
