"""``sarah-push`` and a robot that listens, as a user runs both."""

import json
import threading
import time
from pathlib import Path

import pytest
from laboratory import need
from listening import free_port, robot
from terminal import Answer, done, run

from sarah.cli.endpoints import with_endpoint
from sarah.errors import RobotError
from sarah.remote.client import Client
from sarah.remote.endpoints import Endpoint
from sarah.remote.requests import Request

pytest.importorskip("zenoh")


def test_parameters_state_standing_and_stepping(tmp_path: Path) -> None:
    endpoint = Endpoint(f"tcp/127.0.0.1:{free_port()}")
    to = ("--to", endpoint.address)
    with robot(endpoint):
        lines = done("sarah-push", "0.5,0,0.5,0", *to, cwd=tmp_path).stdout.splitlines()
        assert lines[0].startswith("applied at tick ") and lines[1].startswith("kept at tick ")
        lines = done("sarah-push", "balance", "--no-wait", "--json", *to, cwd=tmp_path).stdout.splitlines()
        (answer,) = map(json.loads, lines)
        assert (answer["schema"], answer["outcome"], answer["state"]) == (1, "applied", "stepping")
        state = json.loads(done("sarah-push", "--state", "--json", *to, cwd=tmp_path).stdout)
        assert state["parameters"] == {
            **dict(zip(("P1", "P2", "P3", "P4", "P5"), (0.39, 0.72, 1.24, 0.61, 1.92), strict=True)),
            **dict(zip(("V1", "V2", "V3", "V4"), (0.71, 0.41, 0.7, -0.39), strict=True)),
        }
        assert "parameters: P1 0.39, P2 0.72" in done("sarah-push", "--state", *to, cwd=tmp_path).stdout
        refused = run("sarah-push", "--step", *to, cwd=tmp_path)
        assert refused.returncode == 1 and "the robot steps already" in refused.stdout
        assert "applied at tick" in done("sarah-push", "--stand", *to, cwd=tmp_path).stdout


def test_a_robot_that_runs_takes_a_push(tmp_path: Path) -> None:
    need("mujoco")
    endpoint, answers = Endpoint(f"tcp/127.0.0.1:{free_port()}"), list[str]()

    def push() -> None:
        while True:
            try:
                with Client(endpoint) as client:
                    for v1 in (-1.0, 0.6):  # from 0.71
                        answers.extend(answer.outcome.value for answer in client.ask(Request("push", {"V1": v1})))
                    return
            except RobotError:
                time.sleep(0.05)

    pusher = threading.Thread(target=push)
    pusher.start()
    words = ("--engine", "mujoco", "--real-time", "--seconds", "2.5", "--listen", endpoint.address)
    process = done("sarah-robot", "balance", *words, "--largest-change", "0.1", "--log", "run.mcap", cwd=tmp_path)
    pusher.join()
    assert "2 sets asked for, 2 applied" in done("sarah-log", "run.mcap", cwd=tmp_path).stdout
    assert answers == ["refused", "applied", "stopped"] and f"listening at {endpoint.address}" in process.stderr


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("--listen", "--listen tcp/127.0.0.1:7447"),
        ("--listen balance", "--listen tcp/127.0.0.1:7447 balance"),
        ("--listen --stand", "--listen tcp/127.0.0.1:7447 --stand"),
        ("--listen tls/robot:1 balance", "--listen tls/robot:1 balance"),
        ("--listen=tls/robot:1", "--listen=tls/robot:1"),
        ("--listen udp/robot:1", "--listen udp/robot:1"),
    ],
)
def test_an_address_may_be_left_out(given: str, words: str) -> None:
    assert " ".join(with_endpoint(given.split())) == words


def test_mistakes_are_one_line(answer: Answer) -> None:
    for line, words in (
        ("sarah-push", "give one of parameters, --stand, --step and --state"),
        ("sarah-push balance --step", "give one of parameters, --stand, --step and --state"),
        ("sarah-push 0.4,1.3", "parameters must be 5 numbers (P1 to P5), 4 (V1 to V4) or 9, not 2"),
        ("sarah-push 0.4,x", "parameters must be numbers separated by commas, not '0.4,x'"),
        ("sarah-push 3,0,0,0", "parameter V1 must be between -2 and 2, not 3.0"),
        ("sarah-push --state --to tcp/127.0.0.1:9", "no robot listens at tcp/127.0.0.1:9"),
        ("sarah-push --state --to tls/127.0.0.1:9 --key me.key", "give --authority, --certificate and --key"),
        ("sarah-robot --listen tcp/0.0.0.0:7447", "tcp/0.0.0.0:7447 can be reached from other machines"),
        ("sarah-robot balance --listen --no-supervisor", "--listen needs a supervisor: leave --no-supervisor out"),
    ):
        assert words in answer(line)
