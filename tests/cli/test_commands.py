"""The commands that look at trainings or compare them, as a user runs them."""

import json
import re
from pathlib import Path
from typing import Any

import pytest
from laboratory import NEEDS_PYBULLET, need
from pytest import MonkeyPatch
from terminal import SHORT, Trained, done, run

from sarah.errors import ConfigurationError
from sarah.runs.agent_settings import AGENT_SETTINGS
from sarah.training.optimisers import OPTIMISERS


@NEEDS_PYBULLET
def test_transfer_compares_the_engines_on_the_same_seeds(trained: Trained, tmp_path: Path) -> None:
    need("mujoco")
    folder, _ = trained
    process = done("sarah-transfer", str(folder), "--episodes", "2", "--out", "out", cwd=tmp_path)
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"transfer.md", "transfer.png", "transfer.pdf"}
    table = (tmp_path / "out" / "transfer.md").read_text()
    assert process.stdout.startswith(table)
    cells = [cell.strip() for cell in table.splitlines()[2].split("|")]
    assert cells[1:4] == ["mine", "stepping", "pybullet"]
    for engine, column in (("pybullet", 4), ("mujoco", 8)):
        arguments = (str(folder), "--episodes", "2", "--engine", engine, "--json")
        alone = json.loads(run("sarah-eval", *arguments, cwd=tmp_path).stdout)
        assert cells[column] == f"{alone['score_mean']:.3f}"
        assert cells[column + 2] == f"{alone['steps_per_second_mean']:.2f}"


def test_a_race_ends_with_table_and_plot_of_own_algorithms_too(tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    for table in (AGENT_SETTINGS, OPTIMISERS):
        monkeypatch.setitem(table, "climber", None)  # which is taken out again
    page = (Path(__file__).parents[2] / "docs/how_to/algorithm.md").read_text()
    (script,) = (block for block in re.findall(r"```python\n(.*?)```", page, re.DOTALL) if "HillClimber" in block)
    exec(script, {"__name__": "my_race"})
    arguments = ("--algorithms", "naf", "climber", "--seeds", "1", "--episodes", "5", "--evaluations", "1")
    process = done("sarah-compare", "--out", "race", *arguments, *SHORT, cwd=tmp_path)
    text = (tmp_path / "race" / "race.md").read_text()
    assert "Task stepping" in text and "5 episodes in each training, of at most 1.5 s" in text
    assert "Nothing can be held" in text and "Nothing was learned by naf" in text
    assert ": the warm-up took all 5 episodes." in text
    assert text in process.stdout and "| naf | 1 |" in process.stdout and "| climber | 1 |" in process.stdout
    names = {path.name for path in (tmp_path / "race").iterdir()}
    assert names == {"naf-s0", "climber-s0", "race.md", "race.csv", "race.png", "race.pdf"}


def test_a_race_has_the_seeds_that_one_asks_for(tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    raced: list[Any] = []

    def race(entries: object, *_: object, **__: object) -> None:
        raced.append(entries)
        raise KeyboardInterrupt

    monkeypatch.setattr("sarah.reports.race.race", race)
    line = ("--out", "race", "--algorithms", "random", "cma-es", "--seeds", "2", "--first-seed", "3")
    process = run("sarah-compare", *line, "--best-known", "0.01", *SHORT, cwd=tmp_path)
    assert process.returncode == 130
    assert process.stderr.endswith("\nsarah-compare: interrupted; the same command goes on with the race\n")
    (entries,) = raced
    assert [entry.folder.name for entry in entries] == ["random-s3", "cma-es-s3", "random-s4", "cma-es-s4"]


def test_figures_are_in_the_run_folder_or_where_one_says(trained: Trained, monkeypatch: MonkeyPatch) -> None:
    folder, _ = trained
    drawn: list[tuple[int, Path]] = []

    def draw(runs: list[object], out: Path) -> list[Path]:
        drawn.append((len(runs), out))
        return [out / "b.png", out / "a.pdf"]

    monkeypatch.setattr("sarah.reports.all_figures.draw_all_figures", draw)
    both = run("sarah-figures", "mine", "mine", "--out", "out", cwd=folder.parent)
    assert both.stdout == "out/a.pdf\nout/b.png\n" and "sarah-report" not in both.stderr
    alone = run("sarah-figures", "mine", cwd=folder.parent)
    assert "/out/b.png" in both.stderr and alone.stderr.endswith("sarah-report mine\n")
    assert drawn == [(2, Path("out")), (1, Path("mine/figures"))]


WORKERS = {
    "sarah-train --out made --workers 3": (3, None),
    "sarah-train --out made --scheduler a:1": (0, "a:1"),
    "sarah-eval --workers 3": (3, None),
    "sarah-compare --out made --seeds 1 --scheduler a:1": (0, "a:1"),
    "sarah-transfer balance --out made --scheduler a:1": (0, "a:1"),
    "sarah-report mine --workers 3": (3,),
}


@pytest.mark.parametrize("line", WORKERS)
def test_workers_are_those_asked_for(line: str, trained: Trained, tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    if "transfer" in line:
        need("pybullet")
        need("mujoco")

    def workers(*arguments: object) -> None:
        raise ConfigurationError(f"{arguments}")

    (tmp_path / "mine").symlink_to(trained[0])
    monkeypatch.setattr("sarah.episode.workers.Workers", workers)
    command, *arguments = line.split()
    assert run(command, *arguments, cwd=tmp_path).stderr == f"{command}: error: {WORKERS[line]}\n"
