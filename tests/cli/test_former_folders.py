"""Folders that a former version of the package wrote: every command opens them, and none goes on with them."""

import shutil
from pathlib import Path

import pytest
from laboratory import need
from terminal import run, tree

FORMER = Path(__file__).parents[1] / "former"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    need("mujoco")
    return Path(shutil.copytree(FORMER, tmp_path / "former"))


@pytest.mark.parametrize(
    "command",
    [
        "sarah-eval stepping --episodes 1",
        "sarah-eval session --episodes 1",
        "sarah-operate balance --minutes 0.1 --learner none --out ../out",
        "sarah-figures stepping balance --out ../out",
        "sarah-train --task balance --from stepping --episodes 1 --algo random --episode.time-limit 2 --out ../out",
    ],
)
def test_every_kind_is_a_subject(command: str, folder: Path) -> None:
    before = tree(folder)
    name, *arguments = command.split()
    process = run(name, *arguments, cwd=folder)
    assert process.returncode == 0, process.stderr
    assert tree(folder) == before
    if name == "sarah-figures":
        files = [folder / file for file in process.stdout.split()]
        assert len(files) >= 10 and all(file.stat().st_size > 5000 for file in files)


@pytest.mark.parametrize(("kind", "name"), [("stepping", "training"), ("session", "session")])
def test_no_race_is_run_in_the_folder_of_something_else(kind: str, name: str, folder: Path) -> None:
    before = tree(folder)
    process = run("sarah-compare", "--out", str(folder / kind), cwd=folder.parent)
    assert process.returncode == 2 and f"is the folder of a {name}: name another for the race\n" in process.stderr
    assert tree(folder) == before


def test_a_complete_race_is_read_and_no_other_one_goes_on(folder: Path) -> None:
    entries = ["--algorithms", "cma-es", "--seeds", "1", "--evaluations", "2", "--evaluations-along", "1"]
    settings = ["--engine", "mujoco", "--episode.time-limit", "2", "--episodes", "6", "--slots", "4"]
    line = ["--out", "race", *entries, *settings]
    shutil.copytree(folder / "stepping", folder / "race" / "cma-es-s0")
    before = tree(folder)
    refused = run("sarah-compare", *line, cwd=folder)
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1) and "sarah-sources is" in refused.stderr
    assert tree(folder) == before
    rows = "episodes,score,seconds,evaluations\n5,0.4,1.0,1\n6,0.6,1.0,2\n"
    (folder / "race" / "cma-es-s0" / "race.csv").write_text(rows)
    (folder / "race" / "cma-es-s0" / "race_scores.csv").write_text("seed,score\n0,0.5\n1,0.7\n")
    read = run("sarah-compare", *line, cwd=folder)
    assert read.returncode == 0 and "| cma-es | 1 | 0.600" in read.stdout, read.stderr
