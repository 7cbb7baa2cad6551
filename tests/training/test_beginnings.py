"""Every algorithm begins alike: at the neutral parameters or evenly spread, on episodes of its own stream."""

import csv
import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from interrupted import EPISODE
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

from sarah.agents import corrections
from sarah.agents.corrections import corrected
from sarah.agents.even_warm_up import latin_hypercube
from sarah.control.parameters import Parameters
from sarah.envs.sarah_env import draw_seed
from sarah.episode.episode import simulate
from sarah.episode.spec import FIRST_TRAINING_SEED, EpisodeSpec
from sarah.episode.task_answers import disturbances_of
from sarah.episode.tasks import BALANCE, STEPPING, task_of_text
from sarah.episode.workers import Executor, Job, Workers, begin_episode
from sarah.errors import TaskError
from sarah.runs.agent_settings import NAFSettings, TD3Settings, settings_of
from sarah.runs.config import AGENTS, ALGORITHMS, TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.training.optimisers import OPTIMISERS, RandomSearch
from sarah.training.plan import WITHOUT_WARM_UP, Stage, plan_of, seeds_of
from sarah.training.train import simulated_episodes, train


class Recording(Executor):
    """Simulates in this process, and notes the episodes."""

    def __init__(self) -> None:
        self.specs: list[EpisodeSpec] = []

    def submit(self, function: Callable[..., Any], *subjects: Any) -> Job:
        if function is not begin_episode:
            self.specs.append(subjects[0])
        return Workers().submit(function, *subjects)


def trained(path: Path, config: TrainingConfig) -> tuple[RunFolder, np.ndarray, list[EpisodeSpec]]:
    """A training, the actions within -1 and 1 of its episodes, and all episodes that it has simulated."""
    run, recording = RunFolder.create(path, config), Recording()
    train(config, run, recording)
    box = config.task.box
    actions = [box.scaled([float(row[name]) for name in box.names]) for row in run.episodes()]
    return run, np.array(actions), recording.specs


@pytest.mark.parametrize("algo", ALGORITHMS)
def test_the_first_episode_of_every_algorithm_is_neutral(algo: str, tmp_path: Path) -> None:
    config = TrainingConfig("balance", algo, episodes=3, slots=1, episode=BALANCE.config_of(EPISODE))
    run, actions, _ = trained(tmp_path / "run", config)
    assert not actions[0].any() and actions[1].any()
    generator = np.random.default_rng(seeds_of(config.seed).episodes)
    assert [int(row["seed"]) for row in run.episodes()] == [draw_seed(generator) for _ in range(3)]


@pytest.mark.parametrize("algo", sorted(set(ALGORITHMS) - set(WITHOUT_WARM_UP)))
def test_the_warm_up_without_neutral_parameters_is_spread_evenly(algo: str, tmp_path: Path) -> None:
    """The score is near 0 where P1 is above 1. Five uniform draws may all be there."""
    config = TrainingConfig(algo=algo, episodes=6, slots=1, seed=114, episode=EPISODE)
    warm_up = trained(tmp_path / "run", config)[1][:5]
    assert np.sort(np.floor(2.5 * (warm_up + 1)), axis=0).T.tolist() == [[0, 1, 2, 3, 4]] * 5
    alike = latin_hypercube(5, 5, np.random.default_rng(seeds_of(config.seed).algorithm))
    np.testing.assert_allclose(warm_up, alike, atol=1e-6)


def test_the_warm_up_has_no_noise(tmp_path: Path) -> None:
    agent = settings_of("ddpg")(action_noise_std=2.0)  # type: ignore[call-arg]  # of a learner
    config = TrainingConfig(algo="ddpg", episodes=12, slots=1, agent=agent, episode=EPISODE)
    on_a_bound = np.isclose(np.abs(trained(tmp_path / "run", config)[1]), 1.0).any(axis=1)
    assert not on_a_bound[:5].any() and on_a_bound[5:].all()
    assert {settings_of(algo)().learning_starts for algo in AGENTS} == {5}  # type: ignore[attr-defined]


def test_a_training_has_a_seed_of_its_own_for_each_stream() -> None:
    seeds = [seed for training_seed in range(1000) for seed in seeds_of(training_seed)]
    assert len(set(seeds)) == len(seeds) == 4000 and max(seeds) < 2**31


def test_trials_come_before_any_seed_of_the_summary_is_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Stage, "trials", 2)
    config = TrainingConfig("balance", "random", episodes=16, slots=1, episode=BALANCE.config_of(EPISODE))
    _, _, specs = trained(tmp_path / "run", config)
    steering, summary = specs[:21], specs[21:]
    neutral, first, second = steering[6:11], steering[11:16], steering[16:]
    seeds = [[spec.seed for spec in specs] for specs in (neutral, first, second)]
    assert seeds[0] == seeds[1] == seeds[2] and len(set(seeds[0])) == 5
    assert {spec.parameters for spec in neutral} == {BALANCE.neutral}
    assert all(spec.seed >= FIRST_TRAINING_SEED for spec in steering)
    assert [spec.seed for spec in summary] == [0, 1, 0, 1]
    assert {spec.parameters for spec in first} | {spec.parameters for spec in second} > {summary[0].parameters}
    # Where no parameters are neutral, none are simulated
    config = TrainingConfig(algo="random", episodes=16, slots=1, episode=EPISODE)
    assert STEPPING.neutral is None and len(trained(tmp_path / "stepping", config)[2]) == 16 + 2


NEUTRAL = "8 of the 100 episodes: the first neutral, the others random"


@pytest.mark.parametrize(
    ("config", "words"),
    [
        (TrainingConfig(), "8 of the 100 episodes were random"),
        (TrainingConfig(algo="gp", slots=1), "5 of the 100 episodes were random"),
        (TrainingConfig(algo="td3", agent=TD3Settings(learning_starts=30)), "30 of the 100 episodes were random"),
        (TrainingConfig(episodes=8), "all 8 episodes: to learn takes more than 8"),
        (TrainingConfig(agent=NAFSettings(learning_starts=999)), "90 of the 100 episodes were random"),
        (TrainingConfig("balance", "td3"), NEUTRAL),
        (TrainingConfig("balance"), f"{NEUTRAL} or around the best so far"),
        (TrainingConfig(dataclasses.replace(BALANCE, neutral=(1.0,) * 4)), "8 of the 100 episodes were random"),
        (TrainingConfig(algo="cma-es"), "none"),
        (TrainingConfig(algo="random"), "none: every episode was random"),
    ],
)
def test_the_warm_up_is_said_in_words(config: TrainingConfig, words: str) -> None:
    assert plan_of(config).warm_up_words() == words


def test_curves_say_which_episodes_were_random(tmp_path: Path) -> None:
    """A noise that moves every learned action shows from which episode on the agent acts."""
    columns: list[list[str]] = []
    for noise in (0.0, 1.0):
        settings = TD3Settings(action_noise_std=noise)
        config = TrainingConfig(algo="td3", episodes=9, slots=2, agent=settings, episode=EPISODE)
        run = trained(tmp_path / str(noise), config)[0]
        columns.append([row["P1"] for row in run.episodes()])
        with (run.path / "progress.csv").open() as file:
            marks = [float(row["train/is_warm_up"]) for row in csv.DictReader(file)]
        warm_up = plan_of(config).start.warm_up
        assert marks == [1.0] * warm_up + [0.0] * (9 - warm_up)
        events = EventAccumulator(str(run.path)).Reload()
        assert [event.value for event in events.Scalars("train/is_warm_up")] == marks
    assert [one == other for one, other in zip(*columns, strict=True)] == [mark == 1.0 for mark in marks]


class Listening(RandomSearch):
    """Random search that notes what it is told."""

    told: list[float] = []

    def tell(self, parameters: Parameters, merit: float, fell: bool = False) -> None:
        self.told.append(merit)
        super().tell(parameters, merit, fell)


def test_each_return_is_corrected_by_what_is_known_then(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The records keep the returns as they were."""
    monkeypatch.setattr(Stage, "trials", 1)
    monkeypatch.setattr(corrections, "CHANCE", 1.0)  # so few episodes need not tell of any disturbance
    monkeypatch.setitem(OPTIMISERS, "random", Listening)
    config = TrainingConfig("balance", "random", 28, slots=3, episode=BALANCE.config_of(EPISODE))
    run, _, specs = trained(tmp_path / "run", config)
    assert len(specs) == simulated_episodes(config)
    specs = specs[: len(Listening.told)]
    returns = np.array([simulate(spec).episode_return for spec in specs])
    assert [float(row["return"]) for row in run.episodes()][: len(specs)] == returns.tolist()
    disturbances = np.array([disturbances_of(spec) for spec in specs])
    actions = np.array([spec.task.box.scaled(spec.parameters) for spec in specs])
    expected = [corrected(returns[:end], actions[:end], disturbances[:end])[-1] for end in range(1, len(specs) + 1)]
    assert Listening.told == expected and (np.array(expected[19:]) != returns[19:]).any()


@pytest.mark.parametrize("algo", ["random", "naf"])
def test_other_disturbances_than_before_are_a_mistake_of_the_task(algo: str, tmp_path: Path) -> None:
    """Whichever algorithm learns: a training that goes on would stop there again."""
    task = "MINE = dataclasses.replace(sarah.STEPPING, name='mine', disturbances=lambda spec: (0,) * (spec.seed % 9))"
    config = TrainingConfig(
        task_of_text("mine.py", "MINE", f"import dataclasses, sarah\n{task}"), algo, 9, slots=1, episode=EPISODE
    )
    with pytest.raises(
        TaskError, match=r"^mine.py:MINE: disturbances must be as many numbers in every episode, \d, not \d$"
    ):
        train(config, RunFolder.create(tmp_path / "run", config))
