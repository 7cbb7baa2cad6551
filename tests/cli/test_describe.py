"""``sarah-describe``, as a user runs it."""

import re
from dataclasses import replace
from pathlib import Path

import pytest
from laboratory import need
from pytest import MonkeyPatch
from terminal import Trained, done, run

from sarah.cli.describe_text import lines_of
from sarah.episode.settings import EpisodeConfig

DIMENSIONS = ("--episode.dimensions", "thigh_length", "0.2", "shank_length", "0.25")


@pytest.fixture
def undrawn(monkeypatch: MonkeyPatch) -> None:
    """Commands draw no robot, which would take most of their time."""
    monkeypatch.setattr("sarah.pictures.dimension_figure.draw_dimensions", lambda *_: None)


def test_another_robot_is_drawn_and_other_tools_load_its_urdf(tmp_path: Path) -> None:
    process = run("sarah-describe", *DIMENSIONS, "--out", "other", cwd=tmp_path)
    said = "to train it:  sarah-train --episode.dimensions thigh_length 0.2 shank_length 0.25\n"
    assert process.returncode == 0 and re.sub(r":  \S*/sarah", ":  sarah", process.stderr) == said
    lines = process.stdout.splitlines()
    assert "standing height  0.65 m" in process.stdout and "left_hip_flexion" in process.stdout
    assert ["thigh_length", "0.2", "0.33", "m"] in [line.split() for line in lines]
    assert lines[-2:] == ["other/sarah_robot.png", "other/sarah_robot.urdf"]
    assert {path.name for path in (tmp_path / "other").iterdir()} == {"sarah_robot.png", "sarah_robot.urdf"}
    file = str(tmp_path / "other" / "sarah_robot.urdf")
    import yourdfpy

    robot = yourdfpy.URDF.load(file)
    assert robot.validate() and robot.get_transform("left_forefoot", "left_hip")[2, 3] == pytest.approx(-0.45)
    need("mujoco")
    import mujoco

    assert mujoco.MjModel.from_xml_path(file).njnt == 10


def test_the_robot_of_a_training_is_not_trained_again(trained: Trained, undrawn: None, tmp_path: Path) -> None:
    process = run("sarah-describe", str(trained[0]), cwd=tmp_path)
    assert "standing height  0.84 m" in process.stdout and process.stderr == ""


def test_it_says_what_follows_from_size_and_what_was_set_by_hand() -> None:
    usual = EpisodeConfig()
    config = usual.for_robot({"torso_mass": 38.0})
    config = replace(config, controller=replace(config.controller, pad_threshold=40.0, largest_blow=50.0))
    text, plain = ("\n".join(lines_of(each, usual)) for each in (config, usual))
    rows = {line.split()[0]: line.split()[1:] for line in text.split("Follows from ")[1].splitlines() if line}
    assert rows["leg_effort"] == ["2000", "1000"] and rows["hip_effort"] == ["300", "150"]
    assert rows["episode.controller.pad-threshold"] == ["40", "30", "the", "rule", "gives", "60"]
    assert "episode.controller.leg-speed" not in rows and "episode.controller.largest-blow" not in rows
    assert "\nstanding height  0.84 m" in plain and plain.startswith("mass             30 kg")
    assert "default" not in plain


@pytest.mark.parametrize("newtons", [5, 30])
def test_a_file_and_options_describe_one_robot(newtons: int, undrawn: None, tmp_path: Path) -> None:
    controller = f"{{pad_threshold: {newtons}}}"
    (tmp_path / "mine.yaml").write_text(f"episode: {{dimensions: {{thigh_length: 0.2}}, controller: {controller}}}\n")
    options = "--episode.dimensions=torso_mass 23 --episode.dimensions shank_length 0.25"
    process = done("sarah-describe", "--config", "mine.yaml", *options.split(), cwd=tmp_path)
    for row in ("thigh_length +0.2 ", "torso_mass +23 ", "shank_length +0.25 "):
        assert re.search(f"\n{row}", process.stdout)
    assert re.search(rf"controller.pad-threshold +{newtons} +30 +the rule gives 45\n", process.stdout)
