"""What is replaced is whole or as before; a long run leaves nothing open."""

import gc
import os
import shlex
from collections.abc import Callable
from pathlib import Path

import psutil
import pytest
from matplotlib.figure import Figure

from sarah.episode.episode import simulate
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.workers import Workers
from sarah.errors import ConfigurationError
from sarah.files import check_file, make_folder, quoted, replace_text, replacing
from sarah.pictures.style import save
from sarah.pictures.video import write_video
from sarah.reports.report import write_report
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.runs.run_record import RunRecord
from sarah.runs.session import SessionSpec
from sarah.runs.session_folder import SessionFolder
from sarah.simulation.physics import Physics


def test_a_file_keeps_its_content_until_the_new_one_is_complete(tmp_path: Path) -> None:
    path = tmp_path / "file"
    replace_text(path, "before")
    with replacing(path) as file:
        file.write(b"af")
        file.flush()
        assert path.read_text() == "before"
        file.write(b"ter")
    with pytest.raises(OSError, match="disk full"), replacing(path) as file:
        file.write(b"half")
        raise OSError("disk full")
    assert path.read_text() == "after"
    with replacing(path) as first:
        first.write(b"fir")
        with replacing(path) as second:  # of another process, say
            second.write(b"second")
        assert path.read_text() == "second"
        first.write(b"st")
    assert path.read_text() == "first" and [found.name for found in tmp_path.iterdir()] == ["file"]


@pytest.mark.parametrize("name", ["-x", "[x]*?", "%d $HOME 'a' \"b\"", "é👩\u200d🚀e\u0301", "a" * 255])
def test_any_name_of_a_file_works_that_is_a_line_of_text(name: str, tmp_path: Path) -> None:
    check_file(tmp_path / name)
    replace_text(tmp_path / name, "text")
    assert [path.name for path in tmp_path.iterdir()] == [name] and (tmp_path / name).read_text() == "text"
    make_folder(tmp_path / "folder" / name)
    assert shlex.split(quoted(name)) == [f"./{name}" if name == "-x" else name]


@pytest.mark.parametrize("name", [os.fsdecode(b"caf\xe9"), "a\nb", "a\u2028b", "a\0"])
def test_other_names_are_refused_before_anything_is_made(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    making: list[Callable[[], object]] = [
        lambda: check_file(path),
        lambda: make_folder(path),
        lambda: replace_text(path, "text"),
        lambda: RunFolder.create(path, TrainingConfig()),
        lambda: SessionFolder.create(path, SessionSpec()),
        lambda: write_video([], path.with_suffix(".gif")),
        lambda: save(Figure(), path),
        lambda: write_report(RunRecord(RunFolder(tmp_path)), path, Workers()),
    ]
    for make in making:
        with pytest.raises(ConfigurationError, match="a name must be UTF-8 text without control characters") as caught:
            make()
        assert str(caught.value).isprintable()
    assert not list(tmp_path.iterdir())


def test_a_report_that_cannot_be_written_is_refused_first(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    for name, words in ((".", "it is a folder"), ("file/b", "does not exist"), ("a" * 256, "too long")):
        with pytest.raises(ConfigurationError, match=f"cannot write .*: .*{words}"):
            write_report(RunRecord(RunFolder(tmp_path)), tmp_path / name, Workers())


def test_the_command_of_any_program_is_recorded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.argv", [os.fsdecode(b"/caf\xe9/sarah-train"), "é"])
    run = RunFolder.create(tmp_path / "run", TrainingConfig())
    assert (run.path / "command.txt").read_text() == "'/caf\\udce9/sarah-train' 'é'\n"


def test_memory_and_open_files_stay_flat() -> None:
    config = EpisodeConfig(time_limit=1.02, physics=Physics(rate=50, solver_iterations=5, control_rate=50))

    def usage_after(episodes: int) -> tuple[int, int]:
        for seed in range(episodes):
            simulate(EpisodeSpec((1.0,) * 5, seed, config=config))
        gc.collect()
        return psutil.Process().memory_info().rss, psutil.Process().num_fds()

    memory, files = usage_after(60)
    later_memory, later_files = usage_after(200)
    assert later_files < files + 20  # as other threads may open some
    assert later_memory - memory < 8 * 2**20
