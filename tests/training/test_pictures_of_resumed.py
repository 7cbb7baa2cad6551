"""The pictures of a training that goes on."""

import dataclasses
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from interrupted import EPISODE, interrupted
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator
from tensorboard.compat.proto.summary_pb2 import Summary

from sarah.pictures import gait_snapshot
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.training.train import train

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


def cut(events: Path) -> None:
    events.write_bytes(events.read_bytes().partition(b"picture 2")[0])


def rubbish(events: Path) -> None:
    events.write_bytes(b"rubbish" * 1000)


def gigabytes(events: Path) -> None:
    with events.open("wb") as file:
        file.truncate(20 * 2**30)


def fifo(events: Path) -> None:
    events.unlink()
    os.mkfifo(events)


@pytest.mark.parametrize(("harm", "lost"), [(cut, 1), (rubbish, 2), (gigabytes, 2), (fifo, 2)])
def test_pictures_that_were_lost_are_drawn_again(
    harm: Callable[[Path], None], lost: int, artist: Artist, tmp_path: Path
) -> None:
    run = interrupted(tmp_path / "run", CONFIG, 5)
    harm(*run.event_files())
    train(CONFIG, run)
    assert [step for step, _ in pictures(run)] == [2, 4, 6, 8, 10] and artist.drawn == 5 + lost


@pytest.mark.parametrize(("before", "after", "steps"), [(5, 0, [5]), (0, 5, [5, 10]), (4, 5, [4, 5, 8, 10])])
def test_other_pictures_may_be_asked_for(
    before: int, after: int, steps: list[int], artist: Artist, tmp_path: Path
) -> None:
    run = interrupted(tmp_path / "run", dataclasses.replace(CONFIG, pictures=before), 8)
    train(dataclasses.replace(CONFIG, pictures=after), run)
    assert [step for step, _ in pictures(run)] == steps
