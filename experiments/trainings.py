"""The trainings that several experiments take parameters from: run once, and kept in run folders."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import sarah
from experiments.experiment import TRAINING, Experiment
from sarah.cli.training_defaults import default_training
from sarah.episode.settings import EpisodeConfig
from sarah.episode.tasks import TASKS
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.engines import Engine
from sarah.training.train import train
from sarah.versions import source_hash, versions

SARAH = Path(sarah.__file__).parent
CODE = (".py", ".xacro")
"""Endings of the names of files that decide what a training makes of its settings."""
EPISODES: dict[str, EpisodeConfig] = {name: default_training(task).episode for name, task in TASKS.items()}
"""Settings of the trainings' episodes, by task: those of ``sarah-train``."""


@dataclass(frozen=True, kw_only=True)
class TrainingExperiment(Experiment):
    """Options of an experiment that takes what trainings have learned."""

    depends_on: ClassVar[tuple[str, ...]] = TRAINING
    runs: Path = Path("runs/experiments")  # folder that keeps the trainings; one that is there is not run again
    time_limit: float | None = None  # time limit of their episodes, in s; by default 30 s, and 10 s with pushes

    def episode(self, task: str, engine: Engine = "pybullet") -> EpisodeConfig:
        """Settings of the trainings' episodes."""
        limit = self.time_limit or EPISODES[task].time_limit
        return dataclasses.replace(EPISODES[task], engine=engine, time_limit=limit)

    def training(self, task: str, episode: EpisodeConfig, episodes: int, **changes: Any) -> TrainingConfig:
        """Settings of a training, as those of ``sarah-train``."""
        return dataclasses.replace(default_training(TASKS[task]), episode=episode, episodes=episodes, **changes)

    def trained(self, config: TrainingConfig) -> RunFolder:
        """The run folder of a finished training, which this process runs, or resumes, unless it is there."""
        name = f"{config.task.name}-{config.algo}-{config.episodes}-s{config.seed}-{identity(config, TRAINING)}"
        path = self.runs / name
        run = RunFolder.open(path, unfinished=True) if path.exists() else RunFolder.create(path, config)
        if not run.is_finished:
            train(config, run)
        return run


def identity(settings: object, folders: Sequence[str] = (".",)) -> str:
    """Name for a folder of trainings or outcomes with these settings, made with this code and these versions.

    :param settings: settings that say all that is taken from the shipped parameters
    :param folders: folders of the project that decide the outcomes; by default the whole package
    """
    sources = [source_hash(SARAH / name, CODE) for name in sorted(Path(folder).name for folder in folders)]
    values = json.dumps([repr(settings), versions() | {"sarah-sources": sources}])
    return hashlib.sha256(values.encode()).hexdigest()[:12]
