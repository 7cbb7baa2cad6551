"""``--out`` is what a command writes, in every command, and its former names work for one release more."""

from importlib import import_module
from pathlib import Path

import pytest

COMMANDS = ("train", "operate", "eval", "view", "video", "transfer", "report", "compare", "figures")
FORMER = {
    "sarah-train --run-dir=mine --seed -1": ("--out mine", "--run-dir mine"),
    "sarah-operate --run_dir mine --seed -1": ("--out mine", "--run_dir mine"),
    "sarah-view --export mine.html --port 0": ("--out mine.html", "--export mine.html"),
    "sarah-video balance mine.gif --speed 0": ("--out mine.gif", "mine.gif"),
    "sarah-compare mine --seeds 0": ("--out mine", "mine"),
    "sarah-eval --robustness mine --forces 0": ("--robustness --out mine", "--robustness mine"),
    "sarah-eval --terrain mine --episodes 0": ("--terrain --out mine", "--terrain mine"),
}
"""Lines in the former way, each with a mistake that ends it, and what is said instead of what."""


def ended(line: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> tuple[str, str]:
    """Both streams of a command that ends early, run in this process."""
    monkeypatch.setattr("sys.argv", line.split())
    with pytest.raises(SystemExit):
        import_module(f"sarah.cli.{line.split()[0].removeprefix('sarah-')}").main()
    return capsys.readouterr()


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_writes_to_out(
    command: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    shown, _ = ended(f"sarah-{command} --help", monkeypatch, capsys)
    assert "--out DIR" in shown or "--out FILE" in shown
    assert "--run-dir" not in shown and "--export" not in shown


@pytest.mark.parametrize("line", FORMER)
def test_a_former_name_works_and_one_line_says_the_present_one(
    line: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    present, former = FORMER[line]
    shown, said = ended(line, monkeypatch, capsys)
    notice, error = said.splitlines()
    command = line.split()[0]
    assert notice == f"{command}: say {present} instead of {former}, which the next release refuses"
    assert " must be between " in error and shown == ""


def test_a_former_name_is_understood(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("full").mkdir()
    Path("full/precious.txt").touch()
    _, said = ended("sarah-train --run-dir full", monkeypatch, capsys)
    assert said.splitlines()[-1].endswith("run folder full is not empty: name another with --out")
