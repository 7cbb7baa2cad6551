"""A finished training goes on: the same as if it had been meant to from the beginning, and recorded."""

import shutil
from pathlib import Path

import pytest
import yaml
from laboratory import NEEDS_PYBULLET
from terminal import COARSE, run, tree

from sarah.errors import ConfigurationError
from sarah.runs.config import TrainingConfig
from sarah.training.plan import plan_of

SHORT = ("--episode.time-limit", "1.5", *COARSE, "--seed", "1")


@pytest.fixture(scope="module", params=["naf", "cma-es"])
def extended(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, Path]:
    """Algorithm, and a folder with a training of 12 episodes that was extended to 22."""
    folder, algo = tmp_path_factory.mktemp("extended"), request.param
    first = run("sarah-train", "--algo", algo, "--episodes", "12", *SHORT, "--out", "run", cwd=folder)
    assert first.returncode == 0, first.stderr
    shutil.copytree(folder / "run", folder / "before")
    more = run("sarah-train", "--resume", "run", "--simulations", "22", "--workers", "2", cwd=folder)
    assert more.returncode == 0, more.stderr
    assert "extending 12 to 22 episodes" in more.stdout and "the last 10 of 22 episodes" in more.stdout
    return algo, folder


def test_it_is_the_training_that_was_meant_so(extended: tuple[str, Path]) -> None:
    algo, folder = extended
    budget = ("--episodes", "22", "--extended-from", "12", "--out", "whole")
    assert run("sarah-train", "--algo", algo, *budget, *SHORT, cwd=folder).returncode == 0
    for name in ("config.yaml", "episodes.csv", "recommendations.csv", "progress.csv", "parameters.json"):
        assert (folder / "run" / name).read_bytes() == (folder / "whole" / name).read_bytes(), name


def test_it_records_where_it_was_extended(extended: tuple[str, Path]) -> None:
    _, folder = extended
    settings = yaml.safe_load((folder / "run" / "config.yaml").read_text())
    assert settings["episodes"] == 22 and settings["extended_from"] == [12]
    before, after = ((folder / name / "episodes.csv").read_text().splitlines() for name in ("before", "run"))
    assert after[:13] == before and len(after) == 23


def test_it_cannot_be_extended_to_two_budgets(extended: tuple[str, Path]) -> None:
    _, folder = extended
    for before, after in (("episodes: 22", "episodes: 23"), ("- 12", "- 11")):
        copy = folder / after.replace(" ", "")
        shutil.copytree(folder / "run", copy)
        (copy / "parameters.json").unlink()
        text = (copy / "config.yaml").read_text()
        (copy / "config.yaml").write_text(text.replace(before, after))
        process = run("sarah-train", "--resume", str(copy), cwd=folder)
        assert process.returncode == 2 and "cannot be resumed" in process.stderr


def test_a_cut_extension_goes_on_to_the_same_end(extended: tuple[str, Path]) -> None:
    """Cut where the journal has some of the new episodes, and at the extension itself."""
    _, folder = extended
    rows = (folder / "run" / "journal.jsonl").read_bytes().splitlines(keepends=True)
    extension = next(index for index, row in enumerate(rows) if b'"extended_to"' in row)
    for count in (extension, extension + 4):
        copy = folder / f"cut{count}"
        shutil.copytree(folder / "run", copy)
        (copy / "parameters.json").unlink()
        (copy / "journal.jsonl").write_bytes(b"".join(rows[:count]))
        process = run("sarah-train", "--resume", str(copy), cwd=folder)
        assert process.returncode == 0, process.stderr
        for name in ("journal.jsonl", "episodes.csv", "parameters.json"):
            assert (copy / name).read_bytes() == (folder / "run" / name).read_bytes()


@pytest.mark.parametrize("extended", ["naf"], indirect=True)
def test_an_extension_without_workers_leaves_the_training_finished(extended: tuple[str, Path]) -> None:
    _, folder = extended
    before = tree(folder / "run")
    nobody = ("--scheduler", "nowhere://127.0.0.1:1")  # which is refused at once
    process = run("sarah-train", "--resume", "run", "--episodes", "30", *nobody, cwd=folder)
    assert process.returncode == 2 and tree(folder / "run") == before


@NEEDS_PYBULLET
def test_only_a_finished_training_of_the_same_settings_is_extended(tmp_path: Path) -> None:
    assert run("sarah-train", "--episodes", "3", *SHORT, "--out", "run", cwd=tmp_path).returncode == 0
    before = tree(tmp_path)
    other = run("sarah-train", "--resume", "run", "--episodes", "9", "--agent.tau", "0.5", cwd=tmp_path)
    assert other.returncode == 2 and "agent.tau is 0.02 in this training, not 0.5" in other.stderr
    fewer = run("sarah-train", "--resume", "run", "--episodes", "2", cwd=tmp_path)
    assert fewer.returncode == 2 and "episodes is 3 in this training, not 2" in fewer.stderr
    assert tree(tmp_path) == before
    (tmp_path / "run" / "parameters.json").unlink()
    unfinished = run("sarah-train", "--resume", "run", "--episodes", "9", cwd=tmp_path)
    assert unfinished.returncode == 2 and "it can be extended once it is finished" in unfinished.stderr


def test_stages_rise() -> None:
    config = TrainingConfig(episodes=200, extended_from=(60, 100))
    assert [(stage.end, stage.episodes) for stage in plan_of(config).stages] == [(60, 60), (100, 40), (200, 100)]
    assert config.extended_to(300).stages == (60, 100, 200, 300)
    for extended_from in ((200,), (100, 60), (0,)):
        with pytest.raises(ConfigurationError, match="extended_from must be in rising order and below episodes"):
            TrainingConfig(episodes=200, extended_from=extended_from)
