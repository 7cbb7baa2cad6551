"""A task of a file: every command takes it when it is named, and nothing that opens a run folder runs it."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest
from laboratory import need
from terminal import Answer, Begin, done, run, tree

from sarah.episode.push import PushedConfig
from sarah.episode.tasks.task_file import task_of_text
from sarah.runs.run_folder import RunFolder
from sarah.simulation.engines import is_installed

FILE = """
import dataclasses
from pathlib import Path

import sarah

Path("it_ran").touch()


def reward(tick, config):
    return sarah.equation_2(tick, config) - 0.01 * tick.power


COARSE = sarah.Physics(rate=100, solver_iterations=5)
EPISODE = sarah.PushedConfig(time_limit=1.5, push=sarah.Push(30, at_seconds=1.1), physics=COARSE)
THRIFTY = dataclasses.replace(sarah.STEPPING, name="thrifty", reward=reward, episode=EPISODE)
"""
TASK = ("--task", "my_task.py:THRIFTY")


def assert_one_line(process: subprocess.CompletedProcess[str], words: str) -> None:
    assert process.returncode == 2 and words in process.stderr and process.stderr.count("\n") == 1


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the file, and with a training of its task in ``run``."""
    path = tmp_path_factory.mktemp("own")
    (path / "my_task.py").write_text(FILE)
    process = done("sarah-train", *TASK, "--algo", "random", "--episodes", "4", "--out", "run", cwd=path)
    assert "score       -" in process.stdout  # its power costs more than the paper's reward gives
    assert "sarah-eval run --task my_task.py:THRIFTY" in process.stderr
    (path / "it_ran").unlink()
    task_of_text.cache_clear()
    assert (path / "run" / "task.py").read_text() == FILE
    config = RunFolder.open(path / "run").config()
    assert config.task.reference == "my_task.py:THRIFTY" and config.episode.time_limit == 1.5
    assert config.task.parameter_names == ("P1", "P2", "P3", "P4", "P5") and not (path / "it_ran").exists()
    return path


OPENING = (
    *("sarah-figures run --out out", "sarah-eval run", "sarah-video run --out a.gif", "sarah-view run --out a.html"),
    *("sarah-report run --out a.html", "sarah-train --resume run", "sarah-train --config run/config.yaml"),
    "sarah-transfer run",
)


@pytest.mark.parametrize("command", OPENING)
def test_nothing_that_opens_a_run_runs_the_file(folder: Path, command: str, monkeypatch: pytest.MonkeyPatch) -> None:
    task_of_text.cache_clear()  # which remembers what it has run
    name, *arguments = command.split()
    if name == "sarah-transfer":
        need("pybullet")
        need("mujoco")
    monkeypatch.setattr("sarah.reports.all_figures.draw_all_figures", lambda *_: [Path("a.png")])
    process = run(name, *arguments, cwd=folder)
    assert not (folder / "it_ran").exists()
    if name == "sarah-figures":  # which needs only tables
        assert process.returncode == 0
    else:
        assert_one_line(process, "--task my_task.py:THRIFTY")


def test_every_command_takes_it_when_it_is_named(folder: Path, begun: Begin) -> None:
    process = run("sarah-eval", "run", *TASK, "--episodes", "2", "--json", cwd=folder)
    assert json.loads(process.stdout)["score_mean"] < 0.0
    kept = ("--task", "run/task.py:THRIFTY")  # the copy is the same file
    again = run("sarah-eval", "run", *kept, "--episodes", "2", "--json", cwd=folder)
    assert json.loads(again.stdout) | {"task": "my_task.py:THRIFTY"} == json.loads(process.stdout)
    numbers = run("sarah-eval", "0.4,0.5,0.6,1,1", *TASK, "--episodes", "1", "--json", cwd=folder)
    assert json.loads(numbers.stdout)["task"] == "my_task.py:THRIFTY"
    if is_installed("pybullet"):  # which draws
        assert run("sarah-video", "run", "--out", "a.gif", *TASK, "--seconds", "1", "1.1", cwd=folder).returncode == 0
    finished = done("sarah-train", "--resume", "run", *TASK, cwd=folder)
    assert "run is finished" in finished.stdout
    Path("my_task.py").write_text(FILE)
    assert begun(f"sarah-compare --out race {' '.join(TASK)}").episode.time_limit == 1.5


def test_the_next_steps_name_it_too(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shown = folder / "shown.png"
    monkeypatch.setattr("sarah.reports.all_figures.draw_all_figures", lambda *_: [shown])
    monkeypatch.setattr("sarah.reports.report.write_report", lambda *_: None)
    figures = run("sarah-figures", "run", cwd=folder)  # draws what was recorded, and does not run the file
    assert "sarah-report run --task my_task.py:THRIFTY\n" in figures.stderr
    report = run("sarah-report", "run", *TASK, cwd=folder)
    assert report.stdout == "run/report.html\n" and "sarah-view run --task my_task.py:THRIFTY\n" in report.stderr


def test_another_file_is_refused(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "my_task.py").write_text(FILE.replace("0.01", "0.02"))
    task, before = f"{tmp_path / 'my_task.py'}:THRIFTY", tree(folder)
    for command in ("sarah-train --resume", "sarah-eval"):
        name, *arguments = command.split()
        process = run(name, *arguments, str(folder / "run"), "--task", task, cwd=tmp_path)
        assert_one_line(process, "is of task THRIFTY (")
        assert "as it was, it is --task " in process.stderr and "task.py:" in process.stderr
    assert tree(folder) == before


def test_a_file_of_settings_keeps_what_it_says(tmp_path: Path, begun: Begin) -> None:
    (tmp_path / "my_task.py").write_text(FILE)
    (tmp_path / "mine.yaml").write_text("algo: random\nepisode: {push: {degrees: 90}}\n")
    episode = begun(f"sarah-train --config mine.yaml {' '.join(TASK)}").episode
    assert isinstance(episode, PushedConfig) and episode.time_limit == 1.5
    assert episode.push.newtons == (30.0, 30.0) and episode.push.degrees == (90.0, 90.0)


def test_a_mistake_in_the_reward_names_file_and_line(folder: Path) -> None:
    (folder / "wrong.py").write_text(FILE.replace("tick.power", "tick.pover"))
    early = run("sarah-train", "--task", "wrong.py:THRIFTY", "--out", "wrong", cwd=folder)
    assert_one_line(early, "wrong.py, line 11: AttributeError: 'Tick' object has no attribute 'pover'")
    assert not (folder / "wrong").exists()
    late_mistake = FILE.replace("0.01 * tick.power", "(1 / 0 if tick.time > 1.9 else 0.0)")
    (folder / "late.py").write_text(late_mistake.replace("1.5", "2.0"))
    late = run("sarah-train", "--task", "late.py:THRIFTY", "--algo", "random", "--out", "late", cwd=folder)
    assert late.returncode == 2 and "late.py, line 11: ZeroDivisionError" in late.stderr
    assert "correct the file, and train into another folder than late" in late.stderr


def test_a_damaged_description_is_one_line(folder: Path, answer: Answer, tmp_path: Path) -> None:
    shutil.copytree(folder / "run", tmp_path / "run")
    description = (folder / "run" / "task.json").read_text()
    changes = ({"file": "../\x1b[31mevil.py"}, {"attribute": ["a"]}, {"title": 5}, {"must_step": "no"})
    changed = [json.dumps(json.loads(description) | change) for change in changes]
    for text in ("{", "[]", '{"file": 1}', description.replace("PushedConfig", "Path"), *changed):
        (tmp_path / "run" / "task.json").write_text(text)
        line = answer("sarah-eval run")
        assert "the task of run cannot be read" in line and line.strip().isprintable()
