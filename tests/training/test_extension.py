"""A finished training goes on: the same as if it had been meant to from the beginning, and recorded."""

import shutil
from importlib import import_module
from pathlib import Path

import pytest
import yaml
from interrupted import EPISODE
from terminal import tree

from sarah.errors import ConfigurationError, ResumeError
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


def unfinished(folder: Path, path: Path) -> RunFolder:
    copy = RunFolder(shutil.copytree(folder / "run", path))
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


@pytest.mark.parametrize(("before", "after"), [("episodes: 22", "episodes: 23"), ("- 12", "- 11")])
def test_it_cannot_be_extended_to_two_budgets(before: str, after: str, folder: Path, tmp_path: Path) -> None:
    copy = unfinished(folder, tmp_path / "copy")
    copy.specification_path.write_text(copy.specification_path.read_text().replace(before, after))
    with pytest.raises(ResumeError, match="cannot be resumed"):
        train(copy.config(), copy)


@pytest.mark.parametrize("new_rows", [0, 4])
def test_a_cut_extension_goes_on_to_the_same_end(new_rows: int, folder: Path, tmp_path: Path) -> None:
    copy = unfinished(folder, tmp_path / "copy")
    rows = copy.journal_path.read_bytes().splitlines(keepends=True)
    extension = next(index for index, row in enumerate(rows) if b'"extended_to"' in row)
    copy.journal_path.write_bytes(b"".join(rows[: extension + new_rows]))
    train(copy.config(), copy)
    for name in ("journal.jsonl", "episodes.csv", "parameters.json"):
        assert (copy.path / name).read_bytes() == (folder / "run" / name).read_bytes()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ("--episodes 30 --agent.tau 0.5", "agent.tau is 0.02 in this training, not 0.5"),
        ("--episodes 2", "episodes is 12 in this training, not 2"),
        ("--episodes 30 --scheduler nowhere://127.0.0.1:1", "nowhere"),  # there are no workers
    ],
)
def test_a_refused_extension_leaves_the_training_finished(
    options: str, words: str, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    before = tree(folder / "before")
    assert words in refused(f"--resume {folder / 'before'} {options}", monkeypatch, capsys)
    assert tree(folder / "before") == before


def test_only_a_finished_training_is_extended(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    copy = unfinished(folder, tmp_path / "copy")
    said = refused(f"--resume {copy.path} --episodes 30", monkeypatch, capsys)
    assert "it can be extended once it is finished" in said


def refused(options: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> str:
    """What the command says of options that it refuses."""
    monkeypatch.setattr("sys.argv", ["sarah-train", *options.split()])
    with pytest.raises(SystemExit, match="2"):
        import_module("sarah.cli.train").main()
    return capsys.readouterr().err


def test_stages_rise() -> None:
    config = TrainingConfig(episodes=200, extended_from=(60, 100))
    assert [(stage.end, stage.episodes) for stage in plan_of(config).stages] == [(60, 60), (100, 40), (200, 100)]
    assert config.extended_to(300).stages == (60, 100, 200, 300)
    for extended_from in ((200,), (100, 60), (0,)):
        with pytest.raises(ConfigurationError, match="extended_from must be in rising order and below episodes"):
            TrainingConfig(episodes=200, extended_from=extended_from)
