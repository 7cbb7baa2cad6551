"""Judging V1 to V4: conditions that all sets meet alike, and their outcomes, kept on the disk."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from experiments.experiment import EPISODE
from experiments.trainings import identity
from sarah.control.parameters import Parameters
from sarah.episode.evaluation import evaluate
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.files import replace_text

KEPT_TOGETHER = 20
"""Number of episodes after which their outcomes are kept: an interrupted judge goes on from there."""


@dataclass(frozen=True)
class Condition:
    """Episodes that sets of V1 to V4 are judged by."""

    name: str  # for people
    config: BalanceConfig
    first_seed: int  # seed of the first episode; the next ones follow
    episodes: int


@dataclass(frozen=True)
class Judge:
    """Outcomes of sets of V1 to V4. What the folder has is not simulated again."""

    folder: Path  # with a file for each condition and set

    def scores(self, parameters: Parameters, asked: Sequence[Condition]) -> np.ndarray:
        """Scores of V1 to V4 in all episodes, one condition after the other."""
        return np.concatenate([self.outcomes(parameters, condition)["score"] for condition in asked])

    def outcomes(self, parameters: Parameters, condition: Condition) -> dict[str, list[float]]:
        """Score of every episode, and 1 if the robot survived it; what is missing is simulated in this process."""
        file = self._file(parameters, condition)
        known: dict[str, list[float]] = {"score": [], "survived": []}
        if file.exists():
            known = json.loads(file.read_text(encoding="utf-8"))
        while (count := len(known["score"])) < condition.episodes:
            first, next_count = condition.first_seed + count, min(KEPT_TOGETHER, condition.episodes - count)
            found = evaluate(BALANCE, parameters, condition.config, range(first, first + next_count))
            known["score"] += [result.score for result in found.results]
            known["survived"] += [float(result.survived) for result in found.results]
            file.parent.mkdir(parents=True, exist_ok=True)
            replace_text(file, json.dumps(known))
        return {name: values[: condition.episodes] for name, values in known.items()}

    def _file(self, parameters: Parameters, condition: Condition) -> Path:
        """File of a set under a condition, in a folder whose name tells both the condition and the code."""
        code = identity((condition.config, condition.first_seed), EPISODE)
        folder = f"{condition.config.engine}, {condition.name}, {code}"
        return self.folder / folder / f"{', '.join(map(repr, parameters))}.json"
