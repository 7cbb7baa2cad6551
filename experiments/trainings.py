"""The trainings that several experiments take parameters from: run once, and kept in run folders."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import sarah
from experiments.experiment import TRAINING, Experiment
from sarah.cli.training_defaults import default_training
from sarah.episode.settings import EpisodeConfig
from sarah.episode.tasks import TASKS
from sarah.episode.workers import Executor
from sarah.files import replace_text
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.engines import Engine
from sarah.training.train import train
from sarah.versions import source_hash, versions

SARAH = Path(sarah.__file__).parent
CODE = (".py", ".xacro")
"""Endings of the names of files that decide what a training makes of its settings."""
TRAINING_CODE = (
    *("agents", "control", "envs", "episode", "recorded", "robot"),
    *("runs", "scenery", "simulation", "training", "urdf"),
)
"""Parts of sarah that a training depends on."""
EPISODES: dict[str, EpisodeConfig] = {name: default_training(task).episode for name, task in TASKS.items()}
"""Settings of the trainings' episodes, by task: those of ``sarah-train``."""


@dataclass(frozen=True, kw_only=True)
class TrainingExperiment(Experiment):
    """Options of an experiment that takes what trainings have learned.

    :param runs: folder that keeps the trainings; one that is there is not run again
    :param time_limit: time limit of the trainings' episodes, in s; by default 30 s, and 10 s with pushes
    """

    depends_on: ClassVar[tuple[str, ...]] = TRAINING
    runs: Path = Path("runs/experiments")
    time_limit: float | None = None

    def episode(self, task: str, engine: Engine = "pybullet") -> EpisodeConfig:
        """Settings of the trainings' episodes.

        :param task: name of the task
        :param engine: physics engine
        """
        limit = self.time_limit or EPISODES[task].time_limit
        return dataclasses.replace(EPISODES[task], engine=engine, time_limit=limit)

    def trained(self, config: TrainingConfig, workers: Executor | None = None) -> RunFolder:
        """The run folder of a finished training; it is run, or resumed, unless it is there.

        :param config: settings of the training
        :param workers: who simulates; by default this process does
        """
        name = f"{config.task.name}-{config.algo}-{config.episodes}-s{config.seed}-{identity(config, TRAINING_CODE)}"
        path = self.runs / name
        run = RunFolder.open(path, unfinished=True) if path.exists() else RunFolder.create(path, config)
        if not run.is_finished:
            train(config, run, workers)
        return run


def kept(file: Path, make: Callable[..., Any], *arguments: Any) -> Any:
    """What a function returns, from a file if it is there.

    :param file: file that keeps it, as JSON
    :param make: function whose result JSON can hold
    :param arguments: its arguments
    """
    if not file.exists():
        file.parent.mkdir(parents=True, exist_ok=True)
        replace_text(file, json.dumps(make(*arguments)))
    return json.loads(file.read_text(encoding="utf-8"))


def identity(settings: object, packages: Sequence[str] = (".",)) -> str:
    """Name for a folder of trainings or outcomes with these settings, made with this code and these versions.

    :param settings: settings of the trainings, which say all that these take from the shipped parameters
    :param packages: names of the parts of sarah that the trainings depend on; by default those of any result
    """
    sources = [source_hash(SARAH / name, CODE) for name in packages]
    values = json.dumps([repr(settings), versions() | {"sarah-sources": sources}])
    return hashlib.sha256(values.encode()).hexdigest()[:12]
