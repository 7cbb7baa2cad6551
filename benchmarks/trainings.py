"""Trainings that benchmarks share: run once, kept in run folders."""

from __future__ import annotations

from pathlib import Path

from sarah.config import TrainingConfig
from sarah.runs import RunFolder
from sarah.training import train


def learned(config: TrainingConfig, path: Path) -> tuple[float, ...]:
    """What a training learned; it is run now unless its folder holds it.

    :param config: of the training
    :param path: of its run folder
    """
    if not path.exists():
        return train(config, RunFolder.create(path, config)).parameters
    run = RunFolder.open(path)
    if run.config() != config:
        raise SystemExit(f"{path} is a training with other settings: name another folder with --runs")
    return run.parameters()
