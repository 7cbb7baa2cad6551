"""``sarah-train`` as a user runs it."""

import dataclasses
import json
import subprocess
from pathlib import Path

import pytest
from laboratory import NEEDS_PYBULLET, RESULT, need
from terminal import SHORT, run

from sarah.cli.train import main
from sarah.episode.evaluation import Evaluation
from sarah.episode.tasks import STEPPING
from sarah.runs.run_folder import RunFolder
from sarah.training import train as training
from sarah.training.train import Learned


def test_train_ends_with_a_summary(trained: tuple[Path, subprocess.CompletedProcess[str]]) -> None:
    folder, process = trained
    assert process.returncode == 0, process.stderr
    for text in ("learned", *STEPPING.parameter_names, "warm-up     all 4 episodes", "score", "run folder  mine"):
        assert text in process.stdout
    assert "Traceback" not in process.stderr and "pybullet" not in process.stderr
    assert (folder / "parameters.json").is_file()
    assert "sarah-train --task stepping" in (folder / "command.txt").read_text()


def test_train_shows_its_progress(trained: tuple[Path, subprocess.CompletedProcess[str]]) -> None:
    _, process = trained
    assert "4/4" in process.stderr and "evaluating on 10 unseen seeds" in process.stderr


def test_workers_train_and_evaluate_the_same(
    trained: tuple[Path, subprocess.CompletedProcess[str]], tmp_path: Path
) -> None:
    alone, _ = trained
    arguments = ("--episodes", "4", "--seed", "1", "--workers", "2", "--out", "mine")
    process = run("sarah-train", *arguments, *SHORT, cwd=tmp_path)
    assert process.returncode == 0, process.stderr
    assert "Warning" not in process.stderr
    assert (tmp_path / "mine" / "episodes.csv").read_bytes() == (alone / "episodes.csv").read_bytes()
    tables = [
        run("sarah-eval", str(alone), "--episodes", "3", *workers, cwd=tmp_path).stdout
        for workers in ((), ("--workers", "2"))
    ]
    assert "score" in tables[0] and tables[0] == tables[1]


def test_second_training_keeps_what_the_first_learned(balanced: Path) -> None:
    first = json.loads((balanced.parent / "mine" / "parameters.json").read_text())
    second = json.loads((balanced / "parameters.json").read_text())
    assert second["stepping"] == list(first["parameters"].values())
    assert list(second["parameters"]) == ["V1", "V2", "V3", "V4"]


def test_the_summary_tells_of_falls_and_of_the_baseline(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A median would hide the fall of one in four."""
    up, fallen = dataclasses.replace(RESULT, score=0.8), dataclasses.replace(RESULT, score=0.0, termination="fallen")

    def trained(_: object, run: RunFolder, *__: object) -> Learned:
        run.write_parameters({})
        return Learned((1.0, 0.0, 1.0, 0.0), Evaluation((up, up, up, fallen)), Evaluation((up, fallen) * 2), 0)

    monkeypatch.setattr(training, "train", trained)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sys.argv", ["sarah-train", "--task", "balance"])
    main()
    shown = capsys.readouterr().out
    assert "score       0.600, 0.400 for the baseline (V = 0) (mean of 4 unseen seeds; 1 is the ceiling)\n" in shown
    assert "survival    75%, 50% for the baseline (V = 0)\n" in shown


def test_only_a_balance_training_continues_a_first_one(balanced: Path) -> None:
    for arguments, message in (
        (
            ("--from", "mine"),
            "--from is for --task balance, not 'stepping': to train again with its settings, say --config mine/config",
        ),
        (("--task", "balance", "--from", "second"), "--from needs the run folder of a training of 'stepping'"),
    ):
        process = run("sarah-train", *arguments, cwd=balanced.parent)
        assert process.returncode == 2 and message in process.stderr and len(process.stderr.splitlines()) == 1


@NEEDS_PYBULLET
def test_mujoco_trains_and_its_run_is_evaluated_in_it(tmp_path: Path) -> None:
    need("mujoco")
    arguments = ("--algo", "random", "--episodes", "2", "--engine", "mujoco", "--out", "mine")
    process = run("sarah-train", *arguments, *SHORT, "--workers", "2", cwd=tmp_path)
    assert process.returncode == 0, process.stderr
    assert "engine: mujoco" in (tmp_path / "mine" / "config.yaml").read_text()
    assert "mujoco" in (tmp_path / "mine" / "versions.txt").read_text()
    summaries = [
        run("sarah-eval", "mine", "--episodes", "2", *engine, cwd=tmp_path).stdout
        for engine in ((), ("--engine", "mujoco"), ("--engine", "pybullet"))
    ]
    assert summaries[0] == summaries[1] != summaries[2]


def test_training_is_configured_by_a_file_and_overridden_by_options(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text("algo: td3\nepisodes: 2\nslots: 1\nepisode: {time_limit: 1.5}\n")
    process = run("sarah-train", "--config", "mine.yaml", "--episodes", "3", "--out", "out", cwd=tmp_path)
    assert process.returncode == 0, process.stderr
    config = (tmp_path / "out" / "config.yaml").read_text()
    assert "algo: td3" in config and "episodes: 3" in config and "time_limit: 1.5" in config
