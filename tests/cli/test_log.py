"""``sarah-log``, and the logs of other commands, as a user types them."""

import csv
import json
from pathlib import Path

import pytest
from hand_made import rocking
from laboratory import NEEDS_PYBULLET
from logged import NAMED, TARGETS, write
from terminal import COARSE, done, run

from sarah.episode.trace import Trace
from sarah.logs.reading import Log
from sarah.logs.robot_log import RobotLog
from sarah.logs.summary import summarise
from sarah.logs.topics import TICKS


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write(tmp_path / "a.mcap")
    return tmp_path


def test_a_summary_says_what_was_logged(folder: Path) -> None:
    lines = done("sarah-log", "a.mcap", "a.mcap", cwd=folder).stdout.splitlines()
    begin, *rest = lines[: len(lines) // 2]
    assert begin.startswith("log              a.mcap, a test, 20")
    assert rest == [
        "file             whole",
        "duration         0.99 s from 0.00 s",
        "ticks            100; 0 messages dropped",
        "late             1 tick by more than 2 ms, the worst 3.00 ms",
        "states           0.00 s stepping: stood for a second",
        "steps            4, 4.04 per second of stepping",
        "ended by sensors LAND 75.0 %",
        "parameters       2 sets asked for, 1 applied, the last at 0.00 s by careful; "
        "refused: 1 times P1 must be between 0 and 2, not 9.0",
        "windows          1, observed reward 0.800 on average; falls: 0",
    ]
    assert lines[-len(rest) :] == rest


def test_a_check_tells_a_whole_log_from_a_cut_one_or_gaps(folder: Path) -> None:
    content = (folder / "a.mcap").read_bytes()
    (folder / "cut.mcap").write_bytes(content[: len(content) // 2])
    (folder / "begun.mcap").write_bytes(content[:100])
    with pytest.MonkeyPatch.context() as patch:  # two ticks that cannot be encoded
        patch.setattr("logged.rocking", lambda number: 5 if number % 50 == 7 else rocking(number))
        write(folder / "gaps.mcap")
    assert done("sarah-log", "--check", "a.mcap", cwd=folder).stdout == "a.mcap: whole\n"
    process = run("sarah-log", "--check", "a.mcap", "cut.mcap", "begun.mcap", "gaps.mcap", cwd=folder)
    whole, cut, begun, gaps = process.stdout.splitlines()
    assert process.returncode == 1 and whole == "a.mcap: whole"
    assert cut.startswith("cut.mcap: cut at byte ") and cut.endswith(" s")
    assert begun.startswith("begun.mcap: cut at byte ") and begun.endswith("before its first chunk was complete")
    assert gaps == "gaps.mcap: has 2 gaps: 2 messages of /ticks missing, the first before 0.08 s"


def test_a_part_is_a_log_of_its_own(folder: Path) -> None:
    done("sarah-log", "a.mcap", "--cut", "0.2", "0.5", "--out", "part.mcap", cwd=folder)
    assert done("sarah-log", "--check", "part.mcap", cwd=folder).stdout == "part.mcap: whole\n"
    part, whole = (list(Log(folder / name).messages()) for name in ("part.mcap", "a.mcap"))
    assert part == [message for message in whole if 0.2 <= message.seconds <= 0.5]
    assert Log(folder / "a.mcap").about == {} and summarise(log := Log(folder / "part.mcap")).ticks == 31
    assert log.about["program"] == "a test" and log.about["cut_from"] == "a.mcap"


def test_a_topic_becomes_a_table_with_a_column_for_each_field(folder: Path) -> None:
    process = done("sarah-log", "a.mcap", "--csv", "tables", cwd=folder)
    names = ["ticks", "phase_changes", "windows", "parameters", "states"]
    assert process.stdout.splitlines() == [f"tables/{name}.csv" for name in names]
    with (folder / "tables/ticks.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    log = Log(folder / "a.mcap")
    ticks = [log.values(message) for message in log.messages() if message.topic == TICKS.name]
    assert rows == [{name: str(value) for name, value in values.items()} for values in ticks]
    with (folder / "tables/parameters.csv").open(newline="") as file:
        applied, refused = csv.DictReader(file)
    assert [float(applied[name]) for name in NAMED] == list(NAMED.values())
    assert (refused["P1"], refused["P2"], refused["accepted"]) == ("9.0", "", "False")


def test_what_a_file_says_cannot_steer_the_terminal(folder: Path) -> None:
    with RobotLog(folder / "b.mcap", {"program": "\x1b[2J"}) as log:
        log.state(0.0, "stepping", "", "\x1b]0;you\x07\n")
    assert done("sarah-log", "b.mcap", cwd=folder).stdout.replace("\n", "").isprintable()


def test_an_evaluation_logs_its_first_episode_and_says_the_same(tmp_path: Path) -> None:
    line = ("stepping", "--episodes", "2", "--first-seed", "7", "--episode.time-limit", "2", *COARSE, "--json")
    plain = done("sarah-eval", *line, cwd=tmp_path).stdout
    assert done("sarah-eval", *line, "--log", "a.mcap", cwd=tmp_path).stdout == plain
    summary = summarise(log := Log(tmp_path / "a.mcap"))
    assert (log.about["program"], log.about["seed"], log.about["task"]) == ("sarah-eval", "7", "stepping")
    assert summary.ticks == 200 and json.loads(log.about["controller"])["time_out_seconds"] == 0.5
    again = run("sarah-eval", *line, "--log", "a.mcap", cwd=tmp_path)
    assert again.stderr == "sarah-eval: error: a.mcap is there already: name another file for the log\n"
    assert "leave --log out" in run("sarah-eval", "--terrain", "--out", "x", "--log", "b.mcap", cwd=tmp_path).stderr


def test_an_operation_logs_its_session(tmp_path: Path) -> None:
    line = ("--minutes", "0.1", "--settle-seconds", "0.5", "--measure-seconds", "0.5", *COARSE)
    process = done("sarah-operate", *line, "--out", "mine", "--log", "a.mcap", cwd=tmp_path)
    summary = summarise(log := Log(tmp_path / "a.mcap"))
    assert f"in {len(summary.windows)} windows" in process.stdout and log.about["learner"] == "careful"
    again = run("sarah-operate", *line, "--out", "other", "--log", "a.mcap", cwd=tmp_path)
    assert "a.mcap is there already" in again.stderr and not (tmp_path / "other").exists()


@NEEDS_PYBULLET
def test_a_log_is_filmed_as_it_was(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    filmed: list[tuple[object, ...]] = []
    monkeypatch.setattr("sarah.pictures.video.frames", lambda *arguments: filmed.append(arguments))
    monkeypatch.setattr("sarah.pictures.video.write_video", lambda *_: None)
    done("sarah-video", "a.mcap", "--out", "a.gif", cwd=folder)
    ((trace, _, _, caption, _),) = filmed
    assert isinstance(trace, Trace) and len(trace) == 100 and list(trace.targets[0]) == list(TARGETS)
    assert caption == "log a.mcap: V1 0.71, V2 0.41, V3 0.70, V4 -0.39\nmotion estimated from its sensors"
    for command in ("sarah-video a.mcap --out a.gif --seed 3", "sarah-view a.mcap --episode.payload 3"):
        process = run(*command.split(), cwd=folder)
        assert "a log is played as it is: leave settings of episodes and --seed out" in process.stderr
