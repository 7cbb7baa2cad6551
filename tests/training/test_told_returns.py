"""Optimisers are told returns without luck; the records keep the returns as they were."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from interrupted import EPISODE

from sarah.agents.corrections import corrected
from sarah.control.parameters import Parameters
from sarah.episode.episode import simulate
from sarah.episode.spec import EpisodeSpec
from sarah.episode.task_answers import disturbances_of
from sarah.episode.tasks import BALANCE
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.training.optimisers import OPTIMISERS, RandomSearch
from sarah.training.plan import Stage
from sarah.training.train import train


class Listening(RandomSearch):
    """Random search that notes what it is told."""

    told: list[float]

    def tell(self, parameters: Parameters, merit: float, fell: bool = False) -> None:
        self.told.append(merit)
        super().tell(parameters, merit, fell)


def test_each_return_is_corrected_by_what_is_known_then(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Stage, "trials", 1)
    monkeypatch.setattr(Listening, "told", [], raising=False)
    monkeypatch.setitem(OPTIMISERS, "random", Listening)
    config = TrainingConfig("balance", "random", 28, slots=3, episode=BALANCE.config_of(EPISODE))
    run = RunFolder.create(tmp_path / "run", config)
    train(config, run)
    specs = [spec_of(row, config) for row in run.episodes()][: len(Listening.told)]
    returns = np.array([simulate(spec).episode_return for spec in specs])
    assert [float(row["return"]) for row in run.episodes()][: len(specs)] == returns.tolist()
    disturbances = np.array([disturbances_of(spec) for spec in specs])
    expected = [corrected(returns[:end], disturbances[:end])[-1] for end in range(1, len(specs) + 1)]
    assert Listening.told == expected and (np.array(expected[19:]) != returns[19:]).any()


def spec_of(row: Any, config: TrainingConfig) -> EpisodeSpec:
    parameters = tuple(float(row[name]) for name in BALANCE.parameter_names)
    return EpisodeSpec(parameters, int(row["seed"]), BALANCE, config.episode)
