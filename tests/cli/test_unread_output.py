"""Commands whose streams are closed, full, or read by nobody: the work is done, or the status says it is not."""

import os
import subprocess
from pathlib import Path

import pytest
from terminal import BIN

EVALUATION = "sarah-eval 0.4,1.3,0.1,1,1 --episodes 1 --episode.time-limit 1.5"
SHELL = {"closed": '"$@" <&- >&- 2>&-', "full": '"$@" > /dev/full 2>&1', "left": '"$@" >&"$0" 2>&"$0"'}


@pytest.mark.parametrize(
    ("line", "streams", "status"),
    [
        ("sarah-describe", "closed", 0),
        ("sarah-describe", "left", 0),
        (EVALUATION, "closed", 0),
        (EVALUATION, "left", 141),
        (f"{EVALUATION} --json", "full", 2),
        ("sarah-eval --help", "left", 141),
        ("sarah-eval nonsense", "left", 2),
    ],
)
def test_work_is_done_or_the_status_says_so(line: str, streams: str, status: int, tmp_path: Path) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    command = ["bash", "-c", SHELL[streams], str(writer), *line.split()]
    environment = {**os.environ, "PATH": f"{BIN}{os.pathsep}{os.environ['PATH']}"}
    with os.fdopen(writer, "wb"):
        process = subprocess.run(command, cwd=tmp_path, env=environment, pass_fds=[writer], timeout=300)
    assert process.returncode == status
    assert (tmp_path / "sarah_robot.png").exists() == (line == "sarah-describe")
