"""Trainings that several tests of commands look at, commands that are refused, and trainings that only begin."""

import shlex
from importlib import import_module
from pathlib import Path

import pytest
from terminal import SHORT, Answer, Begin, Trained, done, run, tree

import sarah.reports.report  # noqa: F401  # imported while a test draws nothing, it would never draw again
from sarah.runs.config import TrainingConfig


@pytest.fixture(scope="session")
def trained(tmp_path_factory: pytest.TempPathFactory) -> Trained:
    folder = tmp_path_factory.mktemp("work")
    arguments = ("--task", "stepping", "--algo", "naf", "--episodes", "4", "--seed", "1", "--out", "mine")
    return folder / "mine", run("sarah-train", *arguments, *SHORT, cwd=folder)


@pytest.fixture(scope="session")
def balanced(trained: Trained) -> Path:
    first, _ = trained
    arguments = ("--task", "balance", "--from", "mine", "--episodes", "4", "--out", "second", *SHORT)
    process = done("sarah-train", *arguments, cwd=first.parent)
    assert "V4 = " in process.stdout and "baseline (V = 0)" in process.stdout
    return first.parent / "second"


@pytest.fixture
def answer(tmp_path: Path) -> Answer:
    """Runs a command line in ``tmp_path``, and returns its one line."""

    def ask(line: str) -> str:
        command, *arguments = shlex.split(line)
        before = tree(tmp_path)
        process = run(command, *arguments, cwd=tmp_path)
        assert process.returncode == 2 and process.stdout == ""
        (message,) = process.stderr.splitlines()
        assert message.startswith(f"{command}: error: ") and len(message) < 1000
        assert tree(tmp_path) == before
        return message

    return ask


@pytest.fixture
def begun(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Begin:
    """Settings of the training that a command line begins, which is interrupted before its first episode."""
    monkeypatch.chdir(tmp_path)

    def begin(line: str) -> TrainingConfig:
        settings: list[TrainingConfig] = []

        def train(config: TrainingConfig, *_: object, **__: object) -> None:
            settings.append(config)
            raise KeyboardInterrupt

        monkeypatch.setattr("sarah.reports.race.train", train)
        monkeypatch.setattr("sarah.training.train.train", train)
        command, *arguments = line.split()
        monkeypatch.setattr("sys.argv", [command, *arguments])
        with pytest.raises(SystemExit, match="130"):
            import_module(f"sarah.cli.{command.removeprefix('sarah-')}").main()
        return settings[0]

    return begin
