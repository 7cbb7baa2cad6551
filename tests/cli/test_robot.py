"""``sarah-robot``, as a user runs it: the simulated robot, a robot of one's own, and what stops them."""

import os
import re
import shlex
from pathlib import Path

import pytest
from laboratory import need
from terminal import done, run

from sarah.logs.robot_log import RobotLog


@pytest.fixture(autouse=True)
def quick() -> None:
    need("mujoco")


def test_a_fault_stops_the_robot_which_says_why(tmp_path: Path) -> None:
    words = ("--engine", "mujoco", "--seconds", "5", "--fault", "rate about y: stuck", "--fault-after", "2")
    process = done("sarah-robot", "balance", *words, "--log", "run.mcap", cwd=tmp_path)
    said = [line.split(" s  ")[1] for line in process.stdout.splitlines()[:3]]
    assert "simulated by mujoco, seed 0, from 3 s on: rate about y: stuck\n" in process.stderr
    assert said[0] == "stepping: stood for a second" and said[2].startswith("standing: stopped: frozen")
    assert said[1].startswith("stopping: frozen: angular rate y repeats for 0.1")
    assert "500 ticks in 5.00 s" in process.stdout and "ended" not in process.stdout
    told = done("sarah-log", "run.mcap", cwd=tmp_path).stdout
    assert "500; 0 messages dropped" in told and f"{process.stdout.split(' s  ')[2].splitlines()[0]}" in told
    assert re.search(r" 4\.00 s  standing; tilt \d+°; 1 steps per second; 0 late ticks\n", process.stderr)


ASKEW = "--seconds 4 --fault 'rate about x: 0.1 rad/s too high' --no-supervisor"
RUNS = {
    "--seconds 3 --stand": "300 ticks in 3.00 s, 0 steps",
    "--seconds 1.2 --episode.dimensions thigh_length 0.5": " ticks in 1.2",  # a taller robot has its place
    ASKEW: "400 ticks in 4.00 s",  # it may go where it wants
    f"{ASKEW} --episode.box-half-width 0.03": "the robot ended: left its place",  # and its episode may not
}


@pytest.mark.parametrize("line", RUNS)
def test_a_robot_stands_or_goes_where_it_may(line: str, tmp_path: Path) -> None:
    said = done("sarah-robot", "balance", "--engine", "mujoco", *shlex.split(line), cwd=tmp_path)
    assert RUNS[line] in said.stdout and not ("--stand" in line and "stepping" in said.stdout + said.stderr)


OWN = """
import os, signal, time
from sarah.drivers.driver import Driver, TimedReading
from sarah.robot.reading import STANDING

class Own(Driver):
    limits = [(-0.5, 0.5)] * 6
    ticks, sent, works, is_broken = 0, [], STANDING, False

    def read(self):
        self.ticks += 1
        noise = 1e-3 * (self.ticks % 7)
        if self.is_broken and self.ticks == 9:
            raise OSError("the bus is gone")
        if self.ticks == 500:
            self.ended = "nobody stopped it"
        if self.ticks == 150:
            os.kill(os.getpid(), signal.SIGTERM)  # Ctrl-C may be switched off where tests run
        signals = self.works._replace(acceleration=(noise, noise, 9.81 + noise), angular_rate=(noise,) * 3)
        return TimedReading(signals, time.monotonic())

    def send(self, targets):
        self.sent.append(targets)

    def off(self):
        print(f"off after {len(self.sent)} targets")

ROBOT, BROKEN, SHORT, FUTURE, FREE = Own(), Own(), Own(), Own(), Own()
BROKEN.is_broken = True
SHORT.works = STANDING._replace(joints=(0.0,) * 5)
FUTURE.now = lambda: time.monotonic() - 3600
FREE.limits = [(1.0, 2.0)] * 6
"""


@pytest.fixture
def own(tmp_path: Path) -> Path:
    path = tmp_path / "my_robot.py"
    path.write_text(OWN)
    return path


def test_a_signal_lets_it_stop_and_stand(own: Path) -> None:
    scheduler = os.sched_getscheduler(0)
    process = done("sarah-robot", "balance", "--driver", "my_robot.py:ROBOT", "--real-time", cwd=own.parent)
    said = [line.split(" s  ")[1] for line in process.stdout.splitlines() if " s  " in line]
    assert said[1:] == ["stopping: asked to stand", "standing: stopped: asked to stand"]
    assert "off after 15" in process.stdout and ", 0 steps\n" in process.stdout and "later than 2 ms" in process.stdout
    assert "SCHED_FIFO" in process.stderr or "not granted" in process.stderr
    assert os.sched_getscheduler(0) == scheduler


def test_a_robot_is_let_go_before_its_log_is_completed(own: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    close = RobotLog.close
    monkeypatch.setattr(RobotLog, "close", lambda log: (print("the log is completed"), close(log)))
    words = ("--driver", "my_robot.py:ROBOT", "--real-time", "--log", "run.mcap", "--seconds", "1.1")
    said = done("sarah-robot", "balance", *words, cwd=own.parent).stdout
    assert 0 < said.index("off after") < said.index("the log is completed")


def test_nothing_is_sent_to_a_robot_that_is_only_read(own: Path) -> None:
    words = ("--driver", "my_robot.py:ROBOT", "--real-time", "--read-only", "--seconds", "1.2")
    process = done("sarah-robot", "balance", *words, cwd=own.parent)
    assert "off" not in process.stdout
    assert re.search(r"acceleration \+0.00 \+0.00 \+9.81; angular rate .*; loads 0 0; joints \+0.00 ", process.stderr)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("BROKEN", "my_robot.py, line 14: OSError: the bus is gone"),
        ("SHORT", "joints of a reading must be 6 numbers, not (0.0, 0.0, 0.0, 0.0, 0.0)"),
        ("FUTURE", "the time at which a reading was taken must be one of the driver's clock, now(), which says"),
        ("FREE", "limits must be 6 ranges around zero"),
    ],
)
def test_mistakes_of_a_driver_are_one_line(name: str, words: str, own: Path) -> None:
    process = run("sarah-robot", "balance", "--driver", f"my_robot.py:{name}", "--real-time", cwd=own.parent)
    assert process.returncode == 2 and process.stderr.splitlines()[-1].startswith(f"sarah-robot: error: {words}")
