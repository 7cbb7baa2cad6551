"""A robot that runs by itself, as a user operates it; and the tutorial about one, command by command.

The robot and the viewer are processes of their own: that a learner, a viewer and a pusher reach another process is what
the tutorial is about.
"""

import contextlib
import re
import shlex
import subprocess
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from listening import free_port, robot
from terminal import BIN, Answer, done

from sarah.errors import RobotError
from sarah.remote.client import Client
from sarah.remote.endpoints import DEFAULT_ENDPOINT, Endpoint
from sarah.runs.session_folder import SessionFolder

pytest.importorskip("zenoh")

TUTORIAL = Path(__file__).parents[2] / "docs/tutorials/a_running_robot.md"
SHORT = ("--settle-seconds", "0", "--measure-seconds", "0.5")
"""Options of windows that are as short as can be."""


@contextmanager
def begun(words: list[str], folder: Path) -> Iterator[subprocess.Popen[str]]:
    """A command in a process of its own, which is asked to end."""
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
    """Wait until a robot listens."""
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


HAS_NO_EFFECT = (
    *("--engine mujoco", "--episode.payload 5", "--physics reference", "--change '1: payload=5'", "--compare-frozen"),
    *("--fall-seconds 5", "--push_seconds 5", "--log it.mcap", "--episode.push.newtons 20"),
)


def test_what_has_no_effect_on_a_robot_that_runs_by_itself_is_named(answer: Answer) -> None:
    for option in HAS_NO_EFFECT:
        name = shlex.split(option)[0].replace("_", "-")
        words = f"{name} has no effect on a robot that runs by itself: leave it or --robot out"
        assert words in answer(f"sarah-operate --robot tcp/127.0.0.1:9 {option}")
    assert "no robot listens at tcp/127.0.0.1:9" in answer("sarah-operate --robot tcp/127.0.0.1:9 --seed 3")
    assert "it needs --robot" in answer("sarah-operate --gone-seconds 5")
    for line, words in (
        ("sarah-robot --lockstep", "it needs --listen"),
        ("sarah-robot --lockstep --listen --real-time", "leave out --lockstep or --real-time"),
    ):
        assert words in answer(line)


def test_a_robot_that_measures_no_windows_is_no_robot_to_operate(tmp_path: Path, answer: Answer) -> None:
    endpoint = Endpoint(f"tcp/127.0.0.1:{free_port()}")
    with robot(endpoint):
        assert "this robot does not say what it is" in answer(f"sarah-operate --robot {endpoint.address}")
