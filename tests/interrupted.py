"""Short trainings, whole and interrupted."""

from collections.abc import Callable
from pathlib import Path

import pytest

from sarah.episode.settings import EpisodeConfig
from sarah.errors import TrainingInterruptedError
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.physics import Physics
from sarah.training.train import train

EPISODE = EpisodeConfig(time_limit=1.2, physics=Physics(rate=50, solver_iterations=5, control_rate=50))
"""Settings of an episode that costs next to nothing, for tests that do not look at the robot."""


def interrupted_after(results: int) -> Callable[[], bool]:
    """Function that asks to stop after some results, those from the journal included."""
    countdown = iter(range(results))
    return lambda: next(countdown, None) is None


def trained(path: Path, config: TrainingConfig) -> RunFolder:
    """The run folder of a finished training."""
    run = RunFolder.create(path, config)
    train(config, run)
    return run


def begun(path: Path, config: TrainingConfig) -> RunFolder:
    """The run folder of a training that nobody has simulated an episode of."""
    run = RunFolder.create(path, config)
    with run.journal_of(config):
        return run


def interrupted(path: Path, config: TrainingConfig, results: int = 3) -> RunFolder:
    run = RunFolder.create(path, config)
    go_on(run, results)
    return run


def go_on(run: RunFolder, results: int) -> None:
    with pytest.raises(TrainingInterruptedError):
        train(run.config(), run, interrupted=interrupted_after(results))


def content(run: RunFolder) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in run.path.iterdir()}
