"""What the commands say of themselves; ``--out`` is what they write, and former names work for one release more."""

import subprocess
import sys
from pathlib import Path

import pytest
from laboratory import need
from pytest import CaptureFixture
from terminal import done, run

from sarah.cli.tables import leave_table
from sarah.reports.transfer import ENGINES

COMMANDS = ("train", "operate", "eval", "view", "video", "transfer", "report", "compare", "figures", "describe")


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_writes_to_out(command: str, tmp_path: Path) -> None:
    process = done(f"sarah-{command}", "--help", cwd=tmp_path)
    assert "--out DIR" in process.stdout or "--out FILE" in process.stdout
    assert "--run-dir" not in process.stdout and "--export" not in process.stdout


def test_help_lists_every_algorithm_of_the_table_and_loads_nothing_slow() -> None:
    program = (
        "import contextlib, sys\nfrom importlib import import_module\nfrom sarah.runs import agent_settings\n"
        "agent_settings.AGENT_SETTINGS['ninth'] = agent_settings.AgentSettings\n"
        f"for command in {COMMANDS}:\n    print('command', command)\n    sys.argv = ['command', '--help']\n"
        "    with contextlib.suppress(SystemExit):\n        import_module(f'sarah.cli.{command}').main()\n"
        "slow = {'torch', 'viser', 'matplotlib', 'pybullet', 'mujoco', 'stable_baselines3', 'yourdfpy', 'yaml'}\n"
        "sys.exit(' '.join(slow & set(sys.modules)) or 0)"
    )
    process = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert process.stderr == "" and process.returncode == 0
    text = " ".join(process.stdout.replace("│", " ").replace("``", "").split())
    for command, option in (("train", "--algo STR"), ("compare", "--algorithms [STR")):
        described = text.partition(f"command {command}")[2].partition(option)[2].partition("(default:")[0]
        assert [name for name in ("naf", "cma-es", "ninth") if name not in described] == []


FORMER = {
    "sarah-train --run-dir=mine --seed -1": ("--out mine", "--run-dir mine"),
    "sarah-operate --run_dir mine --seed -1": ("--out mine", "--run_dir mine"),
    "sarah-operate --learner gp --seed -1": ("--learner careful", "--learner gp"),
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


def test_a_table_is_printed_and_written_and_its_file_is_named(tmp_path: Path, capsys: CaptureFixture[str]) -> None:
    (tmp_path / "table.md").write_text("longer than the new one")
    leave_table("| 1 |", tmp_path / "table.md")
    assert (tmp_path / "table.md").read_text() == "| 1 |\n"
    assert capsys.readouterr().out == f"| 1 |\n{tmp_path / 'table.md'}\n"
