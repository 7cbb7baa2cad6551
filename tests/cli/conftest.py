"""Trainings that several tests of commands look at, and commands that are refused."""

import shlex
import subprocess
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

import pytest
from terminal import SHORT, run, tree


@pytest.fixture(scope="session")
def trained(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, subprocess.CompletedProcess[str]]:
    """The run folder of a First Training, and its process."""
    folder = tmp_path_factory.mktemp("work")
    arguments = ("--task", "stepping", "--algo", "naf", "--episodes", "4", "--seed", "1", "--out", "mine")
    return folder / "mine", run("sarah-train", *arguments, *SHORT, cwd=folder)


@pytest.fixture(scope="session")
def balanced(trained: tuple[Path, subprocess.CompletedProcess[str]]) -> Path:
    """The run folder of a Second Training on what the First one learned."""
    first, _ = trained
    arguments = ("--task", "balance", "--from", "mine", "--episodes", "4", "--out", "second", *SHORT)
    process = run("sarah-train", *arguments, cwd=first.parent)
    assert process.returncode == 0, process.stderr
    assert "V4 = " in process.stdout and "baseline (V = 0)" in process.stdout
    return first.parent / "second"


@pytest.fixture
def answer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Callable[[str], str]:
    """Runs a command line in this process, in a folder of its own, and returns its one line."""
    monkeypatch.chdir(tmp_path)

    def ask(line: str) -> str:
        command, *arguments = shlex.split(line)
        before = tree(tmp_path)
        monkeypatch.setattr("sys.argv", [command, *arguments])
        with pytest.raises(SystemExit) as ended:
            import_module(f"sarah.cli.{command.removeprefix('sarah-')}").main()
        captured = capsys.readouterr()
        assert ended.value.code == 2 and captured.out == ""
        (message,) = captured.err.splitlines()
        assert message.startswith(f"{command}: error: ") and len(message) < 1000
        assert tree(tmp_path) == before
        return message

    return ask
