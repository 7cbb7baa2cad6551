"""A newcomer's first hour, as transcripts: what they type, from an empty folder, and what answers."""

import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from laboratory import NEEDS_PYBULLET, need
from terminal import BIN, COARSE, run

from sarah.simulation.engines import default_engine

QUICK = ("--episode.time-limit", "1.5", *COARSE, "--workers", "2")


def typed(line: str, folder: Path) -> str:
    """What a command prints; the words of a line are separated by blanks."""
    name, *arguments = line.split()
    process = run(name, *arguments, cwd=folder)
    assert process.returncode == 0, f"{line}: {process.stderr}"
    return process.stdout


def stopped(line: str, folder: Path) -> str:
    """What a command says on its standard error when Ctrl-C comes once it has written a window."""
    name, *arguments = line.split()
    journal = folder / "mine/journal.jsonl"
    before = journal.stat().st_size
    process = subprocess.Popen([BIN / name, *arguments], stderr=subprocess.PIPE, text=True, cwd=folder)
    while process.poll() is None and journal.stat().st_size == before:
        time.sleep(0.002)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=300)
    assert process.returncode == 128 + signal.SIGINT
    return said


def program(text: str, folder: Path) -> str:
    """What a program of a few lines prints."""
    (folder / "program.py").write_text(text)
    process = subprocess.run([sys.executable, "program.py"], capture_output=True, text=True, cwd=folder, timeout=300)
    assert process.returncode == 0, process.stderr
    return process.stdout


@NEEDS_PYBULLET
def test_see_a_robot(tmp_path: Path) -> None:
    typed("sarah-video stepping --out robot.gif --seconds 1 1.2", tmp_path)
    typed("sarah-view balance --out robot.html --episode.time-limit 2", tmp_path)
    assert (tmp_path / "robot.gif").stat().st_size > 5000 and (tmp_path / "robot.html").stat().st_size > 100_000


@pytest.fixture(scope="module")
def trained(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a short training in ``run``."""
    folder = tmp_path_factory.mktemp("hour")
    typed(f"sarah-train --task stepping --episodes 20 --seed 1 --out run {' '.join(QUICK)}", folder)
    return folder


def test_train_and_evaluate_on_unseen_seeds(trained: Path) -> None:
    shown = typed("sarah-eval run --episodes 2", trained)
    assert "which no training has seen" in shown and "score" in shown


def test_td3_against_naf_in_one_picture(trained: Path) -> None:
    typed(f"sarah-train --algo td3 --episodes 20 --seed 1 --out td3 {' '.join(QUICK)}", trained)
    assert "figure_4_reward_and_frequency.png" in typed("sarah-figures run td3 --out figures", trained)


def test_another_learning_rate_and_network(tmp_path: Path) -> None:
    agent = "--agent.learning-rate 1e-4 --agent.mu-layers 64 64 --agent.v-layers 64"
    typed(f"sarah-train --episodes 10 --out run --episode.time-limit 2 {agent}", tmp_path)
    settings = (tmp_path / "run" / "config.yaml").read_text()
    assert "learning_rate: 0.0001" in settings and "mu_layers:\n  - 64\n  - 64\n" in settings


def test_naf_on_an_own_environment_is_a_page_of_the_documentation() -> None:
    """tests/test_docs.py runs it: save, load, EvalCallback, Dict and VecNormalize."""
    page = (Path(__file__).parents[2] / "docs/how_to/own_environment.md").read_text()
    for name in ("NAF(", ".save(", "NAF.load(", "EvalCallback(", "Dict(", "VecNormalize("):
        assert name in page


@NEEDS_PYBULLET
def test_a_longer_thigh_and_a_push_from_the_left_as_a_video(tmp_path: Path) -> None:
    settings = (
        "--episode.push.newtons 80 --episode.push.degrees 0 --episode.push.at-seconds 3 "
        "--episode.dimensions thigh_length 0.38"
    )
    typed(f"sarah-video 0.4,1.3,0.1,1,1 --out out.gif {settings} --seconds 2.9 3.2", tmp_path)
    assert (tmp_path / "out.gif").stat().st_size > 5000


def test_a_reward_with_power(tmp_path: Path) -> None:
    (tmp_path / "my_task.py").write_text(
        "import dataclasses\nimport sarah\n\n"
        "def reward(tick, config):\n    return sarah.equation_2(tick, config) - 0.01 * tick.power\n\n"
        "THRIFTY = dataclasses.replace(sarah.STEPPING, name='thrifty', reward=reward)\n"
    )
    typed("sarah-train --task my_task.py:THRIFTY --episodes 10 --episode.time-limit 2 --out run", tmp_path)
    assert "score" in typed("sarah-eval run --task my_task.py:THRIFTY --episodes 1", tmp_path)


def test_an_own_algorithm_in_a_race(tmp_path: Path) -> None:
    page = (Path(__file__).parents[2] / "docs/how_to/algorithm.md").read_text()
    (script,) = (block for block in re.findall(r"```python\n(.*?)```", page, re.DOTALL) if "HillClimber" in block)
    (tmp_path / "my_race.py").write_text(script)
    race = "my_race.py --out race --algorithms climber random --seeds 1 --episodes 6 --evaluations 1"
    command = [sys.executable, *race.split(), "--episode.time-limit", "2", *COARSE, "--workers", "1"]
    process = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, timeout=300)
    assert process.returncode == 0, process.stderr
    assert "| climber | 1 |" in process.stdout and (tmp_path / "race" / "race.png").exists()


def test_extend_a_training(trained: Path) -> None:
    shown = typed("sarah-train --resume run --simulations 30", trained)
    assert "extending 20 to 30 episodes" in shown and "resuming the training of naf on stepping" in shown


def test_a_robot_of_other_masses(tmp_path: Path) -> None:
    robot = "--episode.dimensions torso_mass 12 thigh_mass 6"
    shown = typed(f"sarah-describe {robot}", tmp_path)
    assert re.search(r"mass +36 kg\n", shown) and (tmp_path / "sarah_robot.png").exists()
    shown = typed(f"sarah-train --episodes 3 --out mine {robot} {' '.join(QUICK)}", tmp_path)
    assert "go with length (1 times the default), mass (1.2) and hip offset (1): sarah-describe mine lists" in shown
    assert "dimensions torso_mass 12, thigh_mass 6" in typed("sarah-eval mine --episodes 1", tmp_path)


def test_servos_and_sensors_of_mine_through_both_trainings(tmp_path: Path) -> None:
    need("mujoco")
    mine = "--engine mujoco --episode.randomisation.actuator-bandwidth 15 --episode.randomisation.delay-seconds 0.03"
    rate = "--episode.physics.control-rate 200 --episode.time-limit 1.5"
    typed(f"sarah-train --episodes 3 --out first {mine} {rate}", tmp_path)
    shown = typed(
        "sarah-train --task balance --from first --episodes 3 --out second --episode.time-limit 1.5", tmp_path
    )
    assert "from first: P1 to P5 and all settings of its episodes, but\n  push newtons 100 to 125" in shown
    settings = (tmp_path / "second/config.yaml").read_text()
    for setting in (
        "engine: mujoco",
        "delay_seconds: 0.03",
        "control_rate: 200",
        "bandwidth:\n    - 15.0\n    - 15.0\n",
    ):
        assert setting in settings
    assert '"control_rate": 200' in (tmp_path / "second/parameters.json").read_text()
    shown = typed("sarah-eval second --episodes 1", tmp_path)
    assert "in mujoco" in shown and "randomisation.delay_seconds 0.03" in shown


@NEEDS_PYBULLET
def test_slope_bumps_and_a_push_in_one_picture(tmp_path: Path) -> None:
    ground = "--episode.terrain.slope-degrees 4 --episode.terrain.roughness 0.01"
    push = "--episode.push.newtons 100 --episode.push.at-seconds 1.2 --episode.time-limit 2"
    typed(f"sarah-video balance --out all.gif {ground} {push} --seconds 1.2 1.3", tmp_path)
    assert (tmp_path / "all.gif").stat().st_size > 5000


def test_a_loop_of_ones_own_on_a_robot_is_a_page_of_the_documentation() -> None:
    """tests/test_docs.py runs it, with the standard library alone."""
    page = (Path(__file__).parents[2] / "docs/how_to/real_robot.md").read_text()
    assert "PatternGenerator(" in page and ".tick(" in page and "parameters.json" in page


def test_lengthen_and_resume_an_operation(tmp_path: Path) -> None:
    """With Ctrl-C while it goes on; what it prints then is what one types next."""
    windows = "--settle-seconds 0.5 --measure-seconds 0.5 --fall-seconds 1"
    shown = typed(f"sarah-operate --minutes 0.1 --out mine {windows} {' '.join(COARSE)}", tmp_path)
    assert "left with   P1 = " in shown
    first = (tmp_path / "mine/windows.csv").read_text()
    interrupted = stopped("sarah-operate --resume mine --minutes 0.3 --compare-frozen", tmp_path)
    assert "interrupted; go on with sarah-operate --resume mine\n" in interrupted
    shown = typed("sarah-operate --resume mine", tmp_path)
    assert "operating for 0.3 min" in shown and "frozen      0." in shown
    assert (tmp_path / "mine/windows.csv").read_text().startswith(first)
    assert "to go on, add --minutes with more than its 0.3" in typed("sarah-operate --resume mine", tmp_path)


def test_the_environment_with_its_settings(tmp_path: Path) -> None:
    shown = program(
        "import gymnasium, sarah\n"
        f"env = gymnasium.make('SarahStepping-v0', engine={default_engine()!r}, time_limit=2)\n"
        "env.reset(seed=0)\nprint(env.step(env.action_space.sample())[4]['result'].duration)\n",
        tmp_path,
    )
    assert float(shown) == 2.0
