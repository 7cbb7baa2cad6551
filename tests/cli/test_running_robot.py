"""A robot that listens, and one that runs by itself, as a user operates them; and the tutorial, command by command.

The robot and the viewer of the tutorial are processes of their own: that a learner, a viewer and a pusher reach another
process is what it is about.
"""

import contextlib
import json
import re
import shlex
import subprocess
import threading
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from laboratory import need
from listening import free_port, robot
from terminal import BIN, Answer, done, run

from sarah.cli.endpoints import with_endpoint
from sarah.errors import RobotError
from sarah.remote.client import Client
from sarah.remote.endpoints import DEFAULT_ENDPOINT, Endpoint
from sarah.remote.requests import Request
from sarah.runs.session_folder import SessionFolder

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


pytest.importorskip("zenoh")

TUTORIAL = Path(__file__).parents[2] / "docs/tutorials/a_running_robot.md"
SHORT = ("--settle-seconds", "0", "--measure-seconds", "0.5")
"""Options of windows that are as short as can be."""


@contextmanager
def begun(words: list[str], folder: Path) -> Iterator[subprocess.Popen[str]]:
    process = subprocess.Popen(
        [str(BIN / words[0]), *words[1:]], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        yield process
    finally:
        process.terminate()
        process.communicate(timeout=60)


def headless(line: str, address: str, page: int) -> list[str]:
    """Words of a line of the tutorial, at another address, with a browser's part left out, and short."""
    words = shlex.split(line.replace(DEFAULT_ENDPOINT, address))
    if words[0] == "sarah-robot":
        words.insert(words.index("--listen") + 1, address)
    elif words[0] == "sarah-push":
        words += ["--to", address] + ["--no-wait"] * (not words[1].startswith("--"))
    elif words[0] == "sarah-view":
        words += ["--port", str(page)] if "--robot" in words else ["--out", "run.html"]
    elif "--minutes" in words:
        words[words.index("--minutes") + 1] = "0.1"
        words += SHORT
    elif words[0] == "sarah-eval":
        words += ["--episode.time-limit", "1.5"]
        words[words.index("--episodes") + 1] = "1"
    return words


def wait_for(address: str, process: subprocess.Popen[str]) -> None:
    while process.poll() is None:
        with contextlib.suppress(RobotError), Client(Endpoint(address)) as client:
            client.state()
            return
        time.sleep(0.1)
    pytest.fail(process.communicate()[1])


def test_the_tutorial(tmp_path: Path) -> None:
    pytest.importorskip("viser")
    address, page, said = f"tcp/127.0.0.1:{free_port()}", free_port(), list[str]()
    lines = re.findall(r"^    (sarah-.+)$", TUTORIAL.read_text(), re.MULTILINE)
    start, watch, *commands = (headless(line, address, page) for line in lines)
    assert start[0] == "sarah-robot" and watch[:2] == ["sarah-view", "--robot"]
    after = [words[0] for words in commands].index("sarah-log")
    with begun(start, tmp_path) as process:
        wait_for(address, process)
        with begun(watch, tmp_path) as viewer:
            for words in commands[:after]:
                said.append(done(*words, cwd=tmp_path).stdout)
            assert viewer.stdout is not None and f"SARAH is at http://127.0.0.1:{page}" in viewer.stdout.readline()
            with urllib.request.urlopen(f"http://127.0.0.1:{page}") as answer:
                assert answer.status == 200
    state, locked, given_back, learned, resumed, stood = said
    assert state.startswith("state: st") and "parameters: P1 0." in state
    assert locked.startswith("applied at tick") and given_back.startswith("applied at tick")
    assert "simulated by" in learned and "observed" not in learned and "score  " in learned
    assert resumed == "learned is finished: to go on, add --minutes with more than its 0.1\n"
    assert stood.startswith("applied at tick")
    log, _, _, judged = (done(*words, cwd=tmp_path).stdout for words in commands[after:])
    windows = SessionFolder.open(tmp_path / "learned").windows()
    assert (
        re.search(rf"windows +{len(windows)}, observed reward", log) and (tmp_path / "run.html").stat().st_size > 10_000
    )
    assert "survival" in judged


def test_a_robot_that_measures_no_windows_is_no_robot_to_operate(tmp_path: Path, answer: Answer) -> None:
    endpoint = Endpoint(f"tcp/127.0.0.1:{free_port()}")
    with robot(endpoint):
        assert "this robot does not say what it is" in answer(f"sarah-operate --robot {endpoint.address}")
