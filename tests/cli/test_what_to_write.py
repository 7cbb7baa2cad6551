"""``--out`` is what a command writes, in every command, and its former names work for one release more."""

from pathlib import Path

import pytest
from laboratory import need
from terminal import run

from sarah.cli.tables import leave_table
from sarah.reports.transfer import ENGINES

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


@pytest.mark.parametrize("line", FORMER)
def test_a_former_name_works_and_one_line_says_the_present_one(line: str, tmp_path: Path) -> None:
    present, former = FORMER[line]
    command, *arguments = line.split()
    process = run(command, *arguments, cwd=tmp_path)
    notice, error = process.stderr.splitlines()
    assert notice == f"{command}: say {present} instead of {former}, which the next release refuses"
    assert " must be between " in error and process.stdout == ""


def test_a_former_name_is_understood(tmp_path: Path) -> None:
    (tmp_path / "full").mkdir()
    (tmp_path / "full/precious.txt").touch()
    said = run("sarah-train", "--run-dir", "full", cwd=tmp_path).stderr
    assert said.splitlines()[-1].endswith("run folder full is not empty: name another with --out")


@pytest.mark.parametrize("name", TABLES)
def test_that_a_table_is_replaced_is_said_before_the_work(name: str, tmp_path: Path) -> None:
    for engine in ENGINES:
        need(engine)
    line = [*TABLES[name].split(), "--out", str(tmp_path), "--workers", "1000"]  # so many never begin to work
    assert "replaced" not in run(*line, cwd=tmp_path).stderr
    (tmp_path / name).write_text("precious")
    assert f"{tmp_path / name} is there already, and will be replaced\n" in run(*line, cwd=tmp_path).stderr
    assert (tmp_path / name).read_text() == "precious"


def test_a_table_is_printed_and_written_and_its_file_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "table.md").write_text("longer than the new one")
    leave_table("| 1 |", tmp_path / "table.md")
    assert (tmp_path / "table.md").read_text() == "| 1 |\n"
    assert capsys.readouterr().out == f"| 1 |\n{tmp_path / 'table.md'}\n"
