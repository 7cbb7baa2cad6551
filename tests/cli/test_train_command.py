"""``sarah-train`` as a user runs it, what it trains with by default, and what looks at trainings or compares them."""

import dataclasses
import json
import re
from pathlib import Path
from typing import Any

import pytest
from laboratory import NEEDS_PYBULLET, RESULT, need
from pytest import CaptureFixture, MonkeyPatch
from terminal import SHORT, Begin, Trained, done, run

from sarah.episode.evaluation import Evaluation
from sarah.episode.push import Push
from sarah.episode.settings import EpisodeConfig
from sarah.episode.tasks import BALANCE, STEPPING, BalanceConfig
from sarah.errors import ConfigurationError
from sarah.runs.agent_settings import AGENT_SETTINGS, NAFSettings
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.physics import Physics
from sarah.training import train as training
from sarah.training.optimisers import OPTIMISERS
from sarah.training.train import Learned


def test_train_shows_its_progress_and_ends_with_a_summary(trained: Trained) -> None:
    folder, process = trained
    assert process.returncode == 0, process.stderr
    assert process.stdout.startswith("training naf on stepping: 4 episodes into mine\n\nrecommended P1 = ")
    for text in ("P5 = ", "warm-up     all 4 episodes", "score", "run folder  mine"):
        assert text in process.stdout
    assert "4/4" in process.stderr and "evaluating on 10 unseen seeds" in process.stderr
    assert (folder / "parameters.json").is_file()
    assert "sarah-train --task stepping" in (folder / "command.txt").read_text()


def test_the_summary_tells_of_falls_and_of_the_baseline(tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
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
    again = "not 'stepping': to train again with its settings, say --config mine/config"
    other = "--from needs the run folder of a training of 'stepping'"
    for line, message in (("--from mine", again), ("--task balance --from second", other)):
        process = run("sarah-train", *line.split(), cwd=balanced.parent)
        assert process.returncode == 2 and message in process.stderr and len(process.stderr.splitlines()) == 1


def test_a_robot_of_another_size_is_told(begun: Begin, capsys: CaptureFixture[str]) -> None:
    begun("sarah-train --episode.dimensions torso_mass 12 thigh_mass 6")
    size = "length (1 times the default), mass (1.2) and hip offset (1)"
    said = f"motors and other settings go with {size}: sarah-describe runs/stepping/naf-s0 lists them\n"
    assert said in capsys.readouterr().out


def test_a_file_configures_it_and_options_go_before(begun: Begin) -> None:
    Path("mine.yaml").write_text("algo: td3\nepisodes: 2\nslots: 1\nepisode: {time_limit: 1.5}\n")
    config = begun("sarah-train --config mine.yaml --episodes 3 --engine mujoco")
    assert (config.algo, config.episodes, config.slots, config.episode.time_limit) == ("td3", 3, 1, 1.5)
    assert config.episode.engine == "mujoco"


def test_a_finished_training_goes_on_if_it_is_made_longer(tmp_path: Path) -> None:
    done("sarah-train", "--algo", "random", "--simulations=2", "--out", "mine", *SHORT, cwd=tmp_path)
    more = done("sarah-train", "--resume", "mine", "--simulations", "3", cwd=tmp_path)
    said = "extending 2 to 3 episodes: what changes in the course of a training, such as NAF's exploration, goes"
    assert f"{said} on as in the last 1 of 3 episodes\nresuming the training of random on stepping: 3" in more.stdout
    assert len(list(RunFolder.open(tmp_path / "mine").episodes())) == 3


TRAIN, COMPARE = "sarah-train --task balance", "sarah-compare --task balance"
PUSHED = BalanceConfig(push=Push(newtons=(100.0, 125.0), sagittal_share=0.5), time_limit=10.0)
PAPER = "--episode.push.newtons 0 100 --episode.push.sagittal-share 0 --episode.time-limit 30"
LEGS = (0.4, 1.3, 0.1, 1.0, 1.0)
FILE = "import dataclasses, sarah\nMINE = dataclasses.replace(sarah.BALANCE, name='mine')\n"


@pytest.mark.parametrize("command", [TRAIN, COMPARE])
def test_balance_is_learned_from_pushes_that_tell_sets_apart(command: str, begun: Begin) -> None:
    config = begun(f"{command} --out usual")
    assert (config.task, config.episodes, config.episode) == (BALANCE, 300, PUSHED)
    assert config.agent == NAFSettings(preset="noisy")
    own = begun(f"{command} --out own --episodes 7 {PAPER}")
    assert own.episodes == 7 and own.episode == BALANCE.episode
    directed = Push(newtons=(100.0, 125.0), degrees=(0.0, 90.0))
    config = begun(f"{command} --out directed --episode.push.degrees 0 90")
    assert config.episode == BalanceConfig(push=directed, time_limit=10.0)


@pytest.mark.parametrize("command", ["sarah-train", "sarah-compare --out race"])
@pytest.mark.parametrize(("task", "own"), [("stepping", STEPPING.episode), ("my_task.py:MINE", BALANCE.episode)])
def test_other_tasks_keep_their_own(command: str, task: str, own: EpisodeConfig, tmp_path: Path, begun: Begin) -> None:
    (tmp_path / "my_task.py").write_text(FILE)
    config = begun(f"{command} --task {task}")
    assert (config.episodes, config.episode) == (100, own)


def test_a_file_and_a_run_folder_keep_their_own(tmp_path: Path, begun: Begin) -> None:
    (tmp_path / "mine.yaml").write_text("task: balance\nepisode: {push: {degrees: 90, sagittal_share: 0.2}}\n")
    own = BalanceConfig(push=Push(degrees=(0.0, 0.0), sagittal_share=0.2))
    paper = TrainingConfig("balance", episodes=20)
    RunFolder.create(tmp_path / "run", paper)
    for task in ("", " --task balance"):
        config = begun(f"sarah-train --config mine.yaml{task} --episode.push.degrees 0")
        assert config == TrainingConfig("balance", episode=own)
        assert begun(f"sarah-train --resume run{task}") == paper


@pytest.fixture
def first(tmp_path: Path) -> EpisodeConfig:
    """Settings of a First Training on a robot of its own, whose folder is ``first``."""
    robot = {"thigh_length": 0.36}
    own = EpisodeConfig(physics=Physics(400, 20, 200), payload=3.0, dimensions=robot, reward_form="printed")
    run = RunFolder.create(tmp_path / "first", TrainingConfig(episode=own))
    run.write_parameters({"parameters": dict(zip(STEPPING.parameter_names, LEGS, strict=True))})
    return own


def test_what_was_learned_first_gives_legs_and_robot(
    first: EpisodeConfig, begun: Begin, capsys: CaptureFixture[str]
) -> None:
    config = begun(f"{TRAIN} --from first --episode.push.newtons 110 --episode.payload 1")
    push = first.scale.scaled(Push(newtons=(110.0, 110.0), sagittal_share=0.5))  # its mass is the usual one
    assert config.episodes == 300
    assert config.episode == BALANCE.config_of(first, stepping=LEGS, push=push, time_limit=10.0, payload=1.0)
    text = capsys.readouterr().out
    said = [line.strip() for line in text.partition("all settings of its episodes, but\n")[2].splitlines()]
    assert {"payload 1 instead of 3", "time_limit 10 instead of 30"} < set(said) and len(said) == 3
    assert said[-1].startswith("push newtons 110, ") and said[-1].endswith(" instead of none")


def test_a_file_goes_before_the_first_and_an_option_before_both(
    first: EpisodeConfig, tmp_path: Path, begun: Begin, capsys: CaptureFixture[str]
) -> None:
    (tmp_path / "mine.yaml").write_text("episode: {payload: 2, physics: {solver_iterations: 30}, push: {degrees: 90}}")
    others = "--episode.physics.control-rate 100 --episode.stepping 1 1 1 1 1"
    config = begun(f"{TRAIN} --from first --config mine.yaml {others}")
    assert "\n  stepping 1, 1, 1, 1, 1 instead of 0.4, 1.3, 0.1, 1, 1\n" in capsys.readouterr().out
    assert config.episode.payload == 2.0 and config.episode.reward_form == "printed"
    assert config.episode.physics == dataclasses.replace(first.physics, solver_iterations=30, control_rate=100)
    push = Push((100.0, 125.0), degrees=(90.0, 90.0), sagittal_share=0.5)
    assert BALANCE.config_of(config.episode).push == first.scale.scaled(push)


def test_another_robot_has_its_push_and_settings_of_the_first(first: EpisodeConfig, begun: Begin) -> None:
    config = begun(f"{TRAIN} --from first --episode.dimensions shank_length 0.5")
    robot = EpisodeConfig(dimensions={"thigh_length": 0.36, "shank_length": 0.5})
    own, push = dataclasses.replace(first, dimensions=robot.dimensions), robot.scale.scaled(PUSHED.push)
    assert config.episode == BALANCE.config_of(own, stepping=LEGS, push=push, time_limit=10.0)


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
