"""An interrupted training goes on exactly: whatever learns, wherever it was cut, whatever is left of its journal."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from endurance.kills import left_behind
from interrupted import EPISODE, content, go_on, trained

from sarah.agents import LocalNAF, corrections
from sarah.episode.tasks import TASKS
from sarah.episode.workers import Executor, Job, Workers, begin_episode
from sarah.errors import LearningError, ResumeError, RunFolderError
from sarah.runs.agent_settings import NAFSettings, settings_of
from sarah.runs.config import AGENTS, TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.training import plan
from sarah.training.plan import Stage, seeds_of
from sarah.training.train import train


@pytest.fixture(autouse=True, scope="module")
def short() -> Iterator[None]:
    """A training with two trials, that corrects returns early."""
    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.setattr(corrections, "FEWEST_EPISODES", 8)
        monkeypatch.setattr(Stage, "trials", 2)
        monkeypatch.setattr(plan, "EPISODES_PER_TRIAL", 2)
        yield


class Counting(Executor):
    """Simulates in this process, and counts."""

    run = 0

    def submit(self, function: Callable[..., Any], *subjects: Any) -> Job:
        self.run += function is not begin_episode
        return Workers().submit(function, *subjects)


@pytest.mark.parametrize(
    ("algo", "task", "cuts"),
    [("naf", "balance", (3, 12)), ("sac", "stepping", (9,)), ("cma-es", "balance", (2, 14)), ("gp", "stepping", (10,))],
)
def test_an_interrupted_training_ends_as_without(algo: str, task: str, cuts: tuple[int, ...], tmp_path: Path) -> None:
    agent = settings_of(algo)(**({"learning_starts": 6} if algo in AGENTS else {}))
    episode = TASKS[task].config_of(EPISODE)
    config = TrainingConfig(task, algo, episodes=16, seed=7, slots=2, agent=agent, episode=episode)
    whole = RunFolder.create(tmp_path / "whole", config)
    learned = train(config, whole)
    expected = left_behind(whole.path)
    assert list(expected["episode/score"])[-1][0] == 16 and ("policy.pth" in expected) == (algo in AGENTS)
    cut = RunFolder.create(tmp_path / "cut", config)
    for results in cuts:
        go_on(cut, results)
        assert not cut.is_finished
    assert train(config, cut) == learned
    assert left_behind(cut.path) == expected


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> RunFolder:
    config = TrainingConfig(episodes=16, seed=2, slots=3, agent=NAFSettings(learning_starts=6), episode=EPISODE)
    return trained(tmp_path_factory.mktemp("runs") / "whole", config)


def begun_with(path: Path, whole: RunFolder, journal: bytes) -> RunFolder:
    """The run folder of the same training, with another journal and nothing else."""
    begun = RunFolder.create(path, whole.config())
    begun.journal_path.write_bytes(journal)
    return begun


def test_a_damaged_row_costs_its_simulation_only(whole: RunFolder, tmp_path: Path, caplog: Any) -> None:
    """What is finished is not simulated again."""
    lines = whole.journal_path.read_bytes().splitlines(keepends=True)
    finished, half = {line for line in lines if b'"kind":"begin"' not in line}, lines[: len(lines) // 2]
    counting = Counting()
    train(whole.config(), begun_with(tmp_path / "half", whole, b"".join(half)), counting)
    assert counting.run == len(finished - {*half}) > 5
    row = next(number for number, line in enumerate(lines) if number > 10 and b'"kind":"finish"' in line)
    lines[row] = lines[row].replace(b'"steps":0', b'"steps":9', 1)
    counting = Counting()
    begun = begun_with(tmp_path / "damaged", whole, b"".join(lines))
    train(whole.config(), begun, counting)
    assert counting.run == 1 and "damaged rows: 1; what they have is asked for again" in caplog.text
    assert left_behind(begun.path) == left_behind(whole.path)


def test_a_training_that_does_not_repeat_is_not_resumed(whole: RunFolder, tmp_path: Path) -> None:
    """As on another processor, whose arithmetic differs in the last bit."""
    begun = RunFolder.create(tmp_path / "begun", whole.config())
    go_on(begun, 20)
    before = content(begun)
    with pytest.MonkeyPatch.context() as another_processor:
        another_processor.setattr(plan, "seeds_of", lambda seed: seeds_of(seed + 1))
        with pytest.raises(ResumeError, match="cannot be resumed here: it does not repeat"):
            train(whole.config(), begun)
    assert content(begun) == before
    train(whole.config(), begun)
    assert left_behind(begun.path) == left_behind(whole.path)


def test_two_trainings_do_not_share_a_run_folder(whole: RunFolder, tmp_path: Path) -> None:
    begun = RunFolder.create(tmp_path / "begun", whole.config())
    with begun.journal_of(whole.config()), pytest.raises(RunFolderError, match=r"begun is in use by another training"):
        train(whole.config(), begun)
    go_on(begun, 1)


def test_weights_that_are_not_finite_stop_the_training(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    config = TrainingConfig(episodes=16, slots=1, agent=NAFSettings(learning_starts=6), episode=EPISODE)
    begun, original = RunFolder.create(tmp_path / "run", config), LocalNAF.train

    def train_and_poison(model: LocalNAF, *args: Any, **kwargs: Any) -> None:
        original(model, *args, **kwargs)
        if model.num_timesteps >= 9:
            next(model.policy.parameters()).data[0] = float("nan")

    monkeypatch.setattr(LocalNAF, "train", train_and_poison)
    with pytest.raises(LearningError, match=r"weights are no longer finite after 9 episodes"):
        train(config, begun)
    assert len(list(begun.episodes())) == 9 and not begun.is_finished and not begun.model_path.exists()
    monkeypatch.setattr(LocalNAF, "train", original)
    train(config, begun)
    assert begun.is_finished and len(list(begun.episodes())) == 16
