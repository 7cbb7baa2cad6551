"""Short trainings that are interrupted."""

from pathlib import Path

import pytest

from sarah.episode.settings import EpisodeConfig
from sarah.errors import TrainingInterruptedError
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.physics import Physics
from sarah.training.train import train

EPISODE = EpisodeConfig(
    time_limit=1.2, physics=Physics(rate=100, solver_iterations=5, control_rate=50), dimensions={"thigh_length": 0.34}
)
INTERRUPTED = 3
"""Number of episodes after which a training of these tests is interrupted."""


def begun(path: Path, config: TrainingConfig) -> RunFolder:
    """The run folder of a training that nobody has simulated an episode of."""
    run = RunFolder.create(path, config)
    with run.journal_of(config):
        return run


def interrupted(path: Path, config: TrainingConfig, episodes: int = INTERRUPTED) -> RunFolder:
    run = RunFolder.create(path, config)
    go_on(run, episodes)
    return run


def go_on(run: RunFolder, episodes: int) -> None:
    countdown = iter(range(episodes))
    with pytest.raises(TrainingInterruptedError):
        train(run.config(), run, interrupted=lambda: next(countdown, None) is None)


def content(run: RunFolder) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in run.path.iterdir()}
