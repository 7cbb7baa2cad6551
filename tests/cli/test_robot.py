"""``sarah-robot``, as a user runs it: the simulated robot, a robot of one's own, and what stops them."""

import os
import re
from pathlib import Path

import pytest
from laboratory import need
from terminal import Answer, done


@pytest.fixture(autouse=True)
def quick() -> None:
    need("mujoco")


def test_a_fault_stops_the_robot_which_says_why(tmp_path: Path) -> None:
    words = ("--engine", "mujoco", "--seconds", "5", "--fault", "rate about y: stuck", "--fault-after", "2")
    process = done("sarah-robot", "balance", *words, "--log", "run.mcap", cwd=tmp_path)
    said = [line.split(" s  ")[1] for line in process.stdout.splitlines()[:3]]
    assert said[0] == "stepping: stood for a second" and said[2] == "standing: stopped"
    assert said[1].startswith("stopping: frozen: angular rate y repeats for 0.1")
    assert "500 ticks in 5.00 s" in process.stdout and "ended" not in process.stdout
    told = done("sarah-log", "run.mcap", cwd=tmp_path).stdout
    assert "500; 0 messages dropped" in told and f"{process.stdout.split(' s  ')[2].splitlines()[0]}" in told
    assert re.search(r" 4\.00 s  standing; tilt \d°; 1 steps per second; 0 late ticks\n", process.stderr)


def test_it_may_go_where_it_wants_and_its_episode_may_not(tmp_path: Path) -> None:
    words = ("--engine", "mujoco", "--seconds", "4", "--fault", "rate about x: 0.1 rad/s too high", "--no-supervisor")
    assert "400 ticks in 4.00 s" in done("sarah-robot", "balance", *words, cwd=tmp_path).stdout
    box = ("--episode.box-half-width", "0.03")
    assert "ended: left_box" in done("sarah-robot", "balance", *words, *box, cwd=tmp_path).stdout


def test_ctrl_c_lets_it_stop_and_stand(tmp_path: Path) -> None:
    file = tmp_path / "my_robot.py"
    lines = (
        "import os, signal",
        "from sarah.drivers.simulated_robot import SimulatedRobot",
        "from sarah.episode.tasks import BALANCE",
        "class Robot(SimulatedRobot):",
        "    def read(self):",
        "        if self._ticks == 150: os.kill(os.getpid(), signal.SIGINT)",
        "        return super().read()",
        "ROBOT = Robot(BALANCE.config_of(BALANCE.episode, engine='mujoco'), 0, BALANCE)",
    )
    file.write_text("\n".join(lines))
    scheduler = os.sched_getscheduler(0)
    process = done("sarah-robot", "balance", "--driver", f"{file}:ROBOT", "--real-time", cwd=tmp_path)
    assert [line.split(" s  ")[1] for line in process.stdout.splitlines()[1:3]] == [
        "stopping: asked to stand",
        "standing: stopped",
    ]
    assert "SCHED_FIFO" in process.stderr or "not granted" in process.stderr
    assert os.sched_getscheduler(0) == scheduler


def test_standing_is_all_it_does_if_asked(tmp_path: Path) -> None:
    process = done("sarah-robot", "balance", "--engine", "mujoco", "--seconds", "3", "--stand", cwd=tmp_path)
    assert "300 ticks in 3.00 s, 0 steps" in process.stdout and "stepping" not in process.stdout + process.stderr


def test_mistakes_are_one_line(answer: Answer) -> None:
    for line, words in (
        ("--fault 'one pad: 1 N'", "unknown fault 'one pad: 1 N', did you mean 'one pad: 0 N'?"),
        ("--driver my_robot.py:ROBOT", "--driver needs --real-time: a robot's time passes by the clock"),
        ("--driver my_robot.py:ROBOT --real-time", "there is no file my_robot.py with a driver"),
        ("--driver my_robot.py:ROBOT --fault 'all pads: 0 N'", "--fault is for the simulated robot"),
        ("--stand --no-supervisor", "--stand needs a supervisor: leave --no-supervisor out"),
    ):
        assert words in answer(f"sarah-robot balance {line}")
