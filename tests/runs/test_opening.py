"""Opening somebody's run executes nothing: a bomb in every file of a run folder, and every command that opens one."""

import os
import pickle
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import get_args, get_type_hints

import pytest
from terminal import run

from sarah.episode.push import Push
from sarah.episode.settings import EpisodeConfig
from sarah.errors import ConfigurationError, DescriptionError
from sarah.robot.description import describe_robot
from sarah.runs.agent_settings import AGENT_SETTINGS
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.physics import Physics
from sarah.simulation.randomisation import Randomisation
from sarah.training import train as training
from sarah.training.train import train

EPISODE = EpisodeConfig(time_limit=1.1, physics=Physics(50, 5, control_rate=50))
CONFIG = TrainingConfig(episodes=3, slots=1, episode=EPISODE)
COARSE = "--episode.time-limit 1.2 --episode.push.at-seconds 1 1 --episode.physics.solver-iterations 5"
COMMANDS = (
    "sarah-eval {run} --episodes 1",
    "sarah-figures {run} --out figures",
    "sarah-video {run} --out out.gif --which best --seconds 1 1.05",
    "sarah-view {run} --which best --out out.html",
    "sarah-report {run} --episodes 1 --out report.html",
    "sarah-transfer {run} --episodes 1 --out transfer",
    "sarah-train --resume {run}",
    f"sarah-train --task balance --episodes 1 --slots 1 --out {{run}}-mine --from {{run}} {COARSE}",
    "sarah-compare --out {run}-race --algorithms random --seeds 1 --episodes 1 --evaluations 1",
)
"""Of the last, the run is a part of the race that is complete."""


class Bomb:
    """Writes a file when it is unpickled."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __reduce__(self) -> tuple[object, ...]:
        return (Path.touch, (self.path,))


@pytest.fixture(scope="module")
def honest(tmp_path_factory: pytest.TempPathFactory) -> Path:
    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.setattr(training, "SUMMARY_EPISODES", 1)
        folder = RunFolder.create(tmp_path_factory.mktemp("honest") / "run", CONFIG)
        train(CONFIG, folder)
    return folder.path


@pytest.fixture
def opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[Path], None]:
    """Opens a folder with every command; each works, or fails in one line."""
    monkeypatch.setattr(training, "SUMMARY_EPISODES", 1)

    def open_with_all(folder: Path) -> None:
        shutil.copytree(folder, tmp_path / f"{folder.name}-race" / "random-s0")
        for template in COMMANDS:
            command, *arguments = template.format(run=folder).split()
            ended = run(command, *arguments, cwd=tmp_path)
            assert ended.returncode in (0, 2), template
            assert not ended.returncode or ended.stderr.splitlines()[-1].startswith(f"{command}: error: ")

    return open_with_all


PLANTED = ("events.out.tfevents.9.host.9", "parameters.pkl", "replay_buffer.pkl", "policy.pth")
"""Names that somebody could hope to be opened."""


@pytest.mark.parametrize(
    ("spared", "finished"),
    [(set(), True), ({"config.yaml", "versions.txt"}, True), ({"config.yaml", "journal.jsonl", "versions.txt"}, False)],
)
def test_no_file_of_a_run_is_unpickled(
    spared: set[str], finished: bool, honest: Path, tmp_path: Path, opened: Callable[[Path], None]
) -> None:
    """A file that is read stops the command, so that those it reads next are spared in turn."""
    sprung, run = tmp_path / "sprung", shutil.copytree(honest, tmp_path / "run")
    if not finished:
        (run / "parameters.json").unlink()
    names = {*(path.name for path in run.iterdir()), *PLANTED} - spared
    for name in names:
        (run / name).write_bytes(pickle.dumps(Bomb(sprung)))
    opened(run)
    assert {*PLANTED, "model.zip", "episodes.csv"} < names and not sprung.exists()


def test_yaml_makes_no_objects(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for text in (
        "!!python/object/apply:pathlib.Path.touch [!!python/object/apply:pathlib.Path ['sprung']]",
        "algo: !!python/object/apply:os.system ['touch sprung']",
        "episode: {dimensions: {thigh_length: !!python/object/new:os.system ['touch sprung']}}",
    ):
        (tmp_path / "config.yaml").write_text(text)
        with pytest.raises(ConfigurationError):
            RunFolder.open(tmp_path, unfinished=True).config()
    assert not (tmp_path / "sprung").exists()


@pytest.mark.skipif(sys.version_info < (3, 11), reason="Python 3.10 always looks in the working folder")
def test_nothing_in_the_working_folder_is_imported(honest: Path, tmp_path: Path) -> None:
    """Not by workers either, which are new processes."""
    folder = shutil.copytree(honest, tmp_path / "run")
    for module in ("pickle", "socket", "signal", "yaml", "numpy", "sarah", "sitecustomize", "distributed"):
        (folder / f"{module}.py").write_text(f"open({str(tmp_path / 'sprung')!r}, 'w')")
    command = [str(Path(sys.executable).parent / "sarah-eval"), ".", "--episodes", "1", "--workers", "1"]
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}
    process = subprocess.run(command, cwd=folder, capture_output=True, text=True, env=environment, timeout=120)
    assert process.returncode == 0, process.stderr
    assert not (tmp_path / "sprung").exists()


def test_dimensions_are_numbers_and_nothing_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for value in ("${open('sprung', 'w')}", "../../etc/passwd", float("nan"), "0.33'/><link name='x'"):
        with pytest.raises(DescriptionError, match=r"'thigh_length' must be a number between"):
            describe_robot({"thigh_length": value})  # type: ignore[dict-item]
        with pytest.raises(DescriptionError, match="unknown robot dimension"):
            describe_robot({f"x:={value}": 1.0})
    assert not list(tmp_path.iterdir())


def test_no_setting_is_a_path() -> None:
    """So none leads out of the run folder. A device is one of a few names, and no file's task is loaded by its name."""
    texts = set()
    for config_type in (TrainingConfig, EpisodeConfig, Physics, Randomisation, Push, *AGENT_SETTINGS.values()):
        for name, kind in get_type_hints(config_type).items():
            assert kind is not Path
            if kind is str or (str in get_args(kind)[:1] and not hasattr(kind, "__origin__")):
                texts.add(name)
    assert texts == {"algo", "device"}
