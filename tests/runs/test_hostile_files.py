"""A run folder that somebody made to harm: no command executes what is in it, and each ends with one line in time."""

import os
import pickle
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, get_args, get_type_hints

import pytest
from terminal import run

from sarah import EpisodeConfig, Physics, Push, Randomisation
from sarah.episode.workers import Workers
from sarah.errors import ConfigurationError, DescriptionError
from sarah.files import read_lines, read_text, replace_text
from sarah.reports.judging import Evaluations
from sarah.reports.race import race
from sarah.reports.race_entry import entries_of
from sarah.robot.description import describe_robot
from sarah.runs.agent_settings import AGENT_SETTINGS
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.engines import is_installed
from sarah.training import train as training

COARSE = "--episode.physics.solver-iterations 5"
EVAL = "sarah-eval race/naf-s0 --episodes 1"
FIGURES = "sarah-figures race/naf-s0 --out figures"
VIDEO = "sarah-video race/naf-s0 --out out.gif --which best --seconds 1 1.05"
VIEW = "sarah-view race/naf-s0 --which best --out out.html"
REPORT = "sarah-report race/naf-s0 --episodes 1 --out report.html"
TRANSFER = "sarah-transfer race/naf-s0 --episodes 1 --out transfer"
RESUME = "sarah-train --resume race/naf-s0"
FROM = (
    "sarah-train --task balance --episodes 1 --slots 1 --out second --from race/naf-s0 --episode.time-limit 1.2 "
    f"--episode.push.at-seconds 1 1 {COARSE}"
)
COMPARE = (
    "sarah-compare --out race --algorithms naf --seeds 1 --episodes 5 --evaluations 2 --episode.time-limit 1.1 "
    f"--episode.physics.rate 50 --episode.physics.control-rate 50 {COARSE}"
)
READERS = {
    "config.yaml": (EVAL, FIGURES, VIDEO, VIEW, REPORT, TRANSFER, RESUME, FROM, COMPARE),
    "parameters.json": (EVAL, FIGURES, VIDEO, VIEW, REPORT, TRANSFER, FROM, COMPARE),
    "episodes.csv": (FIGURES, VIEW, REPORT),
    "versions.txt": (REPORT,),
    "journal.jsonl": (RESUME,),
    "race.csv": (COMPARE,),
    "race_scores.csv": (COMPARE.replace("--evaluations 2", "--evaluations 1"),),
    "recommendations.csv": (COMPARE,),
}
"""Commands that read a file of a run folder."""


@pytest.fixture(scope="module", autouse=True)
def _short_summaries() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.setattr(training, "SUMMARY_EPISODES", 1)
        yield


@pytest.fixture(scope="module")
def honest(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("honest") / "race"
    episode = EpisodeConfig(time_limit=1.1, physics=Physics(50, 5, control_rate=50))
    base = TrainingConfig(episodes=5, slots=1, episode=episode)
    race(entries_of(("naf",), range(1), base, Evaluations(1, 1), folder), Workers())
    return folder


@pytest.fixture
def folder(honest: Path, tmp_path: Path) -> Path:
    """A run folder of one's own, in a race."""
    return Path(shutil.copytree(honest, tmp_path / "race")) / "naf-s0"


class Bomb:
    """Writes a file when it is unpickled."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __reduce__(self) -> tuple[object, ...]:
        return (Path.touch, (self.path,))


PLANTED = ("events.out.tfevents.9.host.9", "parameters.pkl", "replay_buffer.pkl", "policy.pth")
"""Names that somebody could hope to be opened."""


@pytest.mark.parametrize(
    ("spared", "finished"),
    [(set(), True), ({"config.yaml", "versions.txt"}, True), ({"config.yaml", "journal.jsonl", "versions.txt"}, False)],
)
def test_no_file_of_a_run_is_unpickled(spared: set[str], finished: bool, folder: Path, tmp_path: Path) -> None:
    """A file that is read stops the command, so that those it reads next are spared in turn."""
    if not finished:
        (folder / "parameters.json").unlink()
    names = {*(path.name for path in folder.iterdir()), *PLANTED} - spared
    for name in names:
        (folder / name).write_bytes(pickle.dumps(Bomb(tmp_path / "sprung")))
    for line in READERS["config.yaml"]:
        ended = run(*line.split(), cwd=tmp_path)
        assert ended.returncode in (0, 2), line
        assert not ended.returncode or ended.stderr.splitlines()[-1].startswith(f"{line.split()[0]}: error: ")
    assert {*PLANTED, "model.zip", "episodes.csv"} < names and not (tmp_path / "sprung").exists()


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
def test_nothing_in_the_working_folder_is_imported(folder: Path, tmp_path: Path) -> None:
    """Not by workers either, which are new processes."""
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


def laughs(path: Path) -> None:
    """A small file that is a large value: each level is twice the one before."""
    levels = ["a0: &a0 {x: 1, y: 1}"]
    levels += [f"a{level}: &a{level} {{x: *a{level - 1}, y: *a{level - 1}}}" for level in range(1, 40)]
    path.write_text("\n".join(levels))


def filled(text: str) -> Callable[[Path], object]:
    return lambda path: path.write_text(text)


NESTED, LONG_LINE, BLANK_LINES = map(filled, ("[" * 60_000, "x," * 1_000_000, "index,seed\n" + "\n" * 10_000))


def digits(path: Path) -> None:
    path.write_text("task: stepping\nepisodes: " + "9" * 60_000 if path.suffix == ".yaml" else "9" * 60_000)


def gigabytes(path: Path) -> None:
    os.truncate(path, 20 * 2**30)


def fifo(path: Path) -> None:
    path.unlink(missing_ok=True)
    os.mkfifo(path)


def device(path: Path) -> None:
    path.unlink()
    path.symlink_to("/dev/zero")


HARMS: dict[str, tuple[Callable[[Path], object], ...]] = {
    "config.yaml": (laughs, NESTED, digits, gigabytes, fifo),
    "parameters.json": (NESTED, digits, fifo),
    "versions.txt": (fifo,),
    "journal.jsonl": (NESTED, gigabytes, device),
    "race.csv": (fifo,),
    "race_scores.csv": (LONG_LINE,),
    "recommendations.csv": (gigabytes,),
    "episodes.csv": (gigabytes, LONG_LINE, BLANK_LINES, fifo),
}
SECONDS = 60
"""Time that a command may take on a machine that has other things to do, too."""


class TooSlow(BaseException):
    """Not an error that a command could take for one of its own."""


@pytest.fixture
def within_seconds() -> Iterator[None]:
    def stop(*_: object) -> None:
        raise TooSlow

    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(SECONDS)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


@pytest.mark.usefixtures("within_seconds")
@pytest.mark.parametrize(("name", "harm"), [(name, harm) for name, harms in HARMS.items() for harm in harms])
def test_hostile_files_are_refused_within_seconds(name: str, harm: Any, folder: Path, tmp_path: Path) -> None:
    harm(folder / name)
    if name == "journal.jsonl":
        (folder / "parameters.json").unlink()  # what is finished is not resumed
    # The worst are tried on every command, the others on one: all read by the same functions.
    for line in READERS[name][: None if harm in (laughs, fifo) else 1]:
        if line in (VIDEO, VIEW, COMPARE) and not (folder / "parameters.json").is_file():
            continue  # they take a training that is not finished as it is
        if line in (VIDEO, TRANSFER) and not is_installed("pybullet"):
            continue  # they miss it before they read
        signal.alarm(SECONDS)
        try:
            ended = run(*line.split(), cwd=tmp_path)
        except TooSlow:
            pytest.fail(f"{line} did not end", pytrace=False)
        message = ended.stderr.splitlines()[-1]
        assert ended.returncode == 2 and message.startswith(f"{line.split()[0]}: error: "), line
        assert ("naf-s0" in message) and len(message) < 1000, message


def test_links_are_followed(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "run").symlink_to(folder)
    (tmp_path / "parameters.json").symlink_to(folder / "parameters.json")
    assert len(RunFolder.open(tmp_path / "run").parameters()) == 5
    assert '"parameters"' in read_text(tmp_path / "parameters.json")


def test_sizes_are_those_that_are_said(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_text("ab\ncd\ne\n")
    assert read_text(path, most_bytes=8) == "ab\ncd\ne\n" and list(read_lines(path, 3, 3)) == ["ab\n", "cd\n", "e\n"]
    for read, words in (
        (lambda: read_text(path, most_bytes=7), "it has more than 7 bytes"),
        (lambda: list(read_lines(path, 4, 2)), "it has more than 2 bytes in line 1"),
        (lambda: list(read_lines(path, 2, 9)), "it has more than 2 lines"),
        (lambda: read_text(tmp_path), "it is not a regular file"),
    ):
        with pytest.raises(OSError, match=words):
            read()


@pytest.mark.usefixtures("within_seconds")
def test_what_is_replaced_goes_through_no_link_and_no_fifo(tmp_path: Path) -> None:
    file, precious = tmp_path / "file", tmp_path / "precious"
    precious.write_text("data")
    file.symlink_to(precious)
    replace_text(file, "one")
    assert file.read_text() == "one" and precious.read_text() == "data"
    fifo(file)
    replace_text(file, "two")
    assert file.read_text() == "two"
