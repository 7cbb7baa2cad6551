"""The second engine: the same robot, the same bytes each time, and an error where it is not installed."""

import math
import subprocess
import sys
from dataclasses import replace
from importlib.machinery import ModuleSpec
from pathlib import Path

import pytest
from laboratory import NEEDS_PYBULLET, advance
from terminal import run

from sarah import EpisodeConfig, EpisodeSpec, Physics, evaluate
from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.episode import Episode, simulate
from sarah.episode.tasks.balance import TRAINED_STEPPING
from sarah.errors import ConfigurationError
from sarah.robot.description import describe_robot
from sarah.robot.reading import GRAVITY, Side
from sarah.simulation import engines
from sarah.simulation.build import simulator_of
from sarah.simulation.engines import is_installed
from sarah.simulation.randomisation import NOMINAL

pytestmark = pytest.mark.skipif(not is_installed("mujoco"), reason="needs mujoco")
SHORT = EpisodeConfig(engine="mujoco", time_limit=1.5)


@NEEDS_PYBULLET
def test_robot_steps_as_well_in_mujoco_as_in_pybullet() -> None:
    pybullet, mujoco = (
        evaluate("stepping", TRAINED_STEPPING, EpisodeConfig(engine=engine, time_limit=10.0), [0])
        for engine in ("pybullet", "mujoco")
    )
    for evaluation in (pybullet, mujoco):
        assert evaluation.survival_rate == 1.0 and evaluation.is_gait
        assert 2.8 < evaluation.mean("steps_per_second") < 3.4
    assert mujoco.mean("score") != pybullet.mean("score")
    assert mujoco.mean("score") == pytest.approx(pybullet.mean("score"), rel=0.03)


@pytest.mark.parametrize(
    ("asked", "taken"), [(Physics(100), Physics(500)), (Physics(250, 25, 250), Physics(500, 25, 250))]
)
def test_mujoco_takes_at_least_500_steps_a_second(asked: Physics, taken: Physics) -> None:
    results = [
        simulate(EpisodeSpec(PAPER_STEPPING, 1, config=replace(SHORT, physics=physics)))
        for physics in (asked, taken, Physics(1000))
    ]
    assert results[0] == results[1] != results[2]


def test_soles_sink_a_few_micrometres_into_mujocos_floor() -> None:
    """A contact of impedance d and stiffness k lets a standing body sink by (1 - d) a / k.

    d is 0.99, and k is 2 / (15 ms) times the rate. a is what the sole would fall with: with its plate, 1.5 g to 1.8 g.
    """
    simulation = simulator_of("mujoco")(describe_robot(), Physics(500, solver_iterations=100), NOMINAL)
    advance(simulation, 300)
    low, high = (0.01 * a * GRAVITY / (2.0 / 0.015 * 500) for a in (1.5, 1.85))
    assert all(low < -simulation.sole_height(side) < high for side in Side)


def test_diverging_physics_ends_the_episode_and_writes_no_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    with Episode(SHORT, seed=0) as episode:
        episode.stand()
        episode.robot.tick(force=(1e300, 0.0, 0.0))
        assert episode.termination == "diverged" and math.isfinite(episode.result().score)
    assert not list(tmp_path.iterdir()) and capfd.readouterr() == ("", "")


STEPPING = "0.4,1.3,0.1,1,1"
MUJOCO = "engine 'mujoco' needs the package mujoco: pip install '.[mujoco]' in the clone\n"
PYBULLET = "the package pybullet: pip install pybullet ("


@pytest.mark.parametrize(
    ("command", "missing", "said"),
    [
        ("train --engine mujoco", "mujoco", MUJOCO),
        (f"eval {STEPPING} --engine mujoco", "mujoco", MUJOCO),
        ("compare --out race --engine mujoco", "mujoco", MUJOCO),
        pytest.param("transfer run", "mujoco", MUJOCO, marks=NEEDS_PYBULLET),
        ("train --engine pybullet", "pybullet", f"engine 'pybullet' needs {PYBULLET}"),
        ("train --pictures 1 --engine mujoco", "pybullet", f"pictures of the robot need {PYBULLET}"),
        (f"video {STEPPING} --engine mujoco --out a.gif", "pybullet", f"pictures of the robot need {PYBULLET}"),
        ("transfer run", "pybullet", f"engine 'pybullet' needs {PYBULLET}"),
    ],
)
def test_what_needs_a_missing_engine_says_how_to_get_it(
    command: str, missing: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, missing, None)
    name, *arguments = f"sarah-{command}".split()
    refused = run(name, *arguments, cwd=tmp_path)
    assert refused.returncode == 2 and refused.stderr.startswith(f"{name}: error: {said}")
    assert refused.stderr.count("\n") == 1 and not list(tmp_path.iterdir())
    # What pip leaves of a package that it removes is no engine
    monkeypatch.setattr(engines, "find_spec", lambda name: ModuleSpec(name, loader=None, is_package=True))
    with pytest.raises(ConfigurationError, match="needs the package mujoco"):
        simulator_of("mujoco")


@NEEDS_PYBULLET
@pytest.mark.parametrize(
    ("missing", "taken", "said"),
    [("mujoco", "pybullet", ""), ("pybullet", "mujoco", "PyBullet is not installed, so MuJoCo simulates\n")],
)
def test_one_engine_is_enough_for_a_training(missing: str, taken: str, said: str, tmp_path: Path) -> None:
    arguments = ["--algo", "random", "--episodes", "2", "--episode.time-limit", "1.5", "--out", "run"]
    program = (
        f"import sys\nsys.modules[{missing!r}] = None\n"
        f"from sarah.cli.train import main\nsys.argv[1:] = {arguments}\nmain()"
    )
    process = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=tmp_path)
    assert process.returncode == 0, process.stderr
    assert process.stderr.startswith(said) and ("simulates" in process.stderr) == bool(said)
    assert f"engine: {taken}" in (tmp_path / "run" / "config.yaml").read_text()
