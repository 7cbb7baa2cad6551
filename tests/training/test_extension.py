"""A finished training goes on: the same as if it had been meant to from the beginning, and recorded."""

import shutil
from pathlib import Path
from typing import Any

import pytest
import yaml
from interrupted import EPISODE
from terminal import run, tree

from sarah.errors import ConfigurationError, ResumeError
from sarah.operation.settings import OperationConfig
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.training.plan import plan_of
from sarah.training.train import train


def trained(path: Path, config: TrainingConfig) -> RunFolder:
    run = RunFolder.create(path, config)
    train(config, run)
    return run


def extended(run: RunFolder, episodes: int) -> None:
    run.extend(run.config().extended_to(episodes))
    train(run.config(), run)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a training of 12 episodes, which was extended to 22, and as it was before."""
    path = tmp_path_factory.mktemp("extended")
    run = trained(path / "run", TrainingConfig(episodes=12, slots=2, episode=EPISODE))
    shutil.copytree(run.path, path / "before")
    extended(run, 22)
    return path


@pytest.fixture
def copy(folder: Path, tmp_path: Path) -> RunFolder:
    """The extended training, as if it had not been finished."""
    copy = RunFolder(shutil.copytree(folder / "run", tmp_path / "copy"))
    copy.result_path.unlink()
    return copy


@pytest.mark.parametrize("algo", ["naf", "cma-es"])
def test_it_is_the_training_that_was_meant_so(algo: str, tmp_path: Path) -> None:
    run = trained(tmp_path / "run", TrainingConfig(algo=algo, episodes=7, slots=2, episode=EPISODE))
    extended(run, 14)
    whole = trained(tmp_path / "whole", run.config())
    for name in ("config.yaml", "episodes.csv", "recommendations.csv", "progress.csv", "parameters.json"):
        assert (run.path / name).read_bytes() == (whole.path / name).read_bytes(), name


def test_it_records_where_it_was_extended(folder: Path) -> None:
    settings = yaml.safe_load((folder / "run" / "config.yaml").read_text())
    assert settings["episodes"] == 22 and settings["extended_from"] == [12]
    before, after = ((folder / name / "episodes.csv").read_text().splitlines() for name in ("before", "run"))
    assert after[:13] == before and len(after) == 23


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ("episodes: 22", "episodes: 23", "it was extended to 22 there, and would be extended to 23 here"),
        ("- 12", "- 11", "episodes is 11 here, and 12 in this training"),
    ],
)
def test_it_cannot_be_extended_to_two_budgets(before: str, after: str, words: str, copy: RunFolder) -> None:
    copy.specification_path.write_text(copy.specification_path.read_text().replace(before, after))
    with pytest.raises(ResumeError, match=words):
        train(copy.config(), copy)


@pytest.mark.parametrize("new_rows", [0, 4])
def test_a_cut_extension_goes_on_to_the_same_end(new_rows: int, folder: Path, copy: RunFolder) -> None:
    rows = copy.journal_path.read_bytes().splitlines(keepends=True)
    extension = next(index for index, row in enumerate(rows) if b'"extended_to"' in row)
    copy.journal_path.write_bytes(b"".join(rows[: extension + new_rows]))
    train(copy.config(), copy)
    for name in ("journal.jsonl", "episodes.csv", "parameters.json"):
        assert (copy.path / name).read_bytes() == (folder / "run" / name).read_bytes()


@pytest.mark.parametrize(
    ("name", "options", "words"),
    [
        ("before", "--episodes 30 --agent.tau 0.5", "agent.tau is 0.02 in this training, not 0.5"),
        ("before", "--episodes 2", "episodes is 12 in this training, not 2"),
        ("before", "--episodes 30 --scheduler nowhere://127.0.0.1:1", "nowhere"),  # there are no workers
        ("copy", "--episodes 30", "it can be extended once it is finished"),
    ],
)
def test_a_refused_extension_changes_nothing(
    name: str, options: str, words: str, folder: Path, copy: RunFolder
) -> None:
    path = copy.path if name == "copy" else folder / name
    before = tree(path)
    refused = run("sarah-train", "--resume", str(path), *options.split(), cwd=folder)
    assert refused.returncode == 2 and words in refused.stderr and tree(path) == before


def test_stages_rise() -> None:
    config = TrainingConfig(episodes=200, extended_from=(60, 100))
    assert [(stage.end, stage.episodes) for stage in plan_of(config).stages] == [(60, 60), (100, 40), (200, 100)]
    assert config.extended_to(300).stages == (60, 100, 200, 300)
    assert OperationConfig(minutes=20, extended_from=(5, 10)).extended_to(30).stages == (5.0, 10.0, 20.0, 30.0)
    kind: Any
    for kind, unit in ((TrainingConfig, "episodes"), (OperationConfig, "minutes")):
        for extended_from in ((200,), (100, 60), (60, 60)):
            with pytest.raises(ConfigurationError, match=f"extended_from must be in rising order and below {unit}"):
                kind(**{unit: 200, "extended_from": extended_from})
    with pytest.raises(ConfigurationError, match="extended_from must be in rising order and below episodes"):
        TrainingConfig(episodes=200, extended_from=(0,))
