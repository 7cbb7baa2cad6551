"""What the commands say of themselves, and of what one does next; former names work for one release more."""

import re
import shlex
import subprocess
import sys
from pathlib import Path
from urllib.parse import unquote, urlparse

import pytest
from laboratory import need
from pytest import CaptureFixture
from terminal import BIN, COARSE, SHORT, Trained, done, run

from sarah.cli import next_steps
from sarah.cli.next_steps import passed_on, say_next, to_see, to_watch
from sarah.cli.tables import leave_table
from sarah.episode.spec import FIRST_EVALUATION_SEED
from sarah.reports.transfer import ENGINES

COMMANDS = ("train", "operate", "eval", "view", "video", "transfer", "report", "compare", "figures", "describe")


def test_help_has_out_and_every_algorithm_and_loads_little() -> None:
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
    for shown in re.split("^command ", process.stdout, flags=re.MULTILINE)[1:]:
        assert ("--out DIR" in shown or "--out FILE" in shown) and not re.search("--run-dir|--export", shown)
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


ENDING = {"sarah-view": ("--out", "page.html"), "sarah-eval": ("--episodes", "1")}


def steps_of(said: str) -> dict[str, list[str]]:
    """Words of the commands of the last lines, by their purpose; the path of a program is left out."""
    lines = [line.removeprefix("to ").split(":  ", 1) for line in said.splitlines() if line.startswith("to ")]
    assert said.endswith("\n".join(said.splitlines()[-len(lines) :]) + "\n") and 1 <= len(lines) <= 3
    words = {purpose: shlex.split(command) for purpose, command in lines}
    return {purpose: [Path(program).name, *others] for purpose, (program, *others) in words.items()}


def paste(words: list[str], folder: Path) -> str:
    """What a suggested command prints; one that opens a file, the file."""
    if words[0] == "python":
        assert words[1:3] == ["-m", "webbrowser"]
        file = Path(unquote(urlparse(words[3]).path))
        assert file.stat().st_size > 1000
        return str(file)
    if words[0] == "tensorboard":
        assert words[1] == "--logdir" and list((folder / words[2]).glob("**/events.out.tfevents.*"))
        return ""
    process = done(*words, *ENDING.get(words[0], ()), cwd=folder)
    return process.stdout


def test_a_training_can_be_seen_tested_and_watched(trained: Trained) -> None:
    folder, process = trained
    steps = steps_of(process.stderr)
    assert list(steps) == ["see it", "test it", "watch its curves"] and "sarah-" not in process.stdout.splitlines()[-1]
    assert [words[-1] for words in steps.values()] == ["mine"] * 3
    assert "which no training has seen" in paste(steps["test it"], folder.parent)
    assert paste(steps["watch its curves"], folder.parent) == ""


def test_an_evaluated_episode_is_seen_under_the_same_conditions(tmp_path: Path) -> None:
    settings = ("--episode.time-limit", "1.5", "--episode.payload", "3", *COARSE)
    steps = steps_of(run("sarah-eval", "0.4,1.3,0.1,1,1", "--episodes", "1", *settings, cwd=tmp_path).stderr)
    assert steps == {"see it": ["sarah-view", "0.4,1.3,0.1,1,1", *settings, "--seed", str(FIRST_EVALUATION_SEED)]}
    assert paste(steps["see it"], tmp_path) == "page.html\n"


RACE = "sarah-compare --out race --algorithms random --seeds 1 --episodes 2 --evaluations 1"
PURPOSES = {
    "sarah-view {run} --out 'a page.html'": ["open it"],
    "sarah-eval {run} --episodes 1": ["see it", "have it on one page"],
    "sarah-operate {run} --learner none --minutes 0.1": ["see it", "test it", "watch its curves"],
    f"{RACE} {' '.join(SHORT)}": ["open it", "see its best", "watch its curves"],
}


@pytest.mark.parametrize("line", PURPOSES)
def test_other_commands_say_what_one_does_next(line: str, trained: Trained, tmp_path: Path) -> None:
    process = done(*shlex.split(line.format(run=trained[0])), cwd=tmp_path)
    steps = steps_of(process.stderr)
    assert list(steps) == PURPOSES[line]
    for purpose in steps.keys() - {"have it on one page"}:
        paste(steps[purpose], tmp_path)


def test_commands_are_quoted_and_aligned(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(BIN))
    say_next(to_see(Path("-my run"), "--task", "my task.py:MINE"), to_watch(Path("it's")))
    shown, said = capsys.readouterr()
    assert shown == ""
    assert said.splitlines() == [
        "to see it:            sarah-view './-my run' --task 'my task.py:MINE'",
        "to watch its curves:  tensorboard --logdir 'it'\"'\"'s'",
    ]
    monkeypatch.setenv("PATH", "/nowhere")
    monkeypatch.setattr("sys.argv", [str(BIN / "sarah-train")])
    say_next(to_see(Path("run")))
    assert capsys.readouterr().err == f"to see it:  {BIN / 'sarah-view'} run\n"


def test_a_video_takes_the_place_of_a_viewer_not_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(next_steps, "find_spec", lambda name: None)
    assert to_see("balance") == ("see it", ("sarah-video", "balance", "--out", "episode.gif"))


def test_options_that_another_command_has_not_are_left_out() -> None:
    line = "--json run --episodes 5 --engine mujoco --forces 1 2 --no-randomisation --first_seed=3 --episode.payload 5"
    words = passed_on(line.split(), "run", "json", "episodes", "forces", "first-seed")
    assert words == ["run", "--engine", "mujoco", "--no-randomisation", "--episode.payload", "5"]
