"""``sarah-operate``, as a user types it."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from terminal import run

from sarah.cli.operate import main

QUICK = ("--settle-seconds", "0.5", "--measure-seconds", "0.5", "--fall-seconds", "1")
BYTES = ("windows.csv", "parameters.json", "journal.jsonl")


@pytest.fixture(scope="module")
def operated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a short session with weak servos, and a payload from its middle on."""
    folder = tmp_path_factory.mktemp("work")
    arguments = ("--minutes", "0.2", "--seed", "2", "--episode.randomisation.actuator-bandwidth", "12", *QUICK)
    process = run("sarah-operate", "--change", "0.1: payload=5", *arguments, "--out", "mine", cwd=folder)
    assert process.returncode == 0, process.stderr
    assert "P1 = " in process.stdout and "V4 = " in process.stdout and "falls       0 in" in process.stdout
    return folder / "mine"


def test_it_writes_a_folder(operated: Path) -> None:
    names = {path.name.split(".tfevents")[0] for path in operated.iterdir()}
    assert names == {
        *("command.txt", "events.out", "journal.jsonl", "parameters.json", "session.pdf", "session.png"),
        *("session.yaml", "versions.txt", "windows.csv"),
    }
    assert set(json.loads((operated / "parameters.json").read_text())["parameters"]) == {
        *(f"P{index}" for index in range(1, 6)),
        *(f"V{index}" for index in range(1, 5)),
    }


def test_other_commands_take_its_folder(operated: Path) -> None:
    process = run("sarah-eval", "mine", "--episodes", "1", "--episode.time-limit", "2", "--json", cwd=operated.parent)
    assert process.returncode == 0, process.stderr
    found = json.loads(process.stdout)
    left = json.loads((operated / "parameters.json").read_text())["parameters"]
    assert found["algorithm"] == "careful"
    assert found["parameters"] == {name: left[name] for name in ("V1", "V2", "V3", "V4")}
    again = run("sarah-operate", "mine", "--minutes", "0.1", *QUICK, "--learner", "none", cwd=operated.parent)
    assert again.returncode == 0, again.stderr
    first = (operated.parent / "runs/operation/none-s0/windows.csv").read_text().splitlines()[1].split(",")
    assert [float(value) for value in first[4:13]] == list(left.values())


@pytest.mark.parametrize(
    "command", ["sarah-report", "sarah-figures", "sarah-train --resume", "sarah-train --task balance --from"]
)
def test_what_is_for_trainings_says_so(operated: Path, command: str) -> None:
    process = run(*command.split(), "mine", cwd=operated.parent)
    said = rf"{command.split()[0]}: error: mine is not the folder of a (finished )?training: it has no config.yaml\n"
    assert process.returncode == 2 and re.fullmatch(said, process.stderr)


def test_a_change_that_came_too_late_is_named(tmp_path: Path) -> None:
    arguments = ("--minutes", "0.2", "--learner", "none", *QUICK)
    process = run("sarah-operate", "--change", "0.1: payload=5", "--change", "0.2: payload=6", *arguments, cwd=tmp_path)
    assert process.returncode == 0, process.stderr
    assert "no change   at minute 0.2: no window began after it" in process.stdout
    assert "at minute 0.1" not in process.stdout


def test_killed_at_any_moment_it_ends_in_the_same_bytes(tmp_path: Path) -> None:
    """A session goes on after kill -9 as if nothing had been: three times, each some windows further on."""
    line = ["--change", "0.5: payload=5", "--minutes", "1", "--seed", "2", *QUICK, "--out"]
    whole = run("sarah-operate", *line, "whole", cwd=tmp_path)
    assert whole.returncode == 0, whole.stderr
    journal = tmp_path / "cut/journal.jsonl"
    program = "from sarah.cli.operate import main; main()"
    for windows in (1, 19, 47):
        arguments = ["--resume", "cut"] if journal.is_file() else [*line, "cut"]
        process = subprocess.Popen([sys.executable, "-c", program, *arguments], cwd=tmp_path, stderr=subprocess.DEVNULL)
        while process.poll() is None and windows_of(journal) < windows:
            time.sleep(0.002)
        os.kill(process.pid, signal.SIGKILL)
        assert process.wait() == -signal.SIGKILL  # it had not finished
        assert windows <= windows_of(journal)
    finished = run("sarah-operate", "--resume", "cut", cwd=tmp_path)
    assert finished.returncode == 0, finished.stderr
    for name in BYTES:
        assert (tmp_path / "cut" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes(), name


def windows_of(journal: Path) -> int:
    """Number of windows in a journal, whose first row is none."""
    return max(0, journal.read_bytes().count(b"\n") - 1) if journal.is_file() else 0


def test_a_finished_session_says_so(operated: Path) -> None:
    process = run("sarah-operate", "--resume", "mine", cwd=operated.parent)
    assert process.stdout == "mine is finished: to go on, add --minutes with more than its 0.2\n"


def test_a_longer_session_is_the_one_that_was_meant_so(operated: Path) -> None:
    """To the byte, and its first windows stay as they are."""
    folder = operated.parent
    shutil.copytree(operated, folder / "longer")
    more = run("sarah-operate", "--resume", "longer", "--minutes", "0.3", cwd=folder)
    assert more.returncode == 0, more.stderr
    assert "extending 0.2 to 0.3 min: the windows so far stay as they are" in more.stdout
    assert (folder / "longer/windows.csv").read_text().startswith((operated / "windows.csv").read_text())
    line = ["--change", "0.1: payload=5", "--seed", "2", "--episode.randomisation.actuator-bandwidth", "12", *QUICK]
    whole = run("sarah-operate", *line, "--minutes", "0.3", "--extended-from", "0.2", "--out", "whole", cwd=folder)
    assert whole.returncode == 0, whole.stderr
    for name in (*BYTES, "session.yaml"):
        assert (folder / "longer" / name).read_bytes() == (folder / "whole" / name).read_bytes(), name


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ("--minutes 0.1", "--resume mine: minutes is 0.2 in this session, not 0.1: leave it out"),
        ("--minutes 700", "operation.minutes must be between 0.1 and 600 min, not 700.0"),
        ("--minutes 0.3 --seed 3", "--resume goes on with a session as it is: leave '--seed' out"),
        ("--extended-from 0.1", "leave '--extended-from' out"),
    ],
)
def test_a_session_goes_on_as_it_was_begun(
    answer: Callable[[str], str], operated: Path, options: str, words: str
) -> None:
    shutil.copytree(operated, "mine")  # answer works in a folder of its own
    assert words in answer(f"sarah-operate --resume mine {options}")


def test_only_a_finished_session_is_extended(answer: Callable[[str], str], operated: Path) -> None:
    shutil.copytree(operated, "mine")
    Path("mine/parameters.json").unlink()
    assert "it can be extended once it is finished" in answer("sarah-operate --resume mine --minutes 0.3")


def test_a_session_is_compared_with_the_same_robot_without_learning(tmp_path: Path) -> None:
    """It says before that it takes as long again."""
    process = run("sarah-operate", "--minutes", "0.1", *QUICK, "--compare-frozen", "--out", "mine", cwd=tmp_path)
    assert process.returncode == 0, process.stderr
    said, _, summary = process.stdout.partition("left with")
    assert "without learning, which takes as long again, into mine/frozen" in said
    assert re.search(r"frozen +0\.\d{3}: .*; falls: 0 in 5 windows", summary)
    assert "is finished" in run("sarah-operate", "--resume", "mine", cwd=tmp_path).stdout


def test_every_change_counts_and_a_session_keeps_its_pushes(tmp_path: Path) -> None:
    line = ("--minutes", "0.2", *QUICK, "--learner", "none", "--episode.push.newtons", "10")
    changes = ("--change", "0.03: payload=3", "--change", "0.06: physics.control_rate=50")
    first = run("sarah-operate", *line, *changes, "--out", "first", cwd=tmp_path)
    assert first.returncode == 0, first.stderr
    rows = [row.split(",") for row in (tmp_path / "first/windows.csv").read_text().splitlines()[1:]]
    assert sorted({row[3] for row in rows}) == ["0", "1", "2"]
    assert {row[2] for row in rows} == {"1.0", "2.0"}  # at any control rate
    again = run("sarah-operate", "first", "--minutes", "0.1", *QUICK, "--out", "again", cwd=tmp_path)
    assert again.returncode == 0, again.stderr
    assert "- 10.0" in (tmp_path / "again/session.yaml").read_text().split("newtons")[1][:20]


def test_a_session_that_cannot_go_on_does_not_recommend_to_go_on(operated: Path, tmp_path: Path) -> None:
    shutil.copytree(operated, tmp_path / "mine")
    (tmp_path / "mine/parameters.json").unlink()
    spec = tmp_path / "mine/session.yaml"
    spec.write_text(spec.read_text().replace("seed: 2", "seed: 3"))
    process = run("sarah-operate", "--resume", "mine", cwd=tmp_path)
    assert process.returncode == 2 and "seed is 3 here, and 2 in this session" in process.stderr
    assert "go on with" not in process.stderr and not process.stdout


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("sarah-operate --push-seconds 0.5 --episode.push.duration 5", "push.duration must be at most the 0.5 s"),
        ("sarah-operate --learner careles", "unknown learner 'careles', did you mean 'careful'?"),
        ("sarah-operate --minutes 0", "minutes must be between 0.1 and 600 min, not 0.0"),
        ("sarah-operate --change 5", 'change must be a minute and a setting, such as "5: '),
        ("sarah-operate --change '5: pay_load=3'", "unknown key 'pay_load', did you mean 'payload'?"),
        (
            "sarah-operate --change '5: actuator_bandwidth=12'",
            "unknown key 'actuator_bandwidth', did you mean 'randomisation.actuator_bandwidth'?",
        ),
        ("sarah-operate --resume nowhere", "session folder nowhere does not exist"),
        ("sarah-operate --change '50: payload=3'", "changes must be between 0 and 10 min, not [50.0]"),
        ("sarah-operate --episode.payload 500", "payload must be between 0 and 100 kg, not 500.0"),
        ("sarah-operate --episode.terrain.roughness 0.01", "terrain.roughness must be 0 in an operation"),
        ("sarah-operate --episode.time-limit 5", "--episode.time-limit has no effect in an operation"),
        ("sarah-operate --episode.time_limit 5", "--episode.time_limit has no effect in an operation"),
        ("sarah-operate --episode.push.at-seconds=2", "has no effect in an operation: leave it out"),
        ("sarah-operate --resume nowhere --seed 3", "leave '--seed' out"),
        ("sarah-operate --extended-from 20", "extended_from must be in rising order and below minutes, not (20.0,)"),
        ("sarah-operate --extended-from 0", "extended_from must be between 0.1 and 600 min, not 0.0"),
        ("sarah-operate --learner none --compare-frozen", "--compare-frozen is for a session that learns"),
        ("sarah-operate nowhere", "is neither a run folder, nor numbers"),
        ("sarah-operate 1,2,3", "parameters must be 5 numbers (P1 to P5)"),
        ("sarah-operate --seed -1", "seed must be between 0 and"),
    ],
)
def test_mistakes_get_one_line(answer: Callable[[str], str], line: str, words: str) -> None:
    assert words in answer(line)


def test_the_former_name_of_the_careful_learner_is_taken(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.argv", ["sarah-operate", "--learner", "gp", "--seed", "-1"])
    with pytest.raises(SystemExit):
        main()
    said, error = capsys.readouterr().err.splitlines()
    assert said == "sarah-operate: say --learner careful instead of --learner gp, which the next release refuses"
    assert "seed must be between 0 and" in error
