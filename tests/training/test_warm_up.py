"""The random warm-up of a training: how long it is, and where it is said."""

import csv
import dataclasses
from pathlib import Path

import pytest
from interrupted import EPISODE
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

from sarah.episode.tasks import BALANCE
from sarah.runs.agent_settings import NAFSettings, TD3Settings
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.training.plan import plan_of
from sarah.training.train import train


@pytest.mark.parametrize(
    ("config", "words"),
    [
        (TrainingConfig(), "8 of the 100 episodes were random"),
        (TrainingConfig(algo="gp", slots=1), "5 of the 100 episodes were random"),
        (TrainingConfig(algo="td3", agent=TD3Settings(learning_starts=30)), "30 of the 100 episodes were random"),
        (TrainingConfig(episodes=8), "all 8 episodes: to learn takes more than 8"),
        (TrainingConfig(agent=NAFSettings(learning_starts=999)), "90 of the 100 episodes were random"),
        (TrainingConfig("balance", "td3"), "8 of the 100 episodes: the first neutral, the others random"),
        (
            TrainingConfig("balance"),
            "8 of the 100 episodes: the first neutral, the others random or around the best so far",
        ),
        (TrainingConfig(dataclasses.replace(BALANCE, neutral=(1.0,) * 4)), "8 of the 100 episodes were random"),
        (TrainingConfig(algo="cma-es"), "none"),
        (TrainingConfig(algo="random"), "none: every episode was random"),
    ],
)
def test_the_warm_up_is_said_in_words(config: TrainingConfig, words: str) -> None:
    assert plan_of(config).warm_up_words() == words


def test_curves_say_which_episodes_were_random(tmp_path: Path) -> None:
    """A noise that moves every learned action shows from which episode on the agent acts."""
    columns: list[list[str]] = []
    for noise in (0.0, 1.0):
        settings = TD3Settings(action_noise_std=noise)
        config = TrainingConfig(algo="td3", episodes=9, slots=2, agent=settings, episode=EPISODE)
        run = RunFolder.create(tmp_path / str(noise), config)
        train(config, run)
        columns.append([row["P1"] for row in run.episodes()])
        with (run.path / "progress.csv").open() as file:
            marks = [float(row["train/is_warm_up"]) for row in csv.DictReader(file)]
        warm_up = plan_of(config).start.warm_up
        assert marks == [1.0] * warm_up + [0.0] * (9 - warm_up)
        events = EventAccumulator(str(run.path)).Reload()
        assert [event.value for event in events.Scalars("train/is_warm_up")] == marks
    alike = [one == other for one, other in zip(*columns, strict=True)]
    assert alike == [mark == 1.0 for mark in marks]
