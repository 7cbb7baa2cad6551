"""A robot that listens and somebody who asks: who can reach it, and what is said over a real connection."""

import datetime
import ipaddress
import itertools
import re
import time
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from hand_made import BALANCE, DT
from listening import free_port, robot

from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import Phase, PhaseChange, SteppingParameters
from sarah.control.supervisor import State, StateChange
from sarah.drivers.loop import LoopTick
from sarah.errors import ConfigurationError, RobotError
from sarah.remote.answers import Answer, Outcome, Telemetry, to_json
from sarah.remote.client import Client
from sarah.remote.endpoints import REQUESTS, TELEMETRY, Certificates, Endpoint
from sarah.remote.reporter import Reporter
from sarah.remote.requests import LearnedWith, Request
from sarah.remote.server import Server
from sarah.remote.slot import Slot
from sarah.robot.reading import STANDING, Side


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
    with pytest.raises(ConfigurationError, match=re.escape("pip install '.[remote]' in the clone")):
        Endpoint().opened(listens=True)


pytest.importorskip("zenoh")


def test_a_push_is_answered_when_applied_and_when_kept() -> None:
    endpoint = Endpoint(f"tcp/127.0.0.1:{free_port()}")
    with robot(endpoint), Client(endpoint) as client:
        applied, kept = client.ask(Request("push", {"V1": 0.5}, LearnedWith()))
        assert (applied.outcome, kept.outcome) == (Outcome.APPLIED, Outcome.KEPT)
        assert client.state().parameters["V1"] == 0.5 and client.state().steps_per_second > 1.0
        (refused,) = client.ask(Request("push", {"V1": 0.6}, LearnedWith(control_rate=50)))
        assert refused.reason == "learned with another robot or controller: control_rate is 50 and not 100"


def test_a_robot_stays_within_reach_if_something_cannot_be_sent(monkeypatch: pytest.MonkeyPatch) -> None:
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


def test_what_is_no_request_changes_nothing_and_nobody_is_late() -> None:
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


def test_a_certificate_of_another_authority_is_refused(tmp_path: Path) -> None:
    ours, theirs = authority(tmp_path / "ours"), authority(tmp_path / "theirs")
    address, mine, strange = f"tls/127.0.0.1:{free_port()}", ours("me"), theirs("stranger")
    with robot(Endpoint(address, ours("robot"))):
        with Client(Endpoint(address, mine)) as client:
            assert client.state().tick >= 0
        with pytest.raises(RobotError, match="or refuses this certificate"):
            Client(Endpoint(address, Certificates(mine.authority, strange.certificate, strange.key)))


STEP = PhaseChange(Phase.LAND, by_sensors=True, is_step=True)


def test_telemetry_is_due_and_counts_steps_and_late_ticks() -> None:
    supervisor: Any = SimpleNamespace(
        state=State.STEPPING,
        phase=Phase.LIFT,
        stance=Side.LEFT,
        tilt=1.23456,
        asked=(SteppingParameters(*PAPER_STEPPING), BALANCE),
    )
    now, due = 0.0, []
    reporter = Reporter(lambda: now)
    for number in range(500):
        now = 0.01 * number
        supervisor.state_change = StateChange(State.STEPPING, State.STANDING, "stood") if number == 100 else None
        change = STEP if number % 50 == 0 else None
        tick = LoopTick(now, None, 0.0, supervisor, change, 0.003 if number in (7, 8) else 0.001)
        if reporter.tick(tick, supervisor):
            due.append(now)
    assert len(due) == pytest.approx(100, abs=1) and due[0] == 0.0
    telemetry = reporter.telemetry(tick, supervisor)
    assert (telemetry.tick, telemetry.seconds, telemetry.late_ticks) == (499, 4.99, 2)
    assert (telemetry.steps_per_second, telemetry.tilt) == (2.0, 1.2346)
    assert (telemetry.state, telemetry.reason, telemetry.phase) == ("stepping", "stood", "lift")
    assert telemetry.parameters["P2"] == 1.3 and telemetry.parameters["V1"] == BALANCE.V1
    assert telemetry.stance == -1 and telemetry.reading is None
    read = reporter.telemetry(tick._replace(reading=STANDING), supervisor).reading
    assert read is not None and read["acceleration"] == [0.0, 0.0, 9.81] and len(read["joints"]) == 6
    now = 100.0  # after a pause, what was not sent is not made up for
    assert [reporter.tick(tick, supervisor) for _ in range(3)] == [True, False, False]
