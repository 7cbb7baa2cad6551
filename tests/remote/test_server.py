"""A robot that listens and somebody who asks, over a real connection in one process."""

import datetime
import ipaddress
import itertools
import time
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from hand_made import DT
from listening import free_port, robot

from sarah.errors import RobotError
from sarah.remote.answers import Answer, Outcome, Telemetry, to_json
from sarah.remote.client import Client
from sarah.remote.endpoints import REQUESTS, TELEMETRY, Certificates, Endpoint
from sarah.remote.requests import LearnedWith, Request
from sarah.remote.server import Server
from sarah.remote.slot import Slot

pytest.importorskip("zenoh")


def test_a_push_is_answered_when_it_is_applied_and_when_it_is_kept() -> None:
    endpoint = Endpoint(f"tcp/127.0.0.1:{free_port()}")
    with robot(endpoint), Client(endpoint) as client:
        applied, kept = client.ask(Request("push", {"V1": 0.5}, LearnedWith()))
        assert (applied.outcome, kept.outcome) == (Outcome.APPLIED, Outcome.KEPT)
        assert client.state().parameters["V1"] == 0.5 and client.state().steps_per_second > 1.0
        (refused,) = client.ask(Request("push", {"V1": 0.6}, LearnedWith(control_rate=50)))
        assert refused.reason == "learned with another robot or controller: control_rate is 50 and not 100"


def test_a_robot_stays_within_reach_when_something_cannot_be_sent(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(message: Any) -> bytes:
        if isinstance(message, Telemetry):
            raise TypeError("no JSON")
        return to_json(message)

    monkeypatch.setattr("sarah.remote.server.to_json", fails)
    endpoint = Endpoint(f"tcp/127.0.0.1:{free_port()}")
    with robot(endpoint) as loop, Client(endpoint) as client:
        while loop.ticks < 300:
            time.sleep(0.01)
        assert [answer.outcome for answer in client.ask(Request("stand"))] == [Outcome.APPLIED]
        (server,) = loop.observers
        assert isinstance(server, Server) and server.failure == "TypeError: no JSON"


def test_nobody_else_answers_or_reports_in_the_robots_name() -> None:
    endpoint, heard = Endpoint(f"tcp/127.0.0.1:{free_port()}"), list[Telemetry]()
    with robot(endpoint), Client(endpoint) as client, closing(endpoint.opened(listens=False)) as stranger:

        def answer(query: Any) -> None:
            query.reply(REQUESTS, to_json(Answer(Outcome.REFUSED, "a stranger's")))
            query.drop()

        queryable = stranger.declare_queryable(REQUESTS, answer)
        assert [answer.outcome for answer in client.ask(Request("stand"))] == [Outcome.APPLIED]
        for telemetry in client.telemetry():
            stranger.put(TELEMETRY, b"{}")
            heard.append(telemetry)
            if len(heard) == 5:
                break
        queryable.undeclare()


def test_a_unix_socket_is_the_users_alone(tmp_path: Path) -> None:
    endpoint = Endpoint(f"unixsock-stream/{tmp_path}/robot")
    with robot(endpoint), Client(endpoint) as client:
        assert client.state().tick >= 0
        assert (tmp_path / "robot").stat().st_mode & 0o077 == 0


def test_what_is_no_request_changes_nothing_and_no_answer_is_late() -> None:
    endpoint = Endpoint(f"tcp/127.0.0.1:{free_port()}")
    with robot(endpoint) as loop, Client(endpoint) as client, closing(endpoint.opened(listens=False)) as session:
        came: list[bytes] = []
        topic = session.declare_subscriber(TELEMETRY, lambda sample: came.append(sample.payload.to_bytes()))
        before = client.state().parameters
        for payload in (b"", b"x" * 9000, b"x" * 70_000, b'{"schema": 1, "kind": "push"}'):
            session.get(REQUESTS, lambda reply: None, payload=payload, timeout=1)
        assert client.state().parameters == before
        with pytest.raises(RobotError, match=r"within 0\.1 s"):
            list(client.ask(Request("push", {"V1": 0.5}), 0.1))
        topic.undeclare()
        assert len(came) >= 2 and loop.ticks > 10
    with pytest.raises(RobotError, match=f"no robot listens at {endpoint.address}"):
        Client(endpoint)


def test_a_request_that_is_dropped_unread_is_sent_again() -> None:
    endpoint, came = Endpoint(f"tcp/127.0.0.1:{free_port()}"), list[bytes]()

    def drop_or_answer(query: Any) -> None:
        came.append(query.payload.to_bytes())
        if len(came) == 3:
            query.reply(REQUESTS, to_json(Answer(Outcome.APPLIED, tick=7)))
        query.drop()

    with closing(endpoint.opened(listens=True)) as session:
        queryable = session.declare_queryable(REQUESTS, drop_or_answer)
        with Client(endpoint) as client:
            assert [answer.tick for answer in client.ask(Request("stand"))] == [7]
        queryable.undeclare()
    assert came == [Request("stand").to_json()] * 3


def test_an_address_that_is_taken_is_one_line() -> None:
    endpoint = Endpoint(f"tcp/127.0.0.1:{free_port()}")
    with robot(endpoint), pytest.raises(RobotError, match=r"cannot listen at .*Address already in use"):
        Server(endpoint, LearnedWith(), Slot(DT))


def authority(folder: Path) -> Callable[[str], Certificates]:
    """A new authority, which signs certificates of this machine."""
    own = ec.generate_private_key(ec.SECP256R1())
    now = datetime.datetime.now(datetime.timezone.utc)
    number = itertools.count(1)

    def signed(name: str, key: ec.EllipticCurvePrivateKey) -> Path:
        path, is_authority = folder / f"{name}.pem", key is own
        subject, issuer = (
            x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, one)]) for one in (name, "authority")
        )
        builder = x509.CertificateBuilder(
            issuer, subject, key.public_key(), next(number), now, now.replace(year=now.year + 1)
        )
        builder = builder.add_extension(x509.BasicConstraints(is_authority, None), critical=True)
        local = x509.SubjectAlternativeName([x509.IPAddress(ipaddress.ip_address("127.0.0.1"))])
        certificate = builder.add_extension(local, critical=False).sign(own, hashes.SHA256())
        path.write_bytes(certificate.public_bytes(serialization.Encoding.PEM))
        return path

    folder.mkdir()
    root = signed("authority", own)

    def certificates(name: str) -> Certificates:
        key, path = ec.generate_private_key(ec.SECP256R1()), folder / f"{name}.key"
        plain = serialization.NoEncryption()
        path.write_bytes(key.private_bytes(serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, plain))
        return Certificates(root, signed(name, key), path)

    return certificates


def test_a_stranger_with_a_certificate_of_another_authority_is_refused(tmp_path: Path) -> None:
    ours, theirs = authority(tmp_path / "ours"), authority(tmp_path / "theirs")
    address, mine, strange = f"tls/127.0.0.1:{free_port()}", ours("me"), theirs("stranger")
    with robot(Endpoint(address, ours("robot"))):
        with Client(Endpoint(address, mine)) as client:
            assert client.state().tick >= 0
        with pytest.raises(RobotError, match="or refuses this certificate"):
            Client(Endpoint(address, Certificates(mine.authority, strange.certificate, strange.key)))
