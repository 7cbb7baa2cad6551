"""Videos of episodes."""

import sys
from dataclasses import replace
from pathlib import Path
from typing import cast

import numpy as np
import pytest
from imageio_ffmpeg import count_frames_and_secs
from laboratory import need, purple
from PIL import Image
from PIL.GifImagePlugin import GifImageFile

from sarah import BalanceConfig, EpisodeSpec, Push, simulate
from sarah.episode.trace import Trace
from sarah.errors import ConfigurationError
from sarah.pictures.video import GIF_SIZE, HEIGHT, WIDTH, check_path, frame_times, frames, write_video
from sarah.robot.description import describe_robot

PUSHED = BalanceConfig(time_limit=2.5, push=Push((100.0, 100.0), (180.0, 180.0), (1.5, 1.5)))


@pytest.fixture(scope="module")
def trace() -> Trace:
    result = simulate(EpisodeSpec((0.0, 0.0, 0.0, 0.0), 0, "balance", PUSHED), record_trace=True)
    return cast(Trace, result.trace)


def film(trace: Trace, *times: float, caption: str = "") -> list[np.ndarray]:
    need("pybullet")
    return [np.asarray(frame) for frame in frames(trace, describe_robot(), times, caption)]


def test_frames_show_robot_and_words(trace: Trace) -> None:
    first, later = film(trace, 1.0, 1.3)
    assert first.shape == later.shape == (HEIGHT, WIDTH, 3)
    assert (first != later).any(axis=-1).sum() > 1000
    dark = np.less(first, 60).all(axis=-1)
    assert dark[:, : WIDTH // 4].sum() > 1000  # what is written on the left
    rows, columns = np.nonzero((film(trace, 1.0, caption="seed 17")[0] != first).any(axis=-1))
    assert rows.min() > 0.9 * HEIGHT and columns.max() < WIDTH / 2


def test_a_score_that_nobody_knows_is_not_written(trace: Trace) -> None:
    ((known,), (unknown,)) = (film(one, 1.0) for one in (trace, replace(trace, score=np.full(len(trace), np.nan))))
    rows, columns = np.nonzero((known != unknown).any(axis=-1))
    assert len(rows) > 100 and columns.max() < WIDTH / 4
    assert not np.less(unknown[rows.min() : rows.max()], 140).all(axis=-1)[:, : WIDTH // 5].any()


def test_push_is_marked_while_it_acts_and_a_moment_longer(trace: Trace) -> None:
    before, during, after, long_after = (int(purple(picture).sum()) for picture in film(trace, 1.45, 1.55, 1.9, 2.3))
    assert before == long_after == 0 and during > 1000 and after > 1000


def test_speed_stretches_the_video_and_no_frame_is_past_the_end() -> None:
    times = frame_times(2.0, 3.0, 25.0)
    assert times[0] == 2.0 and times[-1] == pytest.approx(3.0) and len(times) == 26
    assert len(frame_times(2.0, 3.0, 25.0, speed=0.5)) == 51


def test_a_file_that_cannot_be_written_is_refused_first(monkeypatch: pytest.MonkeyPatch) -> None:
    for path, message in (("a.avi", "must end in .mp4 or .gif"), ("nowhere/a.gif", "folder nowhere does not exist")):
        with pytest.raises(ConfigurationError, match=message):
            check_path(Path(path))
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(ConfigurationError, match=r"pip install '\.\[video\]'"):
        check_path(Path("a.mp4"))
    check_path(Path("a.gif"))


@pytest.mark.parametrize("name", ["-x", "a:b/%d é", "a" * 251])
@pytest.mark.parametrize("suffix", [".mp4", ".gif"])
def test_any_name_of_a_film_is_that_of_its_file(
    name: str, suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    path = Path(name + suffix)
    path.parent.mkdir(exist_ok=True)
    check_path(path)
    shades = [Image.new("RGB", (WIDTH, HEIGHT), (shade, 0, 0)) for shade in range(0, 220, 20)]
    write_video(shades, path)
    assert [found.relative_to(tmp_path) for found in tmp_path.rglob("*") if found.is_file()] == [path]
    if suffix == ".mp4":
        assert count_frames_and_secs(tmp_path / path) == (11, pytest.approx(0.44, abs=0.05))
    else:
        with Image.open(path) as film:
            assert isinstance(film, GifImageFile)
            assert (film.size, film.n_frames, film.info["loop"]) == (GIF_SIZE, 11, 0)


def test_a_film_that_ffmpeg_has_not_written_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "film.mp4"
    path.write_bytes(b"of before")
    monkeypatch.setattr("imageio_ffmpeg.write_frames", lambda *_, **__: (None for _ in range(9)))
    with pytest.raises(ConfigurationError, match=r"film\.mp4: ffmpeg wrote 0 of 2 frames; the disk may be full"):
        write_video([Image.new("RGB", (WIDTH, HEIGHT))] * 2, path)
    assert path.read_bytes() == b"of before" and list(tmp_path.iterdir()) == [path]
