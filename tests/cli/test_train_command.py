"""``sarah-train`` as a user runs it."""

import dataclasses
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from laboratory import RESULT
from terminal import SHORT, run

from sarah.episode.evaluation import Evaluation
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.training import train as training
from sarah.training.train import Learned


def test_train_shows_its_progress_and_ends_with_a_summary(
    trained: tuple[Path, subprocess.CompletedProcess[str]],
) -> None:
    folder, process = trained
    assert process.returncode == 0, process.stderr
    assert process.stdout.startswith("training naf on stepping: 4 episodes into mine\n\nlearned     P1 = ")
    for text in ("P5 = ", "warm-up     all 4 episodes", "score", "run folder  mine"):
        assert text in process.stdout
    assert "4/4" in process.stderr and "evaluating on 10 unseen seeds" in process.stderr
    assert (folder / "parameters.json").is_file()
    assert "sarah-train --task stepping" in (folder / "command.txt").read_text()


def test_the_summary_tells_of_falls_and_of_the_baseline(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    up, fallen = dataclasses.replace(RESULT, score=0.8), dataclasses.replace(RESULT, score=0.0, termination="fallen")

    def trained(_: object, run: RunFolder, *__: object) -> Learned:
        run.write_parameters({})
        return Learned((1.0, 0.0, 1.0, 0.0), Evaluation((up, up, up, fallen)), Evaluation((up, fallen) * 2), 2)

    monkeypatch.setattr(training, "train", trained)
    begins, _, summary = run("sarah-train", "--task", "balance", cwd=tmp_path).stdout.partition("\n\n")
    assert begins == ("training naf on balance, pushed by 100 to 125 N: 300 episodes into runs/balance/naf-s0")
    assert summary.splitlines()[2:7] == [
        "score       0.600, 0.400 for the baseline (V = 0) (mean of 4 unseen seeds; 1 is the ceiling)",
        "steps       3.00 per second",
        "survival    75%, 50% for the baseline (V = 0)",
        "by sensors  100% of shifts, 100% of lifts; sole clearance 20 mm",
        "diverged    2 episodes: their simulation gave no finite state",
    ]


def test_only_a_balance_training_continues_a_first_one(balanced: Path) -> None:
    for line, message in (
        ("--from mine", "not 'stepping': to train again with its settings, say --config mine/config"),
        ("--task balance --from second", "--from needs the run folder of a training of 'stepping'"),
    ):
        process = run("sarah-train", *line.split(), cwd=balanced.parent)
        assert process.returncode == 2 and message in process.stderr and len(process.stderr.splitlines()) == 1


def test_a_robot_of_another_size_is_told(
    begun: Callable[[str], TrainingConfig], capsys: pytest.CaptureFixture[str]
) -> None:
    begun("sarah-train --episode.dimensions torso_mass 12 thigh_mass 6")
    size = "length (1 times the default), mass (1.2) and hip offset (1)"
    said = f"motors and other settings go with {size}: sarah-describe runs/stepping/naf-s0 lists them\n"
    assert said in capsys.readouterr().out


def test_a_file_configures_it_and_options_go_before(begun: Callable[[str], TrainingConfig]) -> None:
    Path("mine.yaml").write_text("algo: td3\nepisodes: 2\nslots: 1\nepisode: {time_limit: 1.5}\n")
    config = begun("sarah-train --config mine.yaml --episodes 3 --engine mujoco")
    assert (config.algo, config.episodes, config.slots, config.episode.time_limit) == ("td3", 3, 1, 1.5)
    assert config.episode.engine == "mujoco"


def test_a_finished_training_goes_on_if_it_is_made_longer(tmp_path: Path) -> None:
    first = run("sarah-train", "--algo", "random", "--simulations=2", "--out", "mine", *SHORT, cwd=tmp_path)
    assert first.returncode == 0, first.stderr
    more = run("sarah-train", "--resume", "mine", "--simulations", "3", cwd=tmp_path)
    assert more.returncode == 0, more.stderr
    said = "extending 2 to 3 episodes: what changes in the course of a training, such as NAF's exploration, is from now"
    assert f"{said} on as in the last 1 of 3 episodes\nresuming the training of random on stepping: 3" in more.stdout
    assert len(list(RunFolder.open(tmp_path / "mine").episodes())) == 3
