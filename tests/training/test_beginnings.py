"""Every algorithm begins alike: at the neutral parameters, then with uniform draws, on episodes of its own stream."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from interrupted import EPISODE

from sarah.envs.sarah_env import draw_seed
from sarah.episode.spec import FIRST_TRAINING_SEED, EpisodeSpec
from sarah.episode.tasks import BALANCE, STEPPING
from sarah.episode.workers import Executor, Job, Workers, begin_episode
from sarah.runs.agent_settings import settings_of
from sarah.runs.config import AGENTS, ALGORITHMS, TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.training.plan import Stage, seeds_of
from sarah.training.train import train


class Recording(Executor):
    """Simulates in this process, and notes the episodes."""

    def __init__(self) -> None:
        self.specs: list[EpisodeSpec] = []

    def submit(self, function: Callable[..., Any], *subjects: Any) -> Job:
        if function is not begin_episode:
            self.specs.append(subjects[0])
        return Workers().submit(function, *subjects)


def trained(path: Path, config: TrainingConfig) -> tuple[np.ndarray, list[int], list[EpisodeSpec]]:
    """Actions within -1 and 1 and seeds of a training's episodes, and all episodes that it has simulated."""
    run, recording = RunFolder.create(path, config), Recording()
    train(config, run, recording)
    rows, box = list(run.episodes()), config.task.box
    actions = [box.scaled([float(row[name]) for name in box.names]) for row in rows]
    return np.array(actions), [int(row["seed"]) for row in rows], recording.specs


@pytest.mark.parametrize("algo", ALGORITHMS)
def test_the_first_episode_of_every_algorithm_is_neutral(algo: str, tmp_path: Path) -> None:
    config = TrainingConfig("balance", algo, episodes=3, slots=1, episode=BALANCE.config_of(EPISODE))
    actions, seeds, _ = trained(tmp_path / "run", config)
    assert not actions[0].any() and actions[1].any()
    generator = np.random.default_rng(seeds_of(config.seed).episodes)
    assert seeds == [draw_seed(generator) for _ in range(3)]


def test_the_warm_up_has_no_noise(tmp_path: Path) -> None:
    agent = settings_of("ddpg")(action_noise_std=2.0)  # type: ignore[call-arg]  # of a learner
    config = TrainingConfig(algo="ddpg", episodes=12, slots=1, agent=agent, episode=EPISODE)
    actions, _, _ = trained(tmp_path / "run", config)
    on_a_bound = np.isclose(np.abs(actions), 1.0).any(axis=1)
    assert not on_a_bound[:5].any() and on_a_bound[5:].all()


def test_all_algorithms_warm_up_for_as_many_episodes() -> None:
    assert {settings_of(algo)().learning_starts for algo in AGENTS} == {5}  # type: ignore[attr-defined]


def test_a_training_has_a_seed_of_its_own_for_each_stream() -> None:
    seeds = [seed for training_seed in range(1000) for seed in seeds_of(training_seed)]
    assert len(set(seeds)) == len(seeds) == 4000 and max(seeds) < 2**31


def test_trials_come_before_any_seed_of_the_summary_is_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Stage, "trials", 2)
    assert BALANCE.neutral is not None
    config = TrainingConfig("balance", "random", episodes=16, slots=1, episode=BALANCE.config_of(EPISODE))
    _, seeds, specs = trained(tmp_path / "run", config)
    assert seeds[6:11] == seeds[11:] and len(set(seeds[11:])) == 5
    steering, summary = specs[:21], specs[21:]
    assert [(spec.parameters, spec.seed) for spec in steering[6:11]] == [(BALANCE.neutral, seed) for seed in seeds[11:]]
    assert all(spec.seed >= FIRST_TRAINING_SEED for spec in steering)
    assert [spec.seed for spec in summary] == [0, 1, 0, 1]
    trials = [[spec.parameters for spec in trial] for trial in (specs[11:16], specs[16:21])]
    assert [summary[0].parameters] * 5 in trials


def test_without_neutral_parameters_none_are_simulated(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Stage, "trials", 2)
    assert STEPPING.neutral is None
    _, _, specs = trained(tmp_path / "run", TrainingConfig(algo="random", episodes=16, slots=1, episode=EPISODE))
    assert len(specs) == 16 + 2
