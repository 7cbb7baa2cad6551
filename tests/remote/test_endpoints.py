"""Where a robot can be reached: what needs certificates, and who is refused."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from sarah.errors import ConfigurationError
from sarah.remote.endpoints import Certificates, Endpoint


@pytest.mark.parametrize("address", ["tcp/127.0.0.1:1", "tcp/127.9.9.9:65535", "tcp/[::1]:7447", "tcp/localhost:7447"])
def test_loopback_needs_no_certificate(address: str) -> None:
    for listens in (True, False):
        settings = Endpoint(address).configuration(listens)
        own, other = ("listen", "connect") if listens else ("connect", "listen")
        assert settings[own]["endpoints"] == [address.replace("localhost", "127.0.0.1")]
        assert settings[other]["endpoints"] == [] and settings["transport"]["link"]["protocols"] == ["tcp"]
        assert not settings["scouting"]["multicast"]["enabled"] and not settings["scouting"]["gossip"]["enabled"]


@pytest.mark.parametrize(
    ("address", "words"),
    [
        ("tcp/0.0.0.0:7447", "can be reached from other machines: it needs tls/0.0.0.0:7447"),
        ("tcp/[::]:7447", "can be reached from other machines"),
        ("tcp/192.168.0.7:7447", "can be reached from other machines"),
        ("tcp/localhost.example:7447", "can be reached from other machines"),
        ("tcp/2130706433:7447", "can be reached from other machines"),
        ("tcp/127.0.0.1", "an endpoint is such as"),
        ("tcp/127.0.0.1:0", "an endpoint is such as"),
        ("tcp/127.0.0.1:70000", "an endpoint is such as"),
        ("tcp/127.0.0.1:7447#iface=eth0", "an endpoint is such as"),
        ("tls/robot:7447?x=1", "an endpoint is such as"),
        ("udp/127.0.0.1:7447", "an endpoint is such as"),
        ("127.0.0.1:7447", "an endpoint is such as"),
        ("tls/robot:7447", "TLS needs certificates of both sides"),
        ("unixsock-stream/sarah.sock", "a Unix socket needs an absolute path in a folder that exists"),
        ("unixsock-stream//none/sarah.sock", "a Unix socket needs an absolute path in a folder that exists"),
        (f"unixsock-stream/{__file__}", "is there and is no socket"),
    ],
)
def test_what_others_could_reach_is_refused(address: str, words: str) -> None:
    with pytest.raises(ConfigurationError, match=re.escape(words)):
        Endpoint(address)


def test_tls_asks_both_sides_for_certificates(tmp_path: Path) -> None:
    files = [tmp_path / name for name in ("authority.pem", "robot.pem", "robot.key")]
    with pytest.raises(ConfigurationError, match="--authority: there is no file"):
        Endpoint("tls/robot:7447", Certificates(*files))
    for file in files:
        file.touch()
    endpoint = Endpoint("tls/robot:7447", Certificates(*files))
    for listens, side in ((True, "listen"), (False, "connect")):
        tls = endpoint.configuration(listens)["transport"]["link"]["tls"]
        assert tls["enable_mtls"] and tls["verify_name_on_connect"] and tls["root_ca_certificate"] == str(files[0])
        assert (tls[f"{side}_certificate"], tls[f"{side}_private_key"]) == (str(files[1]), str(files[2]))


def test_without_zenoh_one_line_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    missing: Callable[[str], None] = lambda name: None  # noqa: E731
    monkeypatch.setattr("sarah.remote.endpoints.find_spec", missing)
    with pytest.raises(ConfigurationError, match=re.escape("pip install 'sarah[remote]'")):
        Endpoint().opened(listens=True)
