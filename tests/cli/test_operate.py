"""``sarah-operate`` and ``sarah-train --offline``, as a user types them, and what takes their folders."""

import csv
import dataclasses
import json
import re
import shutil
from pathlib import Path

import pytest
from known_robots import LOGS
from terminal import COARSE, Answer, done, run

from sarah.cli.coverage import names_shown
from sarah.cli.offline import train_offline
from sarah.cli.operate import change_of
from sarah.cli.operate_text import scores_of
from sarah.errors import TrainingInterruptedError
from sarah.operation.settings import BOX, PARAMETERS, SHIPPED, Change
from sarah.operation.window import FELT, Window
from sarah.recognition.recognition import read_recognition
from sarah.runs.session_folder import SessionFolder
from sarah.training.operate import SessionResult

WINDOWS = ("--settle-seconds", "0.5", "--measure-seconds", "0.5", "--fall-seconds", "1")
QUICK = (*WINDOWS, *COARSE)


@pytest.fixture(scope="module")
def operated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a short session with weak servos, and a payload from its middle on."""
    folder = tmp_path_factory.mktemp("work")
    arguments = ("--minutes", "0.2", "--seed", "2", "--episode.randomisation.actuator-bandwidth", "12", *QUICK)
    process = done("sarah-operate", "--change", "0.1: payload=5", *arguments, "--out", "mine", cwd=folder)
    begins = "robot of balance: all settings of its episodes, but\n  "
    assert process.stdout.startswith(begins) and "randomisation.actuator_bandwidth 12 instead of" in process.stdout
    assert "operating for 0.2 min with learner careful into mine\n" in process.stdout
    ends = (
        r"\nleft with   P1 = \d\.\d\d, .*V4 = .*\nscore       0\..*\nfalls       \d in \d+ windows\nfolder      mine\n"
    )
    assert re.search(ends, process.stdout) and "no change" not in process.stdout
    return folder / "mine"


def test_other_commands_take_its_folder(operated: Path) -> None:
    left = json.loads((operated / "parameters.json").read_text())["parameters"]
    short = ("--episodes", "1", "--episode.time-limit", "2", "--json")
    found = json.loads(run("sarah-eval", "mine", *short, cwd=operated.parent).stdout)
    assert found["algorithm"] == "careful" and found["task"] == "balance"
    assert found["parameters"] == {name: left[name] for name in ("V1", "V2", "V3", "V4")}
    done("sarah-operate", "mine", "--minutes", "0.1", "--learner", "none", cwd=operated.parent)
    folder = SessionFolder.open(operated.parent / "runs/operation/none-s0")
    (first, *_) = folder.windows()
    assert first.parameters == tuple(left[parameter.name] for parameter in PARAMETERS)
    assert folder.spec().config.settle_seconds == 0.5  # its windows too


@pytest.mark.parametrize(
    "command", ["sarah-report", "sarah-figures", "sarah-train --resume", "sarah-train --task balance --from"]
)
def test_what_is_for_trainings_says_so(operated: Path, command: str) -> None:
    process = run(*command.split(), "mine", cwd=operated.parent)
    said = rf"{command.split()[0]}: error: mine is not the folder of a (finished )?training: it has no config.yaml\n"
    assert process.returncode == 2 and re.fullmatch(said, process.stderr)


def test_a_finished_session_goes_on_if_it_is_made_longer(operated: Path, tmp_path: Path) -> None:
    finished = run("sarah-operate", "--resume", "mine", cwd=operated.parent)
    assert finished.stdout == "mine is finished: to go on, add --minutes with more than its 0.2\n"
    shutil.copytree(operated, tmp_path / "mine")
    more = done("sarah-operate", "--resume", "mine", "--minutes=0.25", cwd=tmp_path)
    assert "extending 0.2 to 0.25 min: the windows so far stay as they are\noperating for 0.25 min" in more.stdout
    assert (tmp_path / "mine/windows.csv").read_text().startswith((operated / "windows.csv").read_text())
    assert SessionFolder.open(tmp_path / "mine").spec().config.extended_from == (0.2,)


REFUSED = {
    "--minutes 0.1": "--resume mine: minutes is 0.2 in this session, not 0.1: leave it out",
    "--minutes 700": "operation.minutes must be between 0.1 and 600 min, not 700.0",
    "--minutes 0.3 --seed 3": "--resume goes on with a session as it is: leave '--seed' out",
    "--extended-from 0.1": "leave '--extended-from' out",
}


def test_a_session_goes_on_as_it_was_begun_or_says_why_not(answer: Answer, operated: Path, tmp_path: Path) -> None:
    shutil.copytree(operated, tmp_path / "mine")
    for options, words in REFUSED.items():
        assert words in answer(f"sarah-operate --resume mine {options}")
    (tmp_path / "mine/parameters.json").unlink()
    assert "it can be extended once it is finished" in answer("sarah-operate --resume mine --minutes 0.3")
    spec = tmp_path / "mine/session.yaml"
    spec.write_text(spec.read_text().replace("seed: 2", "seed: 3"))
    line = answer("sarah-operate --resume mine")
    assert "seed is 3 here, and 2 in this session" in line and "go on with" not in line


def test_an_interrupted_session_says_how_to_go_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def operate(*_: object) -> None:
        raise TrainingInterruptedError("interrupted")

    monkeypatch.setattr("sarah.training.operate.operate", operate)
    process = run("sarah-operate", "--out", "mine", cwd=tmp_path)
    assert process.returncode == 130
    assert process.stderr.endswith("\nsarah-operate: interrupted; go on with sarah-operate --resume mine\n")


def test_a_session_is_compared_with_one_without_learning(tmp_path: Path) -> None:
    process = done("sarah-operate", "--minutes", "0.1", *QUICK, "--compare-frozen", "--out", "mine", cwd=tmp_path)
    said, _, summary = process.stdout.partition("left with")
    assert "without learning, which takes as long again, into mine/frozen" in said
    assert re.search(r"frozen +0\.\d{3}: .*; falls: \d in \d+ windows", summary)
    shutil.rmtree(tmp_path / "mine/frozen")
    again = run("sarah-operate", "--resume", "mine", "--compare_frozen", cwd=tmp_path)
    assert again.stdout.partition("left with")[2] == summary
    assert "is finished" in run("sarah-operate", "--resume", "mine", cwd=tmp_path).stdout


def test_every_change_counts_and_one_that_came_too_late_is_named(tmp_path: Path) -> None:
    line = ("--minutes", "0.2", *QUICK, "--learner", "none", "--episode.push.newtons", "10", "--out", "first")
    changes = ("--change", "0.03: payload=3", "--change", "0.06: physics.control-rate=50", "--change", "0.2: payload=6")
    first = done("sarah-operate", *line, *changes, cwd=tmp_path)
    folder = SessionFolder.open(tmp_path / "first")
    assert sorted({window.changes for window in folder.windows()}) == [0, 1, 2]
    assert folder.spec().config.robot.push.newtons == (10.0, 10.0)
    assert "no change   at minute 0.2: no window began after it\nfolder" in first.stdout
    assert first.stdout.count("no change") == 1


def test_a_summary_has_three_scores_and_a_change_may_lie_deep() -> None:
    def result(*scores: float) -> SessionResult:
        window = Window(0, 0.0, 6.0, 0, SHIPPED, 0.0, 0.0, False, (0.0,) * len(FELT))
        return SessionResult(tuple(dataclasses.replace(window, score=score) for score in scores), SHIPPED)

    said = "0.480: 0.200 in the first 2 windows, 0.700 in the last"
    assert scores_of(result(0.1, 0.3, *(0.5,) * 6, 0.6, 0.8)) == said
    assert scores_of(result(0.2, 0.4)) == "0.300: 0.200 in the first window, 0.400 in the last"
    change = Change(5.0, {"randomisation": {"actuator_bandwidth": 12}})
    assert change_of("5: randomisation.actuator-bandwidth = 12") == change


def test_what_has_no_effect_is_not_listed(tmp_path: Path) -> None:
    listed = set(re.findall(r"--episode[\w.-]+", run("sarah-operate", "--help", cwd=tmp_path).stdout))
    assert {"--episode.push.newtons", "--episode.payload"} <= listed
    assert listed.isdisjoint(("--episode.time-limit", "--episode.reward-form", "--episode.push.at-seconds"))


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
    resumed = done("sarah-operate", "--resume", "mine", "--minutes", "0.15", cwd=learned.parent)
    assert "\nrecognised  unlike all 3 known kinds\nknown sets  none ran" in resumed.stdout
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
        (("sarah-operate", "--learner", "recognise", "--from", "logs.csv"), "recognition folder logs.csv is a file"),
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


def test_what_is_left_out_does_not_count_as_learned(
    learned: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    header, *_, last = (learned.parent / "logs.csv").read_text().splitlines()
    last = last.replace(LOGS[-1].name, "mine").replace("kind 1", "mine").rpartition(",")[0]
    (tmp_path / "other.csv").write_text(f"{header}\n{last},3.0\n")
    logs = (str(learned.parent / "logs.csv"), str(tmp_path / "other.csv"))
    train_offline(("--offline", *logs, "--out", str(tmp_path / "known")))
    said = capsys.readouterr().out
    assert "from 72 windows of 6 robots\nleft out    mine: it never ran the parameters that" in said
    assert f"recognised with, {SHIPPED[0]:g},{SHIPPED[1]:g}," in said


def test_coverage_is_shown(learned: Path) -> None:
    process = done("sarah-log", "--coverage", "logs.csv", cwd=learned.parent)
    assert "3 sets in all, 3 of them on more than one robot" in process.stdout
    rows = [line.split() for line in process.stdout.splitlines()]
    assert rows[0][:4] == ["robot", "windows", "shipped", "sets"] and rows[1][3:6] == ["12", "6", "3"]


def test_names_of_robots_are_shortened_only_as_long_as_they_differ() -> None:
    far = [f"payload {number}.0, engine mujoco, randomisation.friction 0.5, seed 0" for number in (8, 9)]
    assert names_shown([*far, "mine"]) == [f"{one[:18]}…{one[-21:]}" for one in far] + ["mine"]
    middle = [f"engine mujoco, randomisation.friction {number}.0, payload 8.0, seed 0, change 1" for number in (1, 2)]
    assert names_shown(middle) == middle
