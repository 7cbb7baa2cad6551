"""A short training in this process: the run folder it leaves, and that it repeats."""

import csv
import gc
import json
import math
import random
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from laboratory import COARSE_PHYSICS
from stable_baselines3 import DDPG, SAC, TD3
from stable_baselines3.common.base_class import BaseAlgorithm
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

from sarah.agents import LocalNAF
from sarah.episode.episode import simulate
from sarah.episode.evaluation import Evaluation, evaluate
from sarah.episode.result import METRICS, EpisodeResult
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import FIRST_TRAINING_SEED, EpisodeSpec
from sarah.episode.tasks import BALANCE, STEPPING, BalanceConfig
from sarah.errors import LearningError, RunFolderError
from sarah.recorded.folder import new_path
from sarah.runs.agent_settings import settings_of
from sarah.runs.config import OPTIMISERS, TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.training.optimisers import RandomSearch
from sarah.training.plan import Stage
from sarah.training.recommendation import Tried, merit
from sarah.training.train import SUMMARY_EPISODES, train

BRIEF = EpisodeConfig(time_limit=1.2, physics=COARSE_PHYSICS)
# Longer than the warm-up, on episodes of one second of stepping.
SHORT = TrainingConfig(episodes=16, slots=1, seed=3, episode=EpisodeConfig(time_limit=2.0, physics=COARSE_PHYSICS))


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> RunFolder:
    folder = RunFolder.create(tmp_path_factory.mktemp("runs") / "first", SHORT)
    train(SHORT, folder)
    return folder


def test_run_folder_holds_what_it_should(run: RunFolder) -> None:
    names = {path.name for path in run.path.iterdir()}
    expected = {
        "config.yaml",
        "command.txt",
        "versions.txt",
        "episodes.csv",
        "recommendations.csv",
        "progress.csv",
        "model.zip",
    }
    assert expected | {"parameters.json"} <= names
    assert any(name.startswith("events.out.tfevents") for name in names)
    assert run.config() == SHORT


def test_every_episode_has_its_row_and_can_be_repeated(run: RunFolder) -> None:
    rows = list(run.episodes())
    assert [int(row["index"]) for row in rows] == list(range(16))
    assert all(int(row["seed"]) >= FIRST_TRAINING_SEED for row in rows)
    row = rows[7]
    result = simulate(EpisodeSpec(parameters_of(row), int(row["seed"]), config=SHORT.episode))
    assert float(row["return"]) == result.episode_return
    assert (float(row["x"]), float(row["y"])) == result.final_position[:2]
    assert row["termination"] == result.termination


def parameters_of(row: dict[str, str]) -> tuple[float, ...]:
    return tuple(float(row[name]) for name in STEPPING.parameter_names)


def result_of(row: dict[str, str]) -> EpisodeResult:
    """What a row of ``episodes.csv`` says; the height at the end is not in it."""
    metrics = {name: float(row[name]) for name in METRICS if name in row}
    final_position = (float(row["x"]), float(row["y"]), 0.0)
    return EpisodeResult(row["termination"], final_position, episode_return=float(row["return"]), **metrics)


def test_what_would_be_recommended_is_noted_every_five_episodes(run: RunFolder) -> None:
    recommendations = list(run.recommendations())
    assert [int(row["episodes"]) for row in recommendations] == list(range(5, 16, 5))
    first, tried = recommendations[0], Tried(STEPPING)
    for row in list(run.episodes())[: int(first["episodes"])]:
        tried.append(parameters_of(row), merit(result_of(row)))
    assert parameters_of(first) == tried.best((1.0,) * 5)  # the agent's own choice until it has learned


def test_tensorboard_opens_on_score_and_parameters(run: RunFolder) -> None:
    """It sorts the groups of curves, and opens the first two."""
    events = EventAccumulator(str(run.path))
    events.Reload()
    curves = [tag.split("/") for tag in sorted(events.Tags()["scalars"])]
    first, second = list(dict.fromkeys(group for group, _ in curves))[:2]
    assert [name for group, name in curves if group == first] == ["score", "steps_per_second"]
    assert [name for group, name in curves if group == second] == list(STEPPING.parameter_names)


def test_tensorboard_shows_the_episodes_the_parameters_and_the_learning(run: RunFolder) -> None:
    events = EventAccumulator(str(run.path))
    events.Reload()
    expected = {f"episode/{name}" for name in ("score", "steps_per_second")}
    robot = ("x", "y", "duration", "shifts_by_sensors", "lifts_by_sensors", "sole_clearance", "vibration")
    expected |= {f"robot/{name}" for name in robot}
    expected |= {f"{group}/{name}" for group in ("parameters", "recommendation") for name in STEPPING.parameter_names}
    assert expected | {"train/return", "train/loss", "train/q", "train/exploration_std"} <= set(
        events.Tags()["scalars"]
    )
    assert [event.step for event in events.Scalars("episode/score")] == list(range(1, 17))


def test_progress_has_the_same_figures_as_the_episodes(run: RunFolder) -> None:
    with (run.path / "progress.csv").open() as file:
        progress = list(csv.DictReader(file))
    for row, episode in zip(progress, run.episodes(), strict=True):
        assert float(row["train/return"]) == pytest.approx(float(episode["return"]))
        assert float(row["parameters/P3"]) == pytest.approx(float(episode["P3"]))


def test_parameters_are_read_without_the_agent(run: RunFolder) -> None:
    content = json.loads((run.path / "parameters.json").read_text())
    assert tuple(content["parameters"]) == STEPPING.parameter_names
    assert content["task"] == "stepping" and content["algorithm"] == "naf" and content["episodes"] == 16
    assert tuple(content["parameters"].values()) == RunFolder.open(run.path).parameters()
    assert all(0.0 <= value <= 2.0 for value in run.parameters())


def test_model_loads_and_predicts(run: RunFolder) -> None:
    action, _ = LocalNAF.load(run.model_path).predict(np.zeros(16, dtype=np.float32), deterministic=True)
    assert action.shape == (5,)


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
    episode = BalanceConfig(time_limit=2.0, stepping=stepping)
    config = TrainingConfig(task="balance", episodes=16, slots=1, episode=episode)
    run = RunFolder.create(tmp_path / "run", config)
    learned = train(config, run)
    first, *_, row = run.episodes()
    assert all(float(first[name]) == 0.0 for name in BALANCE.parameter_names)
    parameters = tuple(float(row[name]) for name in BALANCE.parameter_names)
    assert (
        float(row["return"]) == simulate(EpisodeSpec(parameters, int(row["seed"]), "balance", episode)).episode_return
    )
    assert RunFolder.open(run.path).parameters() == learned.parameters and len(learned.parameters) == 4
    content = json.loads((run.path / "parameters.json").read_text())
    assert content["stepping"] == list(stepping) and content["baseline"]["survival_rate"] == 1.0
    assert BALANCE.neutral is not None
    assert content["baseline"] == evaluate("balance", BALANCE.neutral, episode, range(SUMMARY_EPISODES)).summary()
    assert LocalNAF.load(run.model_path).action_space.shape == (4,)


@pytest.mark.parametrize(("algo", "algorithm"), [("td3", TD3), ("sac", SAC), ("ddpg", DDPG)])
def test_other_algorithms_run_the_same_path(algo: str, algorithm: type[BaseAlgorithm], tmp_path: Path) -> None:
    agent = settings_of(algo)(learning_starts=6)  # type: ignore[call-arg]  # of a learner
    config = TrainingConfig(algo=algo, episodes=12, slots=1, agent=agent, episode=BRIEF)
    run = RunFolder.create(tmp_path / algo, config)
    learned = train(config, run)
    assert isinstance(algorithm.load(run.model_path), algorithm)
    assert len(list(run.episodes())) == 12 and len(learned.parameters) == 5
    assert math.isfinite(learned.evaluation.mean("score"))


@pytest.mark.parametrize("algo", OPTIMISERS)
def test_optimisers_write_the_same_run_folder(algo: str, tmp_path: Path) -> None:
    config = TrainingConfig(algo=algo, episodes=20, slots=3, episode=BRIEF)
    run = RunFolder.create(tmp_path / algo, config)
    learned = train(config, run)
    assert len(list(run.episodes())) == 20 and len({row["seed"] for row in run.episodes()}) == 20
    assert RunFolder.open(run.path).parameters() == learned.parameters
    assert (run.path / "progress.csv").is_file() and not run.model_path.exists()


def test_budget_is_kept_with_episodes_in_flight(tmp_path: Path) -> None:
    config = TrainingConfig(episodes=5, slots=2, episode=BRIEF)
    run = RunFolder.create(tmp_path / "run", config)
    train(config, run)
    rows = list(run.episodes())
    assert len(rows) == 5 and len({row["seed"] for row in rows}) == 5


def test_trainings_of_neighbouring_seeds_share_no_episode(tmp_path: Path) -> None:
    seeds = []
    for seed in (0, 1):
        config = TrainingConfig(episodes=6, slots=2, seed=seed, episode=BRIEF)
        run = RunFolder.create(tmp_path / str(seed), config)
        train(config, run)
        seeds += [row["seed"] for row in run.episodes()]
    assert len(set(seeds)) == len(seeds) == 12


def test_what_is_recommended_has_been_tried_within_the_budget(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Stage, "trials", 2)
    config = TrainingConfig(episodes=16, slots=1, episode=SHORT.episode)
    run = RunFolder.create(tmp_path / "run", config)
    parameters = train(config, run).parameters
    rows = list(run.episodes())
    assert len(rows) == 16
    trials = rows[6:11], rows[11:]
    first, second = ([row["seed"] for row in trial] for trial in trials)
    assert first == second and len(set(first)) == 5
    assert [parameters] * 5 in [list(map(parameters_of, trial)) for trial in trials]


def test_what_fails_its_trial_is_replaced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Stage, "trials", 2)
    verdicts = iter((["no valid gait"], []))
    monkeypatch.setattr(Evaluation, "shortcomings", lambda *judged: next(verdicts))
    run = RunFolder.create(tmp_path / "run", TrainingConfig(episodes=16, slots=1, episode=SHORT.episode))
    parameters = train(run.config(), run).parameters
    first, second = (parameters_of(list(run.episodes())[index]) for index in (6, 11))
    assert parameters == second and math.dist(first, second) >= 0.1 * 2.0


def test_run_folder_that_is_not_empty_is_refused_and_left_alone(tmp_path: Path) -> None:
    (tmp_path / "precious.txt").write_text("data")
    with pytest.raises(RunFolderError, match="is not empty"):
        RunFolder.create(tmp_path, SHORT)
    assert [path.name for path in tmp_path.iterdir()] == ["precious.txt"]


def test_run_folders_number_themselves(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert new_path("stepping", "naf-s3") == Path("runs/stepping/naf-s3")
    assert new_path("stepping", "naf-s3") == Path("runs/stepping/naf-s3-2")


def test_folders_without_a_finished_training_are_refused(tmp_path: Path) -> None:
    with pytest.raises(RunFolderError, match="does not exist"):
        RunFolder.open(tmp_path / "nowhere")
    RunFolder.create(tmp_path / "begun", SHORT)
    with pytest.raises(RunFolderError, match=r"no parameters.json"):
        RunFolder.open(tmp_path / "begun")


@pytest.mark.parametrize(
    "content",
    ["{", "[]", "{}", '{"parameters": {"P1": 1}}', '{"parameters": {"P1": "x", "P2": 1, "P3": 1, "P4": 1, "P5": 1}}'],
)
def test_spoilt_parameters_are_named(tmp_path: Path, content: str) -> None:
    run = RunFolder.create(tmp_path / "run", SHORT)
    (run.path / "parameters.json").write_text(content)
    with pytest.raises(RunFolderError, match=r"parameters.json does not hold learned parameters"):
        run.parameters()


def test_parameters_are_read_by_name_whatever_their_order(tmp_path: Path) -> None:
    run = RunFolder.create(tmp_path / "run", SHORT)
    run.write_parameters({"parameters": {"P5": 0.5, "P2": 0.2, "P1": 0.1, "P4": 0.4, "P3": 0.3}})
    assert run.parameters() == (0.1, 0.2, 0.3, 0.4, 0.5)


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (ValueError("the loss is nan,\nalas"), "ValueError: the loss is nan, alas"),
        (np.linalg.LinAlgError("singular"), "LinAlgError: singular"),
        (AssertionError(), "AssertionError"),
    ],
)
def test_what_an_algorithm_fails_at_is_one_line(
    error: Exception, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise error

    config = replace(SHORT, algo="random", agent=settings_of("random")())
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
