"""Trainings that benchmarks share: run once, kept in run folders."""

from __future__ import annotations

from pathlib import Path

from sarah.episode.workers import Workers
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.training.train import train


def learned(config: TrainingConfig, path: Path, workers: Workers) -> tuple[float, ...]:
    """What a training learned; it is run now unless its folder holds it.

    :param config: of the training
    :param path: of its run folder
    :param workers: that simulate
    """
    if not path.exists():
        return train(config, RunFolder.create(path, config), workers).parameters
    run = RunFolder.open(path)
    if run.config() != config:
        raise SystemExit(f"{path} is a training with other settings: name another folder with --runs")
    return run.parameters()
