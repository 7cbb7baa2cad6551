"""Commands as tests run them, from another folder: in this process, or in one of their own."""

import io
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from importlib import import_module
from pathlib import Path

from sarah.runs.config import TrainingConfig
from sarah.simulation.engines import is_installed

BIN = Path(sys.executable).parent
COARSE = ("--episode.physics.rate", "100", "--episode.physics.solver-iterations", "5")
"""Options of physics that takes a fifth of the time, for tests that do not look at the robot."""
SHORT = ("--episode.time-limit", "1.5", *COARSE, "--slots", "1")
"""Options of a training whose episodes are as short as can be."""

WITHOUT_PYBULLET = "PyBullet is not installed, so MuJoCo simulates\n"
"""Line of commands that simulate where that is so; :func:`run` leaves it out."""

Answer = Callable[[str], str]
"""Function that runs a command line which is refused, and returns its message."""
Begin = Callable[[str], TrainingConfig]
"""Function that returns the settings of the training which a command line begins."""
Trained = tuple[Path, subprocess.CompletedProcess[str]]
"""Run folder of a training, and its process."""


def run(command: str, *arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    """Run a command in this process, which has its imports already: that takes a process of its own seconds."""
    out, err, words = io.StringIO(), io.StringIO(), [str(BIN / command), *map(str, arguments)]
    with _typed(words, cwd), redirect_stdout(out), redirect_stderr(err):
        try:
            import_module(f"sarah.cli.{command.removeprefix('sarah-')}").main()
            code = 0
        except SystemExit as ended:
            code = int(ended.code or 0)
    said = err.getvalue().replace(WITHOUT_PYBULLET, "", 0 if is_installed("pybullet") else 1)
    return subprocess.CompletedProcess(words, code, out.getvalue(), said)


def done(command: str, *arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    process = run(command, *arguments, cwd=cwd)
    assert process.returncode == 0, process.stderr
    return process


@contextmanager
def _typed(words: list[str], folder: Path) -> Iterator[None]:
    """Context in which this process has the arguments and the working folder of a command."""
    before, sys.argv = (sys.argv, Path.cwd()), words
    os.chdir(folder)
    try:
        yield
    finally:
        sys.argv = before[0]
        os.chdir(before[1])


def tree(folder: Path) -> dict[str, bytes]:
    return {str(path): path.read_bytes() if path.is_file() else b"" for path in sorted(folder.rglob("*"))}
