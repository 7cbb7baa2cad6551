"""A short training in this process: the run folder it leaves, and that it repeats."""

import csv
import gc
import json
import math
import random
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from interrupted import EPISODE, trained
from laboratory import COARSE_PHYSICS
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

from sarah.agents import LocalNAF
from sarah.episode.episode import simulate
from sarah.episode.evaluation import Evaluation, evaluate
from sarah.episode.result import METRICS, EpisodeResult
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import FIRST_TRAINING_SEED, EpisodeSpec
from sarah.episode.tasks import BALANCE, STEPPING, BalanceConfig
from sarah.errors import LearningError
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.training.optimisers import RandomSearch
from sarah.training.plan import Stage
from sarah.training.recommendation import Tried, merit
from sarah.training.train import train

# Longer than the warm-up, on episodes of one second of stepping.
SHORT = TrainingConfig(episodes=16, slots=1, seed=3, episode=EpisodeConfig(time_limit=2.0, physics=COARSE_PHYSICS))


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> RunFolder:
    return trained(tmp_path_factory.mktemp("runs") / "first", SHORT)


def test_run_folder_holds_what_it_should(run: RunFolder) -> None:
    names = {path.name for path in run.path.iterdir()}
    tables = {"episodes.csv", "recommendations.csv", "progress.csv"}
    assert names >= {"config.yaml", "command.txt", "versions.txt", *tables, "model.zip", "parameters.json"}
    assert run.event_files() and run.config() == SHORT
    content = json.loads((run.path / "parameters.json").read_text())
    assert tuple(content["parameters"]) == STEPPING.parameter_names
    assert content["task"] == "stepping" and content["algorithm"] == "naf" and content["episodes"] == 16
    assert tuple(content["parameters"].values()) == RunFolder.open(run.path).parameters()
    action, _ = LocalNAF.load(run.model_path).predict(np.zeros(16, dtype=np.float32), deterministic=True)
    assert action.shape == (5,)


def test_every_episode_has_its_row_and_can_be_repeated(run: RunFolder) -> None:
    rows = list(run.episodes())
    assert [int(row["index"]) for row in rows] == list(range(16))
    assert all(int(row["seed"]) >= FIRST_TRAINING_SEED for row in rows)
    row = rows[7]
    result = simulate(EpisodeSpec(parameters_of(row), int(row["seed"]), config=SHORT.episode))
    assert float(row["return"]) == result.episode_return
    assert (float(row["x"]), float(row["y"])) == result.final_position[:2]
    assert row["termination"] == result.termination
    with (run.path / "progress.csv").open() as file:
        progress = list(csv.DictReader(file))
    for shown, row in zip(progress, rows, strict=True):
        assert float(shown["train/return"]) == pytest.approx(float(row["return"]))
        assert float(shown["parameters/P3"]) == pytest.approx(float(row["P3"]))
    names = [name for name in progress[0] if name.startswith(("episode/", "parameters/"))]
    assert names == sorted(names) and {"train/loss", "train/n_updates"} < progress[0].keys()


def parameters_of(row: dict[str, str]) -> tuple[float, ...]:
    return tuple(float(row[name]) for name in STEPPING.parameter_names)


def test_what_would_be_recommended_is_noted_every_five_episodes(run: RunFolder) -> None:
    recommendations = list(run.recommendations())
    assert [int(row["episodes"]) for row in recommendations] == list(range(5, 16, 5))
    first, tried = recommendations[0], Tried(STEPPING)
    for row in list(run.episodes())[: int(first["episodes"])]:
        metrics: Any = {name: float(row[name]) for name in METRICS if name in row}
        result = EpisodeResult(row["termination"], (0.0, 0.0, 0.0), episode_return=float(row["return"]), **metrics)
        tried.append(parameters_of(row), merit(result))
    assert parameters_of(first) == tried.best((1.0,) * 5)  # the agent's own choice until it has learned


def test_tensorboard_opens_on_scores_and_parameters(run: RunFolder) -> None:
    """It sorts the groups of curves, and opens the first two."""
    events = EventAccumulator(str(run.path)).Reload()
    curves = [tag.split("/") for tag in sorted(events.Tags()["scalars"])]
    first, second = list(dict.fromkeys(group for group, _ in curves))[:2]
    assert [name for group, name in curves if group == first] == ["score", "steps_per_second"]
    assert [name for group, name in curves if group == second] == list(STEPPING.parameter_names)
    robot = ("x", "y", "duration", "shifts_by_sensors", "lifts_by_sensors", "sole_clearance", "vibration")
    expected = {f"robot/{name}" for name in robot} | {f"recommendation/{name}" for name in STEPPING.parameter_names}
    assert {"/".join(curve) for curve in curves} >= {*expected, "train/return", "train/loss", "train/exploration_std"}
    assert [event.step for event in events.Scalars("episode/score")] == list(range(1, 17))


def test_training_repeats_from_its_seed_whatever_is_set(run: RunFolder, tmp_path: Path) -> None:
    """And what is set in the process, and its generators, are afterwards as before."""
    again = RunFolder.create(tmp_path / "again", SHORT)
    random.seed(7), np.random.seed(7), torch.manual_seed(7)
    expected = [random.random(), np.random.random(), torch.rand(()).item()]
    random.seed(7), np.random.seed(7), torch.manual_seed(7)
    torch.set_default_dtype(torch.float64)
    try:
        with np.errstate(all="raise"), torch.no_grad():
            train(SHORT, again, interrupted=lambda: np.random.seed(7) or False)  # what others do meanwhile
            assert np.geterr()["under"] == "raise" and not torch.is_grad_enabled()
        assert torch.get_default_dtype() == torch.float64
    finally:
        torch.set_default_dtype(torch.float32)
    assert [random.random(), np.random.random(), torch.rand(()).item()] == expected
    assert (again.path / "episodes.csv").read_bytes() == (run.path / "episodes.csv").read_bytes()
    assert again.parameters() == run.parameters()


def test_second_training_learns_v_with_the_legs_of_the_first(tmp_path: Path) -> None:
    stepping = (0.35, 0.6, 0.2, 1.0, 1.0)
    episode = BalanceConfig(time_limit=2.0, stepping=stepping, physics=COARSE_PHYSICS)
    config = TrainingConfig(task="balance", episodes=8, slots=2, episode=episode)
    run = RunFolder.create(tmp_path / "run", config)
    learned = train(config, run)
    *_, row = run.episodes()
    parameters = tuple(float(row[name]) for name in BALANCE.parameter_names)
    spec = EpisodeSpec(parameters, int(row["seed"]), "balance", episode)
    assert float(row["return"]) == simulate(spec).episode_return
    assert RunFolder.open(run.path).parameters() == learned.parameters and len(learned.parameters) == 4
    content = json.loads((run.path / "parameters.json").read_text())
    assert content["stepping"] == list(stepping) and content["baseline"]["survival_rate"] == 1.0
    assert BALANCE.neutral is not None
    assert content["baseline"] == evaluate("balance", BALANCE.neutral, episode, range(2)).summary()
    assert LocalNAF.load(run.model_path).action_space.shape == (4,)


def test_what_fails_its_trial_is_replaced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Stage, "trials", 2)
    verdicts = iter((["no valid gait"], []))
    monkeypatch.setattr(Evaluation, "shortcomings", lambda *judged: next(verdicts))
    run = RunFolder.create(tmp_path / "run", TrainingConfig(algo="random", episodes=16, slots=1, episode=EPISODE))
    parameters = train(run.config(), run).parameters
    first, second = (parameters_of(list(run.episodes())[index]) for index in (6, 11))
    assert parameters == second and math.dist(first, second) >= 0.1 * 2.0


FAILURES = {"ValueError: loss is nan, alas": ValueError("loss is nan,\nalas"), "AssertionError": AssertionError()}


@pytest.mark.parametrize(("words", "error"), FAILURES.items())
def test_what_an_algorithm_fails_at_is_one_line(error: Exception, words: str, tmp_path: Path, monkeypatch: Any) -> None:
    def fail(*_: object) -> None:
        raise error

    config = TrainingConfig(algo="random", episodes=3, episode=EPISODE)
    monkeypatch.setattr(RandomSearch, "tell", fail)
    run = RunFolder.create(tmp_path / "run", config)
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        with pytest.raises(LearningError, match=f"^random cannot go on: {words}$"):
            train(config, run)
        gc.collect()
    assert not said and not run.is_finished  # not even of files that are left open
    monkeypatch.undo()
    train(config, run)
    assert run.is_finished
