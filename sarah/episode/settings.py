"""Settings that the episodes of every task have. Each stands where it has its effect."""

from __future__ import annotations

from dataclasses import dataclass

from sarah.episode.ending import EndingSettings
from sarah.episode.gait import GaitSettings
from sarah.episode.reward import RewardSettings


@dataclass(frozen=True)
class EpisodeConfig(GaitSettings, EndingSettings, RewardSettings):  # whose fields come from the last one on
    """Settings that all episodes of an experiment share, whatever the task."""
