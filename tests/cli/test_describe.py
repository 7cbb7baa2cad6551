"""``sarah-describe``, as a user runs it."""

import io
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from laboratory import need
from terminal import SHORT, run

DIMENSIONS = ("--episode.dimensions", "thigh_length", "0.2", "shank_length", "0.25")


def test_it_shows_the_default_robot_and_another(tmp_path: Path) -> None:
    usual, other = (
        run("sarah-describe", "--out", name, *dimensions, cwd=tmp_path)
        for name, dimensions in (("usual", ()), ("other", DIMENSIONS))
    )
    assert usual.stderr == other.stderr == ""
    for text in ("mass             30 kg", "standing height  0.84 m", "centre of mass   0.4877 m", "left_hip_flexion"):
        assert text in usual.stdout
    assert "standing height  0.65 m" in other.stdout and "thigh_length" not in usual.stdout
    assert ["thigh_length", "0.2", "0.33", "m"] in [line.split() for line in other.stdout.splitlines()]
    assert other.stdout.splitlines()[-2:] == ["other/sarah_robot.png", "other/sarah_robot.urdf"]
    files = {path.name for path in (tmp_path / "other").iterdir()}
    assert files == {"sarah_robot.png", "sarah_robot.urdf"}


def test_other_tools_load_the_urdf_from_the_file_alone(tmp_path: Path) -> None:
    run("sarah-describe", *DIMENSIONS, cwd=tmp_path)
    text = (tmp_path / "sarah_robot.urdf").read_text()
    import yourdfpy

    robot = yourdfpy.URDF.load(io.StringIO(text))
    assert robot.validate() and robot.get_transform("left_forefoot", "left_hip")[2, 3] == pytest.approx(-0.45)
    need("mujoco")
    import mujoco

    assert mujoco.MjModel.from_xml_path(str(tmp_path / "sarah_robot.urdf")).njnt == 10


def test_it_shows_the_robot_of_a_training(tmp_path: Path) -> None:
    short = ("--task", "stepping", "--algo", "random", "--episodes", "2", "--run-dir", "mine", *SHORT)
    assert run("sarah-train", *short, *DIMENSIONS, cwd=tmp_path).returncode == 0
    shown = run("sarah-describe", "mine", cwd=tmp_path).stdout
    assert shown == run("sarah-describe", *DIMENSIONS, cwd=tmp_path).stdout


def test_it_needs_neither_an_engine_nor_a_learner(tmp_path: Path) -> None:
    program = (
        "import sys\nfrom sarah.cli.describe import main\nsys.argv = ['sarah-describe']\nmain()\n"
        "sys.exit(' '.join({'pybullet', 'mujoco', 'torch'} & set(sys.modules)) or 0)"
    )
    process = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=tmp_path)
    assert process.returncode == 0, process.stderr
    assert (tmp_path / "sarah_robot.png").stat().st_size > 50_000


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("nobody", "'nobody' is neither a run folder, nor numbers"),
        ("--episode.dimensions tigh_length 0.3", "did you mean 'thigh_length'"),
        ("--episode.dimensions thigh_length 9", "'thigh_length' must be a number between 0.033 and 3.3 m, not 9.0 (default: 0.33 m; distance from"),
        ("--episode.dimensions hinge_height 0.005", "the foot plates must lie above the soles"),
    ],
)
def test_a_mistake_is_one_line_and_writes_nothing(answer: Callable[[str], str], arguments: str, message: str) -> None:
    assert message in answer(f"sarah-describe {arguments}")
