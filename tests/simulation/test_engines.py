"""The second engine: the same robot, the same bytes each time, and an error where it is not installed."""

import dataclasses
import importlib
import json
import math
import subprocess
import sys
from importlib.machinery import ModuleSpec
from pathlib import Path

import pytest
from laboratory import NEEDS_PYBULLET, need

from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.episode import Episode, simulate
from sarah.episode.evaluation import evaluate
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BalanceConfig
from sarah.episode.tasks.balance import TRAINED_STEPPING
from sarah.errors import ConfigurationError
from sarah.robot.description import describe_robot
from sarah.robot.reading import GRAVITY, Side
from sarah.simulation import engines
from sarah.simulation.build import simulator_of
from sarah.simulation.physics import Physics
from sarah.simulation.randomisation import NOMINAL

SHORT = EpisodeConfig(engine="mujoco", time_limit=1.5)


@pytest.fixture
def mujoco_engine() -> None:
    """MuJoCo is installed, or the test is skipped."""
    need("mujoco")


@NEEDS_PYBULLET
def test_robot_steps_as_well_in_mujoco_as_in_pybullet(mujoco_engine: None) -> None:
    pybullet, mujoco = (
        evaluate("stepping", TRAINED_STEPPING, EpisodeConfig(engine=engine, time_limit=10.0), [0])
        for engine in ("pybullet", "mujoco")
    )
    for evaluation in (pybullet, mujoco):
        assert evaluation.survival_rate == 1.0 and evaluation.is_gait
        assert 2.8 < evaluation.mean("steps_per_second") < 3.4
    assert mujoco.mean("score") != pybullet.mean("score")
    assert mujoco.mean("score") == pytest.approx(pybullet.mean("score"), rel=0.03)


def test_a_fresh_process_repeats_whatever_it_simulated(mujoco_engine: None) -> None:
    parameters = (1.0, 0.1, 0.5, -0.2)
    program = (
        "import dataclasses, json, sarah\n"
        "config = sarah.BalanceConfig(engine='mujoco', time_limit=3.0)\n"
        "for seed in (8, 7):\n"
        f"    result = sarah.simulate(sarah.EpisodeSpec({parameters}, seed, 'balance', config))\n"
        "print(json.dumps(dataclasses.asdict(result)))"
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True, text=True)
    here = simulate(EpisodeSpec(parameters, 7, "balance", BalanceConfig(engine="mujoco", time_limit=3.0)))
    assert run.stdout == json.dumps(dataclasses.asdict(here)) + "\n" and here.steps > 0


@pytest.mark.parametrize(
    ("asked", "taken"), [(Physics(100), Physics(500)), (Physics(250, 25, 250), Physics(500, 25, 250))]
)
def test_mujoco_takes_at_least_500_steps_a_second(mujoco_engine: None, asked: Physics, taken: Physics) -> None:
    results = [
        simulate(EpisodeSpec(PAPER_STEPPING, 1, config=dataclasses.replace(SHORT, physics=physics)))
        for physics in (asked, taken, Physics(1000))
    ]
    assert results[0] == results[1] != results[2]


def test_soles_sink_a_few_micrometres_into_mujocos_floor(mujoco_engine: None) -> None:
    """A contact of impedance d and stiffness k lets a standing body sink by (1 - d) a / k.

    d is 0.99, and k is 2 / (15 ms) times the rate. a is what the sole would fall with: with its plate, 1.5 g to 1.8 g.
    """
    simulation = simulator_of("mujoco")(describe_robot(), Physics(500, solver_iterations=100), NOMINAL)
    for _ in range(300):
        simulation.advance()
    low, high = (0.01 * a * GRAVITY / (2.0 / 0.015 * 500) for a in (1.5, 1.85))
    assert all(low < -simulation.sole_height(side) < high for side in Side)


def test_episodes_side_by_side_do_not_touch_each_other(mujoco_engine: None) -> None:
    expected = [simulate(EpisodeSpec(PAPER_STEPPING, seed, config=SHORT)) for seed in (1, 2)]
    assert expected[0] != expected[1]
    episodes = [Episode(SHORT, seed) for seed in (1, 2)]
    for episode in episodes:
        episode.stand()
    assert [episode.run(PAPER_STEPPING) for episode in reversed(episodes)] == expected[::-1]


def test_diverging_physics_ends_the_episode_and_writes_no_file(
    mujoco_engine: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    with Episode(SHORT, seed=0) as episode:
        episode.stand()
        episode.robot.tick(force=(1e300, 0.0, 0.0))
        assert episode.termination == "diverged" and math.isfinite(episode.result().score)
    assert not list(tmp_path.iterdir()) and capfd.readouterr() == ("", "")


MUJOCO = "engine 'mujoco' needs the package mujoco: pip install 'sarah[mujoco]'\n"
PYBULLET = "the package pybullet: pip install pybullet ("


@pytest.mark.parametrize(
    ("command", "arguments", "missing", "said"),
    [
        ("train", ["--engine", "mujoco"], "mujoco", MUJOCO),
        ("eval", ["0.4,1.3,0.1,1,1", "--engine", "mujoco"], "mujoco", MUJOCO),
        ("compare", ["--out", "race", "--engine", "mujoco"], "mujoco", MUJOCO),
        pytest.param("transfer", ["run"], "mujoco", MUJOCO, marks=NEEDS_PYBULLET),
        ("train", ["--engine", "pybullet"], "pybullet", f"engine 'pybullet' needs {PYBULLET}"),
        ("train", ["--pictures", "1", "--engine", "mujoco"], "pybullet", f"pictures of the robot need {PYBULLET}"),
        (
            "video",
            ["0.4,1.3,0.1,1,1", "--engine", "mujoco", "--out", "a.gif"],
            "pybullet",
            f"pictures of the robot need {PYBULLET}",
        ),
        ("transfer", ["run"], "pybullet", f"engine 'pybullet' needs {PYBULLET}"),
    ],
)
def test_what_needs_a_missing_engine_says_how_to_get_it(
    command: str,
    arguments: list[str],
    missing: str,
    said: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    main = importlib.import_module(f"sarah.cli.{command}").main
    monkeypatch.setitem(sys.modules, missing, None)
    monkeypatch.setattr(sys, "argv", [f"sarah-{command}", *arguments])
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as ended:
        main()
    error = capsys.readouterr().err
    assert ended.value.code == 2 and error.startswith(f"sarah-{command}: error: {said}") and error.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_what_pip_leaves_of_mujoco_is_no_engine(monkeypatch: pytest.MonkeyPatch) -> None:
    folder_only = ModuleSpec("mujoco", loader=None, is_package=True)
    monkeypatch.setattr(engines, "find_spec", lambda name: folder_only)
    with pytest.raises(ConfigurationError, match="needs the package mujoco"):
        simulator_of("mujoco")


@NEEDS_PYBULLET
def test_without_the_extra_pybullet_works() -> None:
    program = (
        "import sys\nsys.modules['mujoco'] = None\nimport sarah\n"
        "spec = sarah.EpisodeSpec((0.4, 1.3, 0.1, 1.0, 1.0), 0, config=sarah.EpisodeConfig(time_limit=1.5))\n"
        "print(sarah.simulate(spec).termination)"
    )
    process = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert process.stdout == "time_limit\n"


def test_without_pybullet_a_training_says_that_mujoco_simulates(mujoco_engine: None, tmp_path: Path) -> None:
    arguments = ["--algo", "random", "--episodes", "2", "--episode.time-limit", "1.5", "--out", "run"]
    program = (
        "import sys\nsys.modules['pybullet'] = None\n"
        f"from sarah.cli.train import main\nsys.argv[1:] = {arguments}\nmain()"
    )
    process = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=tmp_path)
    assert process.returncode == 0, process.stderr
    assert process.stderr.startswith("PyBullet is not installed, so MuJoCo simulates\n")
    assert "engine: mujoco" in (tmp_path / "run" / "config.yaml").read_text()
