"""The second engine: the same robot, the same bytes each time, and an error where it is not installed."""

import dataclasses
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
from sarah.episode.evaluation import Evaluation, evaluate
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks.balance import TRAINED_STEPPING
from sarah.errors import ConfigurationError
from sarah.reports.transfer import Transfer
from sarah.robot.description import describe_robot
from sarah.robot.reading import GRAVITY, Side
from sarah.simulation import engines
from sarah.simulation.build import simulator_of
from sarah.simulation.physics import Physics
from sarah.simulation.randomisation import NOMINAL

SHORT = EpisodeConfig(engine="mujoco", time_limit=6.0)
MUJOCO_IS_MISSING = "import sys\nsys.modules['mujoco'] = None\n"
PYBULLET_IS_MISSING = "import sys\nsys.modules['pybullet'] = None\n"


@pytest.fixture
def mujoco_engine() -> None:
    """MuJoCo is installed, or the test is skipped."""
    need("mujoco")


@NEEDS_PYBULLET
@pytest.mark.parametrize("parameters", [PAPER_STEPPING, TRAINED_STEPPING])
def test_robot_steps_as_well_in_mujoco_as_in_pybullet(mujoco_engine: None, parameters: tuple[float, ...]) -> None:
    """Measured over 20 seeds: mean scores within 2 % of each other, and all survive."""
    pybullet, mujoco = (
        evaluate("stepping", parameters, EpisodeConfig(engine=engine), range(2)) for engine in ("pybullet", "mujoco")
    )
    for evaluation in (pybullet, mujoco):
        assert evaluation.survival_rate == 1.0 and evaluation.is_gait
        assert 2.8 < evaluation.mean("steps_per_second") < 3.4
    assert mujoco.mean("score") != pybullet.mean("score")
    assert mujoco.mean("score") == pytest.approx(pybullet.mean("score"), rel=0.03)


def test_same_spec_gives_identical_results_in_fresh_processes_whatever_they_simulated_before(
    mujoco_engine: None,
) -> None:
    program = (
        "import dataclasses, json, sarah\n"
        "config = sarah.BalanceConfig(engine='mujoco', time_limit=5.0)\n"
        "for seed in {seeds}:\n"
        "    result = sarah.simulate(sarah.EpisodeSpec((1.0, 0.1, 0.5, -0.2), seed, 'balance', config))\n"
        "print(json.dumps(dataclasses.asdict(result)))"
    )
    runs = [
        subprocess.run([sys.executable, "-c", program.format(seeds=seeds)], capture_output=True, check=True).stdout
        for seeds in ([7], [8, 3, 7])
    ]
    assert runs[0] == runs[1]
    assert json.loads(runs[0])["steps"] > 0


@pytest.mark.parametrize(
    ("asked", "taken"), [(Physics(100), Physics(500)), (Physics(250, 25, 250), Physics(500, 25, 250))]
)
def test_mujoco_takes_at_least_500_steps_a_second(mujoco_engine: None, asked: Physics, taken: Physics) -> None:
    results = [
        simulate(EpisodeSpec(PAPER_STEPPING, 1, config=dataclasses.replace(SHORT, time_limit=2.0, physics=physics)))
        for physics in (asked, taken, Physics(1000))
    ]
    assert results[0] == results[1] != results[2]


@pytest.mark.parametrize("rate", [500, 1000])
def test_soles_sink_a_few_micrometres_into_mujocos_floor(mujoco_engine: None, rate: int) -> None:
    """A contact of impedance d and stiffness k lets a standing body sink by (1 - d) a / k.

    d is 0.99, and k is 2 / (15 ms) times the rate. a is what the sole would fall with: with its plate, 1.5 g to 1.8 g.
    """
    simulation = simulator_of("mujoco")(describe_robot(), Physics(rate, solver_iterations=100), NOMINAL)
    for _ in range(300):
        simulation.advance()
    low, high = (0.01 * a * GRAVITY / (2.0 / 0.015 * rate) for a in (1.5, 1.85))
    assert all(low < -simulation.sole_height(side) < high for side in Side)


def test_episodes_that_stand_side_by_side_do_not_touch_each_other(mujoco_engine: None) -> None:
    expected = [simulate(EpisodeSpec(PAPER_STEPPING, seed, config=SHORT)) for seed in (1, 2)]
    assert expected[0] != expected[1]
    episodes = [Episode(SHORT, seed) for seed in (1, 2)]
    for episode in episodes:
        episode.stand()
    assert [episode.run(PAPER_STEPPING) for episode in reversed(episodes)] == expected[::-1]


def test_physics_that_diverges_ends_the_episode_and_writes_no_file(
    mujoco_engine: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    with Episode(SHORT, seed=0) as episode:
        episode.stand()
        episode.robot.tick(force=(1e300, 0.0, 0.0))
        assert episode.termination == "diverged" and math.isfinite(episode.result().score)
    assert not list(tmp_path.iterdir()) and capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("command", "arguments"),
    [
        ("train", ["--engine", "mujoco"]),
        ("eval", ["0.4,1.3,0.1,1,1", "--engine", "mujoco"]),
        ("compare", ["--out", "race", "--engine", "mujoco"]),
        pytest.param("transfer", ["run"], marks=NEEDS_PYBULLET),
    ],
)
def test_without_the_extra_a_command_says_how_to_get_it_and_writes_nothing(
    command: str, arguments: list[str], tmp_path: Path
) -> None:
    program = f"{MUJOCO_IS_MISSING}from sarah.cli.{command} import main\nsys.argv[1:] = {arguments}\nmain()"
    process = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=tmp_path)
    needed = "engine 'mujoco' needs the package mujoco: pip install 'sarah[mujoco]'"
    assert process.returncode == 2 and process.stderr == f"sarah-{command}: error: {needed}\n"
    assert not list(tmp_path.iterdir())


def test_what_pip_leaves_of_mujoco_is_no_engine(monkeypatch: pytest.MonkeyPatch) -> None:
    folder_only = ModuleSpec("mujoco", loader=None, is_package=True)
    monkeypatch.setattr(engines, "find_spec", lambda name: folder_only)
    with pytest.raises(ConfigurationError, match="needs the package mujoco"):
        simulator_of("mujoco")


@NEEDS_PYBULLET
def test_without_the_extra_pybullet_works() -> None:
    program = (
        f"{MUJOCO_IS_MISSING}import sarah\n"
        "spec = sarah.EpisodeSpec((0.4, 1.3, 0.1, 1.0, 1.0), 0, config=sarah.EpisodeConfig(time_limit=2.0))\n"
        "print(sarah.simulate(spec).termination)"
    )
    process = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert process.stdout == "time_limit\n"


def command_without_pybullet(command: str, *arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    program = f"{PYBULLET_IS_MISSING}from sarah.cli.{command} import main\nsys.argv[1:] = {arguments}\nmain()"
    return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=cwd)


def test_without_pybullet_mujoco_is_the_default_and_a_training_says_so(mujoco_engine: None, tmp_path: Path) -> None:
    arguments = ("--algo", "random", "--episodes", "2", "--episode.time-limit", "1.5", "--out", "run")
    process = command_without_pybullet("train", *arguments, cwd=tmp_path)
    assert process.returncode == 0, process.stderr
    assert process.stderr.startswith("PyBullet is not installed, so MuJoCo simulates\n")
    assert "engine: mujoco" in (tmp_path / "run" / "config.yaml").read_text()
    process = command_without_pybullet("report", "run", "--episodes", "2", cwd=tmp_path)
    assert process.returncode == 0, process.stderr
    page = (tmp_path / "run" / "report.html").read_text()
    assert "No video: pictures of the robot need the package pybullet" in page and "<video" not in page


@pytest.mark.parametrize(
    ("command", "arguments", "needs"),
    [
        ("train", ["--engine", "pybullet"], "engine 'pybullet' needs"),
        ("train", ["--pictures", "1"], "pictures of the robot need"),
        ("video", ["0.4,1.3,0.1,1,1", "--out", "a.gif"], "pictures of the robot need"),
        ("transfer", ["run"], "engine 'pybullet' needs"),
    ],
)
def test_without_pybullet_what_needs_it_is_one_line_that_says_how_to_get_it(
    mujoco_engine: None, command: str, arguments: list[str], needs: str, tmp_path: Path
) -> None:
    process = command_without_pybullet(command, *arguments, cwd=tmp_path)
    said = f"sarah-{command}: error: {needs} the package pybullet: pip install pybullet ("
    assert process.returncode == 2 and process.stderr.startswith(said) and process.stderr.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_kept_is_the_share_of_the_score_that_the_other_engine_gives() -> None:
    result = simulate(EpisodeSpec(PAPER_STEPPING, 0, config=EpisodeConfig(time_limit=1.5)))
    at_home, worse = Evaluation((result,)), Evaluation((dataclasses.replace(result, score=0.5 * result.score),))
    evaluations = {"pybullet": at_home, "mujoco": worse}
    for engine, kept in (("pybullet", 0.5), ("mujoco", 2.0)):
        learned = EpisodeSpec(PAPER_STEPPING, 0, "stepping", EpisodeConfig(engine=engine))
        assert Transfer("run", learned, evaluations).kept == pytest.approx(kept)
