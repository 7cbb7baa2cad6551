"""Settings that ``sarah-train`` and ``sarah-compare`` begin with, as ``make train`` and the experiments do.

The module imports nothing slow, because the commands import it first.
"""

from __future__ import annotations

import dataclasses
from typing import Any

from sarah.episode.push import Push
from sarah.episode.tasks import BALANCE, Task
from sarah.runs.agent_settings import NAFSettings
from sarah.runs.config import TrainingConfig

# Softer pushes hardly tell controllers apart, V3 answers those from front and back, and who falls does so soon.
BALANCE_TRAINING = TrainingConfig(
    BALANCE,
    episodes=300,
    agent=NAFSettings(preset="noisy"),  # the push decides more of a return than V1 to V4 do
    episode=dataclasses.replace(
        BALANCE.episode, push=Push(newtons=(100.0, 125.0), sagittal_share=0.5), time_limit=10.0
    ),
)
"""Settings from which V1 to V4 are learned."""


def default_training(task: Task[Any]) -> TrainingConfig:
    """Settings of a training for which no file and no option gives others.

    :param task: task to learn; any other than ``balance`` has its own settings
    """
    return BALANCE_TRAINING if task is BALANCE else TrainingConfig(task)
