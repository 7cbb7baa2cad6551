"""Whole commands that are killed, interrupted, locked out, or run out of disk: nothing finished is lost."""

import os
import re
import shlex
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from terminal import COARSE, run

BIN = Path(sys.executable).parent
# Long enough to be interrupted three times also where the test itself has to wait for the processor.
TRAINING = ("--episodes", "60", "--slots", "2", "--out", "run", "--episode.time-limit", "2", *COARSE)
RECORDS = ("episodes.csv", "recommendations.csv", "progress.csv", "parameters.json")


def begin(folder: Path, *arguments: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [BIN / "sarah-train", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=folder,
        start_new_session=True,
        # Whoever starts the tests in the background may have switched Ctrl-C off, and programs inherit that.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )


def wait_for_rows(process: subprocess.Popen[str], folder: Path, count: int) -> None:
    """Until so many rows are in the journal."""
    while process.poll() is None:
        if (folder / "journal.jsonl").exists() and (folder / "journal.jsonl").read_bytes().count(b"\n") >= count:
            return
        time.sleep(0.01)
    raise AssertionError(process.communicate())


def rows(folder: Path) -> list[bytes]:
    return (folder / "journal.jsonl").read_bytes().splitlines()


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    folder = tmp_path_factory.mktemp("expected")
    finished = run("sarah-train", *TRAINING, cwd=folder)
    assert finished.returncode == 0, finished.stderr
    return {name: (folder / "run" / name).read_bytes() for name in RECORDS}


def test_killed_locked_stopped_and_resumed(expected: dict[str, bytes], tmp_path: Path) -> None:
    folder = tmp_path / "run"
    process = begin(tmp_path, *TRAINING)
    wait_for_rows(process, folder, 9)
    process.send_signal(signal.SIGSTOP)  # so that it is still there when the other has started
    intruder = run("sarah-train", "--resume", "run", cwd=tmp_path)
    assert intruder.returncode == 2 and "run folder run is in use by another training" in intruder.stderr
    assert intruder.stdout == ""  # it does not say that it resumes
    assert process.poll() is None
    process.kill()  # its lock dies with it
    process.communicate()
    kept = rows(folder)
    known = len((folder / "episodes.csv").read_text().splitlines()) - 1

    process = begin(tmp_path, "--resume", "run")
    wait_for_rows(process, folder, len(kept) + 1)
    process.terminate()
    shown, errors = process.communicate(timeout=400)
    assert (
        f"resuming the training of naf on stepping: 60 episodes, of which episodes.csv has {known}, into run" in shown
    )
    assert process.returncode == 128 + signal.SIGTERM and "Traceback" not in errors
    assert "sarah-train: interrupted; go on with sarah-train --resume run" in errors
    assert rows(folder)[: len(kept)] == kept
    kept = rows(folder)

    process = begin(tmp_path, "--resume", "run", "--workers", "2")
    wait_for_rows(process, folder, len(kept) + 1)
    os.killpg(process.pid, signal.SIGINT)  # as Ctrl-C does, to the workers too
    _, errors = process.communicate(timeout=400)
    assert process.returncode == 128 + signal.SIGINT and "Traceback" not in errors
    assert rows(folder)[: len(kept)] == kept

    (command,) = re.findall(r"go on with (sarah-train --resume \S+)", errors)
    finished = run(*shlex.split(command), cwd=tmp_path)
    assert finished.returncode == 0, finished.stderr
    assert {name: (folder / name).read_bytes() for name in RECORDS} == expected

    again = run("sarah-train", "--resume", "run", cwd=tmp_path)
    assert (again.returncode, again.stdout, again.stderr) == (
        0,
        "run is finished: to go on, add --episodes with more than its 60\n",
        "",
    )
    assert {name: (folder / name).read_bytes() for name in RECORDS} == expected


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of its own, with 80 kB."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=80k", "none", str(folder)], capture_output=True)
    if mounted.returncode:
        pytest.skip(f"no file system can be mounted here: {mounted.stderr.decode().strip()}")
    yield folder
    subprocess.run(["umount", "--lazy", str(folder)], check=True)


def test_a_full_disk_stops_the_training_and_space_lets_it_go_on(expected: dict[str, bytes], small_disk: Path) -> None:
    stopped = run("sarah-train", *TRAINING, cwd=small_disk)
    assert stopped.returncode == 2 and "Traceback" not in stopped.stderr
    said = r"sarah-train: error: .*No space left on device.*go on with sarah-train --resume run\n"
    assert re.search(said, stopped.stderr)
    kept = rows(small_disk / "run")
    subprocess.run(["mount", "-o", "remount,size=8m", str(small_disk)], check=True)
    finished = run("sarah-train", "--resume", "run", cwd=small_disk)
    assert finished.returncode == 0, finished.stderr
    assert {name: (small_disk / "run" / name).read_bytes() for name in RECORDS} == expected
    assert set(kept[:-1]) <= set(rows(small_disk / "run"))  # the last one may be half a row


def test_a_folder_that_cannot_be_written_is_one_line(small_disk: Path) -> None:
    subprocess.run(["mount", "-o", "remount,ro", str(small_disk)], check=True)
    refused = run("sarah-train", *TRAINING, cwd=small_disk)
    said = "sarah-train: error: cannot write run folder run: Read-only file system\n"
    assert (refused.returncode, refused.stderr) == (2, said)
    assert not list(small_disk.iterdir())
