"""``sarah-train --offline``, and what takes its folder."""

import csv
import json
from pathlib import Path

import pytest
from known_robots import LOGS
from terminal import COARSE, done, run

from sarah.operation.settings import BOX
from sarah.operation.window import FELT
from sarah.recognition.recognition import read_recognition
from sarah.runs.session_folder import SessionFolder


@pytest.fixture(scope="module")
def learned(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a recognition that was learned from a table."""
    folder = tmp_path_factory.mktemp("work")
    with (folder / "logs.csv").open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(("robot", "kind", *BOX.names, "observed_reward", "fell", *FELT))
        for robot in LOGS:
            for one in robot.windows:
                writer.writerow((robot.name, robot.kind, *one.parameters, one.reward, int(one.fell), *one.felt))
    process = done("sarah-train", "--offline", "logs.csv", "--out", "known", cwd=folder)
    assert "nearest from 72 windows of 6 robots" in process.stdout
    assert "sarah-operate --learner recognise --from known" in process.stderr
    return folder / "known"


def test_other_commands_show_the_one_set_for_all(learned: Path) -> None:
    best = json.loads((learned / "parameters.json").read_text())["parameters"]
    short = ("--episodes", "1", "--episode.time-limit", "2")
    process = done("sarah-eval", "known", *short, cwd=learned.parent)
    assert "one set that is best on average for all robots" in process.stdout
    assert f"V1 = {best['V1']:.3f}" in process.stdout and "sarah-report" not in process.stderr


def test_a_session_keeps_what_it_recognises_by(learned: Path) -> None:
    arguments = ("--learner", "recognise", "--from", "known", *COARSE, "--out", "mine")
    done("sarah-operate", *arguments, "--minutes", "0.1", cwd=learned.parent)
    (learned / "recognition.json").rename(learned / "moved.json")
    done("sarah-operate", "--resume", "mine", "--minutes", "0.15", cwd=learned.parent)
    (learned / "moved.json").rename(learned / "recognition.json")
    mine = SessionFolder.open(learned.parent / "mine")
    assert len(mine.windows()) == 2
    assert read_recognition(mine.recognition_path).identity == mine.spec().recognition
    mine.recognition_path.write_text(read_recognition(mine.recognition_path).text().replace("kind 1", "kind 2"))
    process = run("sarah-operate", "--resume", "mine", "--minutes", "0.2", cwd=learned.parent)
    assert process.returncode == 2 and "another one is given" in process.stderr


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("sarah-operate", "--from", "known"), "--from is for --learner recognise, not careful"),
        (("sarah-operate", "--learner", "recognise", "--from", "nowhere"), "recognition folder nowhere does not exist"),
        (("sarah-operate", "--learner", "recognise", "paper", "--from", "known"), "recognised with: 0.39,0.72"),
        (
            ("sarah-operate", "--learner", "recognise", "--from", "known", "--measure-seconds", "5"),
            "the robot has measure_seconds 5.0, not 4.0",
        ),
        (("sarah-train", "--offline", "logs.csv", "--kind", "nearer"), "nearer"),
        (("sarah-train", "--offline", "none.csv"), "cannot read none.csv"),
        (("sarah-train", "--offline", "known"), "known is no log"),
    ],
)
def test_mistakes_are_one_line_and_leave_no_folder(learned: Path, arguments: tuple[str, ...], reason: str) -> None:
    process = run(*arguments, "--out", "new", cwd=learned.parent)
    assert process.returncode == 2 and reason in process.stderr and process.stderr.count("\n") == 1
    assert not (learned.parent / "new").exists()


def test_coverage_is_shown(learned: Path) -> None:
    process = done("sarah-log", "--coverage", "logs.csv", cwd=learned.parent)
    assert "3 sets in all, 3 of them on more than one robot" in process.stdout
