"""The commands that look at trainings or compare them, as a user runs them."""

import json
import subprocess
from pathlib import Path

from laboratory import NEEDS_PYBULLET, need
from terminal import SHORT, run

import sarah
from sarah.cli.episode_options import EpisodeOptions
from sarah.episode.spec import FIRST_EVALUATION_SEED, FIRST_TRAINING_SEED, EpisodeSpec
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.episode.tasks.balance import TRAINED_STEPPING
from sarah.simulation.engines import is_installed
from sarah.simulation.physics import PyBulletPhysics
from sarah.training.train import SUMMARY_EPISODES


def test_eval_summarises_a_run(trained: tuple[Path, subprocess.CompletedProcess[str]]) -> None:
    folder, _ = trained
    process = run("sarah-eval", str(folder), "--episodes", "2", cwd=folder)
    assert process.returncode == 0, process.stderr
    for text in ("parameters", "score", "steps per second", "drift", "survival", "SHIFT by sensors", "sole clearance"):
        assert text in process.stdout


def test_eval_prints_one_json_object(trained: tuple[Path, subprocess.CompletedProcess[str]]) -> None:
    folder, _ = trained
    process = run("sarah-eval", str(folder), "--episodes", "2", "--first-seed", "5", "--json", cwd=folder)
    content = json.loads(process.stdout)
    expected = {"task", "algorithm", "episodes", "score_mean", "score_median", "steps_per_second_mean", "drift_mean"}
    expected |= {"survival_rate", "shifts_by_sensors_mean", "lifts_by_sensors_mean", "sole_clearance_mean"}
    assert expected | {"parameters"} <= set(content)
    assert content["task"] == "stepping" and content["algorithm"] == "naf" and content["episodes"] == 2
    learned = json.loads((folder / "parameters.json").read_text())["parameters"]
    assert content["parameters"] == learned


def test_eval_of_a_second_training_compares_with_v_at_zero(balanced: Path) -> None:
    arguments = ("second", "--episodes", "2", "--episode.push.newtons", "60")
    content = json.loads(run("sarah-eval", *arguments, "--json", cwd=balanced.parent).stdout)
    assert content["task"] == "balance" and list(content["parameters"]) == ["V1", "V2", "V3", "V4"]
    assert content["chatters"] is False and content["baseline"]["episodes"] == 2
    text = run("sarah-eval", *arguments, cwd=balanced.parent).stdout
    for label in ("baseline (V = 0)", "vibration", "no chatter", "actuator power"):
        assert label in text


def test_options_reach_the_episodes() -> None:
    own = BalanceConfig(engine="pybullet", physics=PyBulletPhysics(rate=400, control_rate=200))
    options = EpisodeOptions(physics="reference", episode=own)
    config = options.applied_to(EpisodeSpec((0.0,) * 4, 0, BALANCE)).config
    assert config.physics == PyBulletPhysics(1000, 100, 200, 0.0)


def test_any_robot_can_be_pushed(tmp_path: Path) -> None:
    """A First Training has no push, but its parameters can meet one."""
    arguments = ("stepping", "--episodes", "2", "--json", "--episode.time-limit", "4")
    alone = json.loads(run("sarah-eval", *arguments, cwd=tmp_path).stdout)
    pushed = json.loads(run("sarah-eval", *arguments, "--episode.push.newtons", "400", cwd=tmp_path).stdout)
    assert alone["survival_rate"] == 1.0 and pushed["survival_rate"] == 0.0
    plain = sarah.simulate(sarah.EpisodeSpec(TRAINED_STEPPING, 1000, config=sarah.EpisodeConfig(time_limit=4.0)))
    assert (
        json.loads(run("sarah-eval", *arguments, "--episodes", "1", cwd=tmp_path).stdout)["score_mean"] == plain.score
    )


def test_evaluations_use_seeds_that_nothing_has_seen(tmp_path: Path) -> None:
    process = run("sarah-eval", "stepping", "--episodes", "3", "--episode.time-limit", "2", cwd=tmp_path)
    assert "seeds            1000 to 1002, which no training has seen" in process.stdout
    assert max(range(SUMMARY_EPISODES)) < FIRST_EVALUATION_SEED < FIRST_TRAINING_SEED


def test_eval_takes_parameters_without_a_run(tmp_path: Path) -> None:
    arguments = ("0.4,1.3,0.1,1,1", "--episodes", "2", "--json")
    first, second = (json.loads(run("sarah-eval", *arguments, cwd=tmp_path).stdout) for _ in range(2))
    assert first == second
    assert first["algorithm"] is None and list(first["parameters"].values()) == [0.4, 1.3, 0.1, 1.0, 1.0]
    assert first["survival_rate"] == 1.0 and first["score_median"] > 0.78
    exact = json.loads(run("sarah-eval", *arguments, "--no-randomisation", cwd=tmp_path).stdout)
    assert exact["score_mean"] != first["score_mean"] and exact["survival_rate"] == 1.0


@NEEDS_PYBULLET
def test_transfer_compares_the_engines_on_the_same_seeds(
    trained: tuple[Path, subprocess.CompletedProcess[str]], tmp_path: Path
) -> None:
    need("mujoco")
    folder, _ = trained
    process = run("sarah-transfer", str(folder), "--episodes", "2", "--out", "out", "--workers", "2", cwd=tmp_path)
    assert process.returncode == 0, process.stderr
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


def test_compare_ends_with_table_and_plot(tmp_path: Path) -> None:
    arguments = ("--algorithms", "naf", "random", "--seeds", "1", "--episodes", "5", "--evaluations", "1")
    process = run("sarah-compare", "--out", "race", *arguments, *SHORT, "--workers", "2", cwd=tmp_path)
    assert process.returncode == 0, process.stderr
    table = (tmp_path / "race" / "race.md").read_text()
    assert "Task stepping" in table and "5 episodes in each training, of at most 1.5 s" in table
    assert "Nothing can be held" in table and "Nothing was learned by naf: the warm-up took all 5 episodes" in table
    assert table in process.stdout and "| naf | 1 |" in process.stdout and "| random | 1 |" in process.stdout
    names = {path.name for path in (tmp_path / "race").iterdir()}
    assert names == {"naf-s0", "random-s0", "race.md", "race.csv", "race.png", "race.pdf"}


def test_figures_of_both_trainings(balanced: Path) -> None:
    process = run("sarah-figures", "mine", "second", "--out", "figures", cwd=balanced.parent)
    assert process.returncode == 0, process.stderr
    files = process.stdout.split()
    names = {Path(file).stem for file in files}
    assert {"figure_3_pattern_generator", "figure_4_reward_and_frequency"} <= names
    assert ("figure_2_robot" in names) == is_installed("pybullet")
    assert len(files) == 2 * len(names) >= 10 and all((balanced.parent / file).stat().st_size > 5000 for file in files)
    assert "no gait cycle of mine" in process.stderr  # in half a second there is none
    alone = run("sarah-figures", "second", cwd=balanced.parent)
    assert sorted(path.name for path in (balanced / "figures").iterdir()) == sorted(
        Path(file).name for file in alone.stdout.split()
    )
