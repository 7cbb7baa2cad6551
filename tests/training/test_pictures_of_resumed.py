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
    (events,) = run.path.glob("events.out.tfevents.*")
    curves = EventAccumulator(str(events), size_guidance={"images": 0})
    curves.Reload()
    return [(event.step, event.encoded_image_string) for event in curves.Images("recommendation/cycle")]


def test_a_resumed_training_keeps_its_pictures_and_draws_on(artist: Artist, tmp_path: Path) -> None:
    config = TrainingConfig(algo="random", episodes=10, slots=1, episode=EPISODE, pictures=2)
    run = interrupted(tmp_path / "run", config, 5)
    assert artist.drawn == len(pictures(run)) == 2
    train(run.config(), run)
    assert artist.drawn == 5
    assert pictures(run) == [(2 * number, b"picture %d" % number) for number in (1, 2, 3, 4, 5)]


def test_pictures_that_were_lost_are_drawn_again(artist: Artist, tmp_path: Path) -> None:
    config = TrainingConfig(algo="random", episodes=10, slots=1, episode=EPISODE, pictures=2)
    run = interrupted(tmp_path / "run", config, 3)
    (events,) = run.path.glob("events.out.tfevents.*")
    events.write_bytes(events.read_bytes()[:-60])
    train(run.config(), run)
    assert [step for step, _ in pictures(run)] == [2, 4, 6, 8, 10]
    assert pictures(run)[0] == (2, b"picture 1")


def rubbish(events: Path) -> None:
    events.write_bytes(b"rubbish" * 1000)


def gigabytes(events: Path) -> None:
    with events.open("wb") as file:
        file.truncate(20 * 2**30)


def fifo(events: Path) -> None:
    events.unlink()
    os.mkfifo(events)


@pytest.mark.parametrize("harm", [rubbish, gigabytes, fifo])
def test_a_hostile_file_of_curves_is_no_obstacle(harm: Callable[[Path], None], artist: Artist, tmp_path: Path) -> None:
    config = TrainingConfig(algo="random", episodes=10, slots=1, episode=EPISODE, pictures=2)
    run = interrupted(tmp_path / "run", config, 5)
    (events,) = run.path.glob("events.out.tfevents.*")
    harm(events)
    train(run.config(), run)
    assert artist.drawn == 2 + 5


@pytest.mark.parametrize(("before", "after", "steps"), [(5, 0, [5]), (0, 5, [5, 10]), (4, 5, [4, 5, 8, 10])])
def test_other_pictures_may_be_asked_for(
    before: int, after: int, steps: list[int], artist: Artist, tmp_path: Path
) -> None:
    config = TrainingConfig(algo="random", episodes=10, slots=1, episode=EPISODE, pictures=before)
    run = interrupted(tmp_path / "run", config, 8)
    train(dataclasses.replace(config, pictures=after), run)
    assert [step for step, _ in pictures(run)] == steps
