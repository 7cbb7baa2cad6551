"""The commands as a user runs them: in a process of their own, from another folder."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from laboratory import NEEDS_PYBULLET, need

from sarah.cli.eval import EvalOptions, _changed
from sarah.episode.settings import EpisodeConfig
from sarah.episode.tasks import STEPPING
from sarah.simulation.engines import default_engine, is_installed
from sarah.simulation.physics import Physics

BIN = Path(sys.executable).parent
SHORT = ("--episode.time-limit", "1.5", "--slots", "1")


def run(command: str, *arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([BIN / command, *arguments], capture_output=True, text=True, cwd=cwd, timeout=300)


@pytest.fixture(scope="module")
def trained(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, subprocess.CompletedProcess[str]]:
    folder = tmp_path_factory.mktemp("work")
    arguments = ("--task", "stepping", "--algo", "naf", "--episodes", "4", "--seed", "1", "--run-dir", "mine")
    return folder / "mine", run("sarah-train", *arguments, *SHORT, cwd=folder)


def test_train_ends_with_a_summary(trained: tuple[Path, subprocess.CompletedProcess[str]]) -> None:
    folder, process = trained
    assert process.returncode == 0, process.stderr
    for text in ("learned", *STEPPING.parameter_names, "score", "run folder  mine"):
        assert text in process.stdout
    assert "Traceback" not in process.stderr and "pybullet" not in process.stderr
    assert (folder / "parameters.json").is_file()
    assert "sarah-train --task stepping" in (folder / "command.txt").read_text()


def test_train_shows_its_progress(trained: tuple[Path, subprocess.CompletedProcess[str]]) -> None:
    _, process = trained
    assert "4/4" in process.stdout + process.stderr


def test_workers_train_and_evaluate_the_same(
    trained: tuple[Path, subprocess.CompletedProcess[str]], tmp_path: Path
) -> None:
    alone, _ = trained
    arguments = ("--episodes", "4", "--seed", "1", "--workers", "2", "--run-dir", "mine")
    process = run("sarah-train", *arguments, *SHORT, cwd=tmp_path)
    assert process.returncode == 0, process.stderr
    assert "Warning" not in process.stderr
    assert (tmp_path / "mine" / "episodes.csv").read_bytes() == (alone / "episodes.csv").read_bytes()
    tables = [
        run("sarah-eval", str(alone), "--episodes", "3", *workers, cwd=tmp_path).stdout
        for workers in ((), ("--workers", "2"))
    ]
    assert "score" in tables[0] and tables[0] == tables[1]


def test_compare_ends_with_table_and_plot(tmp_path: Path) -> None:
    arguments = ("--algorithms", "naf", "random", "--seeds", "1", "--episodes", "6", "--episodes", "1")
    process = run("sarah-compare", "race", *arguments, *SHORT, "--workers", "2", cwd=tmp_path)
    assert process.returncode == 0, process.stderr
    assert "| naf | 1 |" in process.stdout and "| random | 1 |" in process.stdout
    names = {path.name for path in (tmp_path / "race").iterdir()}
    assert names == {"naf-s0", "random-s0", "race.md", "race.csv", "race.png", "race.pdf"}


def test_eval_summarises_a_run(trained: tuple[Path, subprocess.CompletedProcess[str]]) -> None:
    folder, _ = trained
    process = run("sarah-eval", str(folder), "--episodes", "2", cwd=folder)
    assert process.returncode == 0, process.stderr
    for text in ("parameters", "score", "steps per second", "drift", "survival", "SHIFT by sensors", "sole clearance"):
        assert text in process.stdout


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


@NEEDS_PYBULLET
def test_mujoco_trains_and_its_run_is_evaluated_in_it(tmp_path: Path) -> None:
    need("mujoco")
    arguments = ("--algo", "random", "--episodes", "2", "--engine", "mujoco", "--run-dir", "mine")
    process = run("sarah-train", *arguments, *SHORT, "--workers", "2", cwd=tmp_path)
    assert process.returncode == 0, process.stderr
    assert "engine: mujoco" in (tmp_path / "mine" / "config.yaml").read_text()
    assert "mujoco" in (tmp_path / "mine" / "versions.txt").read_text()
    summaries = [
        run("sarah-eval", "mine", "--episodes", "2", *engine, cwd=tmp_path).stdout
        for engine in ((), ("--engine", "mujoco"), ("--engine", "pybullet"))
    ]
    assert summaries[0] == summaries[1] != summaries[2]


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


@pytest.fixture(scope="module")
def balanced(trained: tuple[Path, subprocess.CompletedProcess[str]]) -> Path:
    """A second training on what the first one learned."""
    first, _ = trained
    arguments = ("--task", "balance", "--from", "mine", "--episodes", "4", "--run-dir", "second", *SHORT)
    process = run("sarah-train", *arguments, cwd=first.parent)
    assert process.returncode == 0, process.stderr
    assert "V4 = " in process.stdout and "baseline (V = 0)" in process.stdout
    return first.parent / "second"


def test_second_training_keeps_what_the_first_learned(balanced: Path) -> None:
    first = json.loads((balanced.parent / "mine" / "parameters.json").read_text())
    second = json.loads((balanced / "parameters.json").read_text())
    assert second["stepping"] == list(first["parameters"].values())
    assert list(second["parameters"]) == ["V1", "V2", "V3", "V4"]


def test_only_a_balance_training_continues_a_first_one(balanced: Path) -> None:
    for arguments, message in (
        (("--from", "mine"), "--from is for --task balance, not 'stepping'"),
        (("--task", "balance", "--from", "second"), "--from needs the run folder of a training of 'stepping'"),
    ):
        process = run("sarah-train", *arguments, cwd=balanced.parent)
        assert process.returncode == 2 and message in process.stderr and len(process.stderr.splitlines()) == 1


def test_eval_of_a_second_training_compares_with_v_at_zero(balanced: Path) -> None:
    arguments = ("second", "--episodes", "2", "--push-newtons", "60")
    content = json.loads(run("sarah-eval", *arguments, "--json", cwd=balanced.parent).stdout)
    assert content["task"] == "balance" and list(content["parameters"]) == ["V1", "V2", "V3", "V4"]
    assert content["chatters"] is False and content["without"]["episodes"] == 2
    text = run("sarah-eval", *arguments, cwd=balanced.parent).stdout
    for label in ("baseline (V = 0)", "vibration", "no chatter", "actuators"):
        assert label in text


def test_eval_options_reach_the_episodes() -> None:
    options = EvalOptions(push_newtons=60.0, stepping="0.1,0.2,0.3,0.4,0.5", physics="reference", randomisation=False)
    trained_at_200_hz = EpisodeConfig(physics=Physics(rate=400, control_rate=200))
    config = _changed(trained_at_200_hz, options, "balance")
    assert config.push.newtons == (60.0, 60.0) and config.stepping == (0.1, 0.2, 0.3, 0.4, 0.5)
    assert config.physics == Physics(1000, 100, 200, 0.0) and not config.randomisation.enabled


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


def test_eval_takes_parameters_without_a_run(tmp_path: Path) -> None:
    arguments = ("--task", "stepping", "--parameters", "0.4,1.3,0.1,1,1", "--episodes", "2", "--json")
    first, second = (json.loads(run("sarah-eval", *arguments, cwd=tmp_path).stdout) for _ in range(2))
    assert first == second
    assert first["algorithm"] is None and list(first["parameters"].values()) == [0.4, 1.3, 0.1, 1.0, 1.0]
    assert first["survival_rate"] == 1.0 and first["score_median"] > 0.78
    exact = json.loads(run("sarah-eval", *arguments, "--no-randomisation", cwd=tmp_path).stdout)
    assert exact["score_mean"] != first["score_mean"] and exact["survival_rate"] == 1.0


def test_training_is_configured_by_a_file_and_overridden_by_options(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text("algo: td3\nsimulations: 2\nslots: 1\nepisode: {time_limit: 1.5}\n")
    process = run("sarah-train", "--config", "mine.yaml", "--episodes", "3", "--run-dir", "out", cwd=tmp_path)
    assert process.returncode == 0, process.stderr
    config = (tmp_path / "out" / "config.yaml").read_text()
    assert "algo: td3" in config and "simulations: 3" in config and "time_limit: 1.5" in config


@pytest.mark.parametrize(
    ("command", "options"),
    [
        (
            "sarah-train",
            ("--task", "--algo", "--episodes", "--seed", "--run-dir", "--config", "--workers", "--scheduler"),
        ),
        ("sarah-figures", ("RUN", "--out")),
        ("sarah-view", ("RUN|NUMBERS", "--episode", "--seed", "--export", "--host", "--port", "no password")),
        ("sarah-video", ("RUN|NUMBERS", "OUT", "--episode", "--seed", "--push-newtons", "--seconds", "--speed")),
        ("sarah-compare", ("DIR", "--algorithms", "--seeds", "--episodes", "--best-known", "--workers")),
        ("sarah-eval", ("RUN", "--episodes", "--first-seed", "--json", "--parameters", "--task")),
    ],
)
def test_help_names_the_options(command: str, options: tuple[str, ...], tmp_path: Path) -> None:
    process = run(command, "--help", cwd=tmp_path)
    assert process.returncode == 0
    for option in options:
        assert option in process.stdout


def test_mistakes_get_one_line_on_a_plain_terminal_too(tmp_path: Path) -> None:
    environment = {**os.environ, "LC_ALL": "C", "PYTHONIOENCODING": "ascii"}
    process = subprocess.run(
        [BIN / "sarah-train", "--simulatons", "5"], capture_output=True, text=True, cwd=tmp_path, env=environment
    )
    assert process.stderr == (
        "sarah-train: error: Unrecognized options: --simulatons, 5, did you mean --simulations?\n"
    )


def test_a_reader_who_has_had_enough_is_no_error(tmp_path: Path) -> None:
    command = f"{BIN / 'sarah-eval'} --parameters 1,1,1,1,1 --episodes 1 --engine {default_engine()} | true"
    process = subprocess.run(["bash", "-c", command], capture_output=True, text=True, cwd=tmp_path)
    assert process.stderr == ""


@pytest.mark.parametrize("command", ["train", "eval", "figures", "compare", "transfer", "video", "view"])
def test_help_loads_nothing_slow(command: str) -> None:
    program = (
        f"import sys\nfrom sarah.cli.{command} import main\nsys.argv = ['command', '--help']\n"
        "try:\n    main()\nexcept SystemExit:\n    pass\n"
        "slow = {'torch', 'viser', 'matplotlib', 'pybullet', 'stable_baselines3', 'yourdfpy'}\n"
        "slow |= {'yaml', 'mujoco'}\n"
        "sys.exit(' '.join(slow & set(sys.modules)) or 0)"
    )
    process = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert process.stderr == "" and process.returncode == 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("sarah-train --task steping", "unknown task 'steping', did you mean 'stepping'?"),
        ("sarah-train --algo naff", "unknown algo 'naff', did you mean 'naf'?"),
        ("sarah-train --simulatons 5", "did you mean --simulations?"),
        ("sarah-train --episodes -5", "simulations must be between 1 and 1e+06, not -5"),
        ("sarah-train --episodes many", "--episodes must be a whole number, not 'many'"),
        ("sarah-train --seed -1", "seed must be between 0"),
        ("sarah-train --workers -1", "workers must be between 0 and 1000, not -1"),
        ("sarah-train --workers 1 --scheduler tcp://127.0.0.1:9", "give one of the two"),
        ("sarah-train --scheduler nonsense", "no Dask scheduler answers at 'nonsense'"),
        ("sarah-train --slots 0", "slots must be between 1 and 10000, not 0"),
        ("sarah-train --config nothing.yaml", "cannot read nothing.yaml"),
        ("sarah-train --config", "--config"),
        ("sarah-train --run-dir full", "run folder full is not empty"),
        ("sarah-train --run-dir full/precious.txt", "cannot write run folder"),
        ("sarah-train --episode.dimensions tigh_length 0.3", "did you mean 'thigh_length'?"),
        ("sarah-train --episode.dimensions thigh_length nan", "must be a number between 0.033 and 3.3, not nan"),
        ("sarah-train --episode.dimensions thigh_mass 9", "must weigh 10 kg"),
        ("sarah-train --episode.physics.rate 250", "physics.rate must be a multiple of the control rate, 100 Hz"),
        ("sarah-train --from nowhere --task balance", "run folder nowhere does not exist"),
        ("sarah-train --task balance --from full", "not the folder of a finished training"),
        ("sarah-train --task balance --episode.stepping 1 1 1 1 3", "parameter P5 must be between 0 and 2, not 3.0"),
        ("sarah-train --episode.push.newtons 50 20", "push.newtons must be between 0 and 10000 N and in rising order"),
        ("sarah-train --episode.push.at-seconds 0.5 2", "push.at_seconds must be between 1 and 3600 s"),
        (
            "sarah-train --episode.push.duration 0.004",
            "push.duration must be at least a control tick, 0.01 s, not 0.004",
        ),
        ("sarah-train --episode.physics.control-rate 5", "physics.control_rate must be between 50 and 1000 Hz, not 5"),
        ("sarah-train --engine mujco", "unknown engine 'mujco', did you mean 'mujoco'?"),
        ("sarah-compare race --engine bullet", "unknown engine 'bullet', did you mean 'pybullet'?"),
        ("sarah-eval --parameters 1,1,1,1,1 --engine mujco", "unknown engine 'mujco', did you mean 'mujoco'?"),
        ("sarah-transfer", "give at least one run folder"),
        ("sarah-transfer full full", "several runs need a folder for table and figure: --out DIR"),
        ("sarah-transfer full --episodes 0", "episodes must be at least 1, not 0"),
        ("sarah-transfer full --first-seed -1", "first-seed must not be negative, not -1"),
        ("sarah-train --task stepping --episode.push.newtons 50 60", "episode.push is for task 'balance'"),
        ("sarah-train --task balance --episode.time-limit 1.5 --episode.push.at-seconds 2 3", "before the time_limit"),
        ("sarah-eval --task balance --parameters 1,0,1", "must be 4 numbers (V1 to V4), not 3"),
        ("sarah-eval --task balance --parameters 1,0,1,-3", "V4 must be between -2 and 2, not -3.0"),
        (
            "sarah-eval --task balance --parameters 1,0,1,0 --push-newtons -5",
            "push.newtons must be between 0 and 10000 N",
        ),
        (
            "sarah-eval --task balance --parameters 1,0,1,0 --stepping 1,1",
            "stepping must be 5 numbers (P1 to P5), not 2",
        ),
        ("sarah-eval --parameters 1,1,1,1,1 --push-newtons 50", "--push-newtons is for --task balance"),
        ("sarah-eval --parameters 1,1,1,1,1 --stepping 1,1,1,1,1", "--stepping is for --task balance"),
        ("sarah-eval --task balance --parameters 1,0,1,0 --robustness x --json", "leave --json out"),
        ("sarah-eval --task balance --parameters 1,0,1,0 --robustness x --push-newtons 0", "must be above 0"),
        ("sarah-eval --task balance --parameters 1,0,1,0 --robustness full/precious.txt", "cannot write folder full/"),
        ("sarah-figures", "give at least one run folder"),
        ("sarah-compare", "give a folder for the race"),
        ("sarah-compare race --algorithms nafff", "unknown algo 'nafff', did you mean 'naf'?"),
        ("sarah-compare race --seeds 0", "seeds must be between 1 and 1000, not 0"),
        ("sarah-figures full full", "several runs need a folder for their figures: --out DIR"),
        ("sarah-figures full", "not the folder of a finished training"),
        ("sarah-view nowhere", "nowhere is neither a run folder nor numbers separated by commas"),
        ("sarah-view full", "full is not the folder of a training"),
        ("sarah-view 1,1,1,1,9", "parameter P5 must be between 0 and 2, not 9.0"),
        ("sarah-view 1,1,1,1,1 --seed -1", "seed must be a whole number from 0, not -1"),
        ("sarah-view 1,1,1,1,1 --episode best", "--episode is for a run folder"),
        ("sarah-view --port 0", "port must be between 1 and 65535, not 0"),
        ("sarah-view --host nonsense.invalid", "cannot serve a page at 'nonsense.invalid'"),
        ("sarah-view --export nowhere/a.html", "cannot write nowhere/a.html: folder nowhere does not exist"),
        ("sarah-view --export full", "cannot write full: it is a folder"),
        ("sarah-video", "give a run folder or parameters, and the file to write"),
        ("sarah-video full", "give a run folder or parameters, and the file to write"),
        ("sarah-video full a.avi", "must end in .mp4 or .gif, not 'a.avi'"),
        ("sarah-video full nowhere/a.gif", "folder nowhere does not exist"),
        ("sarah-video full a.gif", "full is not the folder of a training"),
        ("sarah-video nowhere a.gif", "nowhere is neither a run folder nor numbers separated by commas"),
        ("sarah-video 1,1,1 a.gif", "must be 5 numbers (P1 to P5) or 4 numbers (V1 to V4), not 3"),
        ("sarah-video 1,1,1,1,1 a.gif --push-newtons 50", "--push-newtons is for V1 to V4"),
        ("sarah-video 1,1,1,1,1 a.gif --episode best", "--episode is for a run folder"),
        ("sarah-video 1,1,1,1,1 a.gif --speed 0", "speed must be between 0.01 and 10, not 0.0"),
        ("sarah-video 1,1,1,1,1 a.gif --seconds 3 2", "seconds must be in rising order"),
        ("sarah-video 1,1,1,1,1 a.gif --seed -1", "seed must be a whole number from 0, not -1"),
        ("sarah-video 1,1,1,1,1 a.gif --seconds 40 41", "nothing to film"),
        ("sarah-eval", "give either a run folder or --parameters"),
        ("sarah-eval nowhere", "run folder nowhere does not exist"),
        ("sarah-eval full", "not the folder of a finished training"),
        ("sarah-eval full --task steping", "unknown task 'steping', did you mean 'stepping'?"),
        ("sarah-eval full --parameters 1,1,1,1,1", "give either a run folder or --parameters"),
        ("sarah-eval --parameters 0.4,1.3,0.1,1", "must be 5 numbers"),
        ("sarah-eval --parameters 0.4,1.3,0.1,1,nan", "P5 must be between 0 and 2, not nan"),
        ("sarah-eval --parameters 0.4,1.3,0.1,1,2.5", "P5 must be between 0 and 2, not 2.5"),
        ("sarah-eval --parameters a,b", "numbers separated by commas"),
        ("sarah-eval --task walk --parameters 1,1,1,1,1", "unknown task 'walk'"),
        ("sarah-eval --parameters 1,1,1,1,1 --episodes 0", "episodes must be between 1 and 1e+06, not 0"),
        ("sarah-eval --parameters 1,1,1,1,1 --first-seed -1", "first-seed must be between 0 and 4.29497e+09, not -1"),
        ("sarah-eval --parameters 1,1,1,1,1 --physics fine", "unknown physics 'fine'"),
    ],
)
def test_mistakes_get_one_line_and_leave_everything_alone(arguments: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "precious.txt").write_text("data")
    command, *rest = arguments.split()
    process = run(command, *rest, cwd=tmp_path)
    assert process.returncode == 2
    assert process.stdout == "" and len(process.stderr.splitlines()) == 1, process.stderr
    assert process.stderr.startswith(f"{command}: error: ") and message in process.stderr
    assert [str(path.relative_to(tmp_path)) for path in sorted(tmp_path.rglob("*"))] == ["full", "full/precious.txt"]
