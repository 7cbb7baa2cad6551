"""What is replaced is whole or as before; a long run leaves nothing open."""

import gc
from pathlib import Path

import psutil
import pytest

from sarah.episode.episode import simulate
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.files import replace_text, replacing
from sarah.simulation.physics import Physics


def test_a_file_keeps_its_content_until_the_new_one_is_complete(tmp_path: Path) -> None:
    path = tmp_path / "file"
    replace_text(path, "before")
    with replacing(path) as file:
        file.write(b"af")
        file.flush()
        assert path.read_text() == "before"
        file.write(b"ter")
    assert path.read_text() == "after"
    with pytest.raises(OSError, match="disk full"), replacing(path) as file:
        file.write(b"half")
        raise OSError("disk full")
    assert path.read_text() == "after" and [found.name for found in tmp_path.iterdir()] == ["file"]


def test_two_writers_at_once_leave_one_whole_file(tmp_path: Path) -> None:
    path = tmp_path / "file"
    with replacing(path) as first:
        first.write(b"fir")
        with replacing(path) as second:
            second.write(b"second")
        assert path.read_text() == "second"
        first.write(b"st")
    assert path.read_text() == "first" and [found.name for found in tmp_path.iterdir()] == ["file"]


def test_memory_and_open_files_stay_flat() -> None:
    """A leaked world, 200 times, would be some 100 MB; `make endurance` goes on for longer."""
    config = EpisodeConfig(time_limit=1.02, physics=Physics(rate=50, solver_iterations=5, control_rate=50))

    def usage_after(episodes: int) -> tuple[int, int]:
        for seed in range(episodes):
            simulate(EpisodeSpec((1.0,) * 5, seed, config=config))
        gc.collect()
        return psutil.Process().memory_info().rss, psutil.Process().num_fds()

    memory, files = usage_after(60)
    later_memory, later_files = usage_after(200)
    assert later_files <= files and later_memory - memory < 8 * 2**20
