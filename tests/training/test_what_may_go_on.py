"""A training goes on only with the settings, code and versions that it was begun with, and keeps its pictures."""

import dataclasses
import logging
import os
import re
import shutil
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from interrupted import EPISODE, begun, content, go_on, interrupted
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator
from tensorboard.compat.proto.summary_pb2 import Summary

from sarah.errors import ResumeError
from sarah.pictures import gait_snapshot
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.training import train as training
from sarah.training.train import train
from sarah.versions import source_hash, versions

SHORT = TrainingConfig(algo="random", episodes=5, slots=1, episode=EPISODE)


@pytest.mark.parametrize(
    ("before", "after", "key"),
    [
        ("task: stepping", "task: balance", "task"),
        ("algo: random", "algo: tpe", "algo"),
        ("slots: 1", "slots: 2", "slots"),
        ("time_limit: 1.2", "time_limit: 1.201", "episode.time_limit"),
        ("  rate: 50", "  rate: 100", "episode.physics.rate"),
        ("thigh_length: 0.34", "thigh_length: 0.35", "episode.dimensions"),
        ("tau: 0.02", "tau: 0.03", "agent.tau"),
    ],
)
def test_every_setting_edited_in_turn_is_refused(before: str, after: str, key: str, tmp_path: Path) -> None:
    algo = "naf" if key.startswith("agent") else "random"
    episode = dataclasses.replace(EPISODE, dimensions={"thigh_length": 0.34})
    run = begun(tmp_path / "run", TrainingConfig(algo=algo, episodes=5, slots=1, episode=episode))
    text = run.config_text()
    run.specification_path.write_text(text.replace(before, after, 1))
    found = content(run)
    with pytest.raises(ResumeError, match=rf"run cannot be resumed: (.*; )?{key} is .* here, and .* in this training"):
        train(run.config(), run)
    assert content(run) == found and found["config.yaml"] != text.encode()
    run.specification_path.write_text(text.replace("pictures: 0", "pictures: 1"))
    with run.journal_of(run.config()):  # what changes no result may be another
        pass


def test_a_run_folder_says_with_what_it_was_begun(tmp_path: Path) -> None:
    run = RunFolder.create(tmp_path / "run", SHORT)
    assert run.versions() == versions() and run.versions()["sarah-sources"] == source_hash()
    (run.path / "versions.txt").write_text("torch 1.0\n")  # as of another installation, cut before its first episode
    go_on(run, 3)
    assert run.versions() == versions()


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (r'"index":\d+', b'"index":Infinity'),
        (r'"episode_return":[^,]+', b'"episode_return":1' + b"0" * 400),
        (r'"steps":[^,]+', b'"steps":true'),
        (r'"final_position":\[[^]]+\]', b'"final_position":[1.0]'),
        (r'"termination":"\w+"', b'"termination":"flown\\naway"'),
    ],
)
def test_rows_that_no_episode_writes_are_simulated_again(
    before: str, after: bytes, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """Also if somebody has computed their checksums."""
    run = interrupted(tmp_path / "run", SHORT)
    expected = list(run.episodes())
    caplog.set_level(logging.WARNING)  # which workers of other tests have changed
    first, row, *rows = run.journal_path.read_bytes().splitlines(keepends=True)
    text = re.sub(before.encode(), after.replace(b"\\", b"\\\\"), row.rstrip(b"\n").partition(b" ")[2], count=1)
    forged = b"%08x %s\n" % (zlib.crc32(text, int(first[:8], 16)), text)
    run.journal_path.write_bytes(b"".join([first, forged, *rows]))
    train(run.config(), run)
    assert list(run.episodes())[:3] == expected[:3] and "damaged rows: 1" in caplog.text


PACKAGE = Path(training.__file__).parents[1]


def test_the_hash_of_the_sources_tells_states_of_the_code_apart(tmp_path: Path) -> None:
    """But not how results are shown: a corrected label leaves trainings that go on, and workers, as they are."""

    def hash_of(change: Callable[[Path], object]) -> str:
        path = tmp_path / str(len(list(tmp_path.iterdir())))
        change(shutil.copytree(PACKAGE, path, ignore=shutil.ignore_patterns("__pycache__")))
        return source_hash(path)

    def edited(name: str) -> str:
        return hash_of(lambda copy: (copy / name).write_text((copy / name).read_text() + "\n"))

    for name in ("viewer/page.py", "reports/report.py", "pictures/style.py", "cli/train.py"):
        assert edited(name) == source_hash()
    assert hash_of(lambda copy: (copy / "notes.txt").write_text("no source")) == source_hash()
    names = ("control/hip_law.py", "agents/naf.py", "urdf/sarah.urdf.xacro", "episode/parameter_sets.json")
    moved = hash_of(lambda copy: (copy / "control" / "hip_law.py").rename(copy / "control" / "hips.py"))
    more = hash_of(lambda copy: (copy / "training" / "reports.py").write_text(""))
    assert len({source_hash(), *map(edited, names), moved, more}) == 7


CONFIG = TrainingConfig(algo="random", episodes=10, slots=1, episode=EPISODE, pictures=2)


class Artist:
    """Draws nothing, and remembers after how many drawings."""

    def __init__(self) -> None:
        self.drawn = 0

    def __call__(self, *_: Any) -> Summary:
        self.drawn += 1
        image = Summary.Image(width=1, height=1, colorspace=3, encoded_image_string=b"picture %d" % self.drawn)
        return Summary(value=[Summary.Value(tag="recommendation/cycle", image=image)])


@pytest.fixture
def artist(monkeypatch: pytest.MonkeyPatch) -> Artist:
    made = Artist()
    monkeypatch.setattr(gait_snapshot, "draw_gait", made)
    return made


def pictures(run: RunFolder) -> list[tuple[int, bytes]]:
    (events,) = run.event_files()
    curves = EventAccumulator(str(events), size_guidance={"images": 0})
    curves.Reload()
    return [(event.step, event.encoded_image_string) for event in curves.Images("recommendation/cycle")]


def test_a_resumed_training_keeps_its_pictures_and_draws_on(artist: Artist, tmp_path: Path) -> None:
    run = interrupted(tmp_path / "run", CONFIG, 5)
    assert artist.drawn == len(pictures(run)) == 2
    train(CONFIG, run)
    assert artist.drawn == 5
    assert pictures(run) == [(2 * number, b"picture %d" % number) for number in (1, 2, 3, 4, 5)]


def fifo(events: Path) -> None:
    events.unlink()
    os.mkfifo(events)


HARMS = (
    (lambda events: events.write_bytes(events.read_bytes().partition(b"picture 2")[0]), 1),
    (lambda events: events.write_bytes(b"rubbish" * 1000), 2),
    (lambda events: os.truncate(events, 20 * 2**30), 2),
    (fifo, 2),
)


@pytest.mark.parametrize(("harm", "lost"), HARMS)
def test_pictures_that_were_lost_are_drawn_again(harm: Any, lost: int, artist: Artist, tmp_path: Path) -> None:
    run = interrupted(tmp_path / "run", CONFIG, 5)
    harm(*run.event_files())
    train(CONFIG, run)
    assert [step for step, _ in pictures(run)] == [2, 4, 6, 8, 10] and artist.drawn == 5 + lost


@pytest.mark.parametrize(("before", "after", "steps"), [(5, 0, [5]), (0, 5, [5, 10]), (4, 5, [4, 5, 8, 10])])
def test_other_pictures_may_be_asked(before: int, after: int, steps: list[int], artist: Artist, tmp_path: Path) -> None:
    run = interrupted(tmp_path / "run", dataclasses.replace(CONFIG, pictures=before), 8)
    train(dataclasses.replace(CONFIG, pictures=after), run)
    assert [step for step, _ in pictures(run)] == steps
