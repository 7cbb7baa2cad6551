"""``--out`` is what a command writes, in every command, and its former names work for one release more."""

from importlib import import_module
from pathlib import Path

import pytest
from laboratory import need

from sarah.cli.tables import leave_table
from sarah.reports.transfer import ENGINES

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

TABLES = {
    "robustness.md": "sarah-eval balance --robustness",
    "terrain.md": "sarah-eval --terrain",
    "transfer.md": "sarah-transfer balance",
    "race.md": "sarah-compare --algorithms random --seeds 1",
}
"""Commands that leave a table, by the name of its file."""


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


@pytest.mark.parametrize("name", TABLES)
def test_that_a_table_is_replaced_is_said_before_the_work(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for engine in ENGINES:
        need(engine)
    line = f"{TABLES[name]} --out {tmp_path} --workers 1000"  # so many never begin to work
    assert "replaced" not in ended(line, monkeypatch, capsys)[1]
    (tmp_path / name).write_text("precious")
    assert f"{tmp_path / name} is there already, and will be replaced\n" in ended(line, monkeypatch, capsys)[1]
    assert (tmp_path / name).read_text() == "precious"


def test_a_table_is_printed_and_written_and_its_file_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "table.md").write_text("longer than the new one")
    leave_table("| 1 |", tmp_path / "table.md")
    assert (tmp_path / "table.md").read_text() == "| 1 |\n"
    assert capsys.readouterr().out == f"| 1 |\n{tmp_path / 'table.md'}\n"
