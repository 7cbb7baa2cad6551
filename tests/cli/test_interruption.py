"""Commands that are interrupted, locked out, or run out of disk: nothing finished is lost."""

import os
import re
import shlex
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from terminal import BIN, COARSE, run

from sarah.cli.interruption import interruptible
from sarah.errors import ResumeError, RunFolderError

# Long enough to be interrupted also where the test itself has to wait for the processor.
TRAINING = (
    "--algo",
    "random",
    "--episodes",
    "60",
    "--slots",
    "2",
    "--out",
    "run",
    "--episode.time-limit",
    "2",
    *COARSE,
)
RECORDS = ("episodes.csv", "recommendations.csv", "progress.csv", "parameters.json")


def begin(folder: Path, *arguments: str) -> subprocess.Popen[str]:
    """A training in a process of its own."""
    return subprocess.Popen(
        [BIN / "sarah-train", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=folder,
        # Whoever starts the tests in the background may have switched Ctrl-C off, and programs inherit that.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )


def rows(folder: Path) -> list[bytes]:
    journal = folder / "journal.jsonl"
    return journal.read_bytes().splitlines() if journal.exists() else []


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    folder = tmp_path_factory.mktemp("expected")
    finished = run("sarah-train", *TRAINING, cwd=folder)
    assert finished.returncode == 0, finished.stderr
    return {name: (folder / "run" / name).read_bytes() for name in RECORDS}


def test_killed_locked_stopped_and_resumed(expected: dict[str, bytes], tmp_path: Path) -> None:
    folder = tmp_path / "run"
    process = begin(tmp_path, *TRAINING)
    while process.poll() is None and len(rows(folder)) < 9:
        time.sleep(0.01)
    process.send_signal(signal.SIGSTOP)  # so that it is still there when the other comes
    intruder = run("sarah-train", "--resume", "run", cwd=tmp_path)
    assert intruder.returncode == 2 and "run folder run is in use by another training" in intruder.stderr
    assert intruder.stdout == ""  # it does not say that it resumes
    process.terminate()
    process.send_signal(signal.SIGCONT)
    _, errors = process.communicate(timeout=400)
    assert process.returncode == 128 + signal.SIGTERM and "Traceback" not in errors and "pybullet" not in errors
    assert "stopping when this episode is over; a second signal stops at once" in errors
    (command,) = re.findall(r"sarah-train: interrupted; go on with (sarah-train --resume \S+)", errors)
    kept, known = rows(folder), len((folder / "episodes.csv").read_text().splitlines()) - 1

    finished = run(*shlex.split(command), cwd=tmp_path)
    assert finished.returncode == 0, finished.stderr
    said = f"resuming the training of random on stepping: 60 episodes, of which episodes.csv has {known}, into run\n"
    assert said in finished.stdout
    assert rows(folder)[: len(kept)] == kept
    assert {name: (folder / name).read_bytes() for name in RECORDS} == expected
    again = run("sarah-train", "--resume", "run", cwd=tmp_path)
    said = "run is finished: to go on, add --episodes with more than its 60\n"
    assert (again.returncode, again.stdout, again.stderr) == (0, said, "")


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of its own, with 60 kB."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=60k", "none", str(folder)], capture_output=True)
    if mounted.returncode:
        pytest.skip(f"no file system can be mounted here: {mounted.stderr.decode().strip()}")
    yield folder
    subprocess.run(["umount", "--lazy", str(folder)], check=True)


def test_a_full_disk_stops_the_training_and_space_lets_it_go_on(expected: dict[str, bytes], small_disk: Path) -> None:
    stopped = run("sarah-train", *TRAINING, cwd=small_disk)
    said = r"sarah-train: error: .*No space left on device.*; finished episodes are kept, go on with .* --resume run\n"
    assert stopped.returncode == 2 and re.search(said, stopped.stderr)
    kept = rows(small_disk / "run")
    subprocess.run(["mount", "-o", "remount,size=8m", str(small_disk)], check=True)
    finished = run("sarah-train", "--resume", "run", cwd=small_disk)
    assert finished.returncode == 0, finished.stderr
    assert {name: (small_disk / "run" / name).read_bytes() for name in RECORDS} == expected
    assert set(kept[:-1]) <= set(rows(small_disk / "run"))  # the last one may be half a row


@pytest.fixture
def handlers() -> Iterator[None]:
    """Ctrl-C has its usual effect, SIGTERM none, and afterwards both are as before."""
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


def test_the_first_ctrl_c_is_noted_and_the_second_stops(handlers: None, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="130"), interruptible("sarah-train", "episode", "go on") as interrupted:
        os.kill(os.getpid(), signal.SIGTERM)
        assert not interrupted()  # whoever ignored it still does
        os.kill(os.getpid(), signal.SIGINT)
        assert interrupted()
        os.kill(os.getpid(), signal.SIGINT)
        raise AssertionError("the second has no effect")
    assert capsys.readouterr().err == "\nsarah-train: interrupted; go on\n"
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


@pytest.mark.parametrize(
    ("error", "kind", "message"),
    [
        (OSError("disk full"), RunFolderError, "disk full; finished windows are kept, go on"),
        (ResumeError("other settings"), ResumeError, "other settings"),
    ],
)
def test_a_mistake_says_how_to_go_on_if_it_can(error: Exception, kind: type[Exception], message: str) -> None:
    with pytest.raises(kind, match=f"^{message}$"), interruptible("sarah-operate", "window", "go on"):
        raise error
