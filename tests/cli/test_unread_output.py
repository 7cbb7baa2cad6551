"""Commands whose streams are closed, full, or read by nobody: the work is done, or the status says it is not."""

import shlex
import subprocess
from pathlib import Path

import pytest
from terminal import SHORT, run

WORK = {
    "sarah-train --task stepping --algo random --episodes 2 --out made": "made/parameters.json",
    "sarah-operate {run} --learner random --minutes 0.1 --out made": "made/parameters.json",
    "sarah-compare --out made --algorithms random --seeds 1 --episodes 2 --evaluations 1": "made/race.pdf",
    "sarah-video {run} --out made.gif --seconds 1 1.1": "made.gif",
    "sarah-view {run} --out made.html": "made.html",
    "sarah-transfer {run} --episodes 1 --out made": "made/transfer.pdf",
    "sarah-figures {run} --out made": "made/figure_4_reward_and_frequency.pdf",
    "sarah-report {run} --episodes 1 --seconds 1 1.1 --out made.html": "made.html",
}
"""Short work of the commands, and the last file that it makes."""


@pytest.mark.parametrize("streams", ["closed", "full", "left"])
@pytest.mark.parametrize("line", WORK, ids=lambda text: text.split()[0])
def test_work_is_done_though_nobody_reads_what_is_said(
    line: str, streams: str, trained: tuple[Path, subprocess.CompletedProcess[str]], tmp_path: Path
) -> None:
    command, *arguments = shlex.split(line.format(run=trained[0]))
    settings = SHORT if command in ("sarah-train", "sarah-compare") else ()
    assert run(command, *arguments, *settings, cwd=tmp_path, streams=streams).returncode == 0
    assert (tmp_path / WORK[line]).stat().st_size


@pytest.mark.parametrize(
    ("line", "streams", "status"),
    [
        ("{run} --episodes 1", "closed", 0),
        ("{run} --episodes 1", "full", 2),
        ("{run} --episodes 1", "left", 141),
        ("{run} --episodes 1 --json", "full", 2),
        ("--help", "left", 141),
    ],
)
def test_text_that_was_asked_for_and_lost_is_a_failure(
    line: str, streams: str, status: int, trained: tuple[Path, subprocess.CompletedProcess[str]], tmp_path: Path
) -> None:
    arguments = shlex.split(line.format(run=trained[0]))
    assert run("sarah-eval", *arguments, cwd=tmp_path, streams=streams).returncode == status


def test_a_mistake_is_a_failure_though_nobody_reads_it(tmp_path: Path) -> None:
    assert run("sarah-eval", "nonsense", cwd=tmp_path, streams="left").returncode == 2
