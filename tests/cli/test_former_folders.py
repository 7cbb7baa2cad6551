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


@pytest.mark.parametrize("kind", ["stepping", "balance", "session"])
@pytest.mark.parametrize(
    "command",
    ["sarah-eval {} --episodes 1", "sarah-describe {}", "sarah-operate {} --minutes 0.1 --learner none --out out"],
)
def test_every_kind_is_a_subject(command: str, kind: str, folder: Path) -> None:
    before = tree(folder)
    name, *arguments = command.format(folder / kind).split()
    process = run(name, *arguments, cwd=folder.parent)
    assert process.returncode == 0, process.stderr
    assert tree(folder) == before


def test_trainings_are_reported_and_learned_from(folder: Path) -> None:
    for command in (
        f"sarah-figures {folder / 'stepping'} {folder / 'balance'} --out out",
        f"sarah-report {folder / 'stepping'}",
        f"sarah-train --task balance --from {folder / 'stepping'} --episodes 1 --algo random --out more",
    ):
        name, *arguments = command.split()
        process = run(name, *arguments, cwd=folder.parent)
        assert process.returncode == 0, process.stderr


@pytest.mark.parametrize("kind", ["stepping", "balance", "session"])
def test_only_the_code_that_began_it_goes_on_with_it(kind: str, folder: Path) -> None:
    (folder / kind / "parameters.json").unlink()
    before = tree(folder)
    command = "sarah-operate" if kind == "session" else "sarah-train"
    process = run(command, "--resume", str(folder / kind), cwd=folder.parent)
    assert process.returncode == 2 and "sarah-sources is" in process.stderr
    assert tree(folder) == before
