"""Commands that are interrupted, locked out, out of disk, or read by nobody: nothing finished is lost."""

import os
import re
import shlex
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from terminal import BIN, COARSE, done, run

from sarah.cli.interruption import interruptible
from sarah.errors import ResumeError, RunFolderError

# Long enough to be interrupted also where the test itself has to wait for the processor.
OPTIONS = ("--algo", "random", "--episodes", "60", "--slots", "2", "--episode.time-limit", "2")
TRAINING = (*OPTIONS, *COARSE, "--out", "run")
RECORDS = ("episodes.csv", "recommendations.csv", "progress.csv", "parameters.json")


def begin(folder: Path, *arguments: str) -> subprocess.Popen[str]:
    shown: dict[str, Any] = dict(stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    # Whoever starts the tests in the background may have switched Ctrl-C off, and programs inherit that.
    shown["preexec_fn"] = lambda: signal.signal(signal.SIGINT, signal.default_int_handler)
    return subprocess.Popen([BIN / "sarah-train", *arguments], cwd=folder, **shown)


def rows(folder: Path) -> list[bytes]:
    journal = folder / "journal.jsonl"
    return journal.read_bytes().splitlines() if journal.exists() else []


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    folder = tmp_path_factory.mktemp("expected")
    done("sarah-train", *TRAINING, cwd=folder)
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

    finished = done(*shlex.split(command), cwd=tmp_path)
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
    done("sarah-train", "--resume", "run", cwd=small_disk)
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


def test_a_mistake_says_how_to_go_on_if_it_can() -> None:
    said = r"^disk full; finished windows are kept, go on$"
    with pytest.raises(RunFolderError, match=said), interruptible("sarah-operate", "window", "go on"):
        raise OSError("disk full")
    with pytest.raises(ResumeError, match=r"^other settings$"), interruptible("sarah-operate", "window", "go on"):
        raise ResumeError("other settings")


EVALUATION = "sarah-eval 0.4,1.3,0.1,1,1 --episodes 1 --episode.time-limit 1.5"
SHELL = {"closed": '"$@" <&- >&- 2>&-', "full": '"$@" > /dev/full 2>&1', "left": '"$@" >&"$0" 2>&"$0"'}


STATUS = {
    **{("sarah-describe", "closed"): 0, ("sarah-describe", "left"): 0, ("sarah-eval nonsense", "left"): 2},
    **{(EVALUATION, "closed"): 0, (EVALUATION, "left"): 141, (f"{EVALUATION} --json", "full"): 2},
    ("sarah-eval --help", "left"): 141,
}


@pytest.mark.parametrize(("line", "streams"), STATUS)
def test_work_is_done_or_the_status_says_so(line: str, streams: str, tmp_path: Path) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    command = ["bash", "-c", SHELL[streams], str(writer), *line.split()]
    environment = {**os.environ, "PATH": f"{BIN}{os.pathsep}{os.environ['PATH']}"}
    with os.fdopen(writer, "wb"):
        process = subprocess.run(command, cwd=tmp_path, env=environment, pass_fds=[writer], timeout=300)
    assert process.returncode == STATUS[line, streams]
    assert (tmp_path / "sarah_robot.png").exists() == (line == "sarah-describe")
