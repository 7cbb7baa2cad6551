"""A third task is a task like the others: the commands take its settings from its entry in TASKS."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from sarah.cli import compare, eval, train
from sarah.control.parameters import PAPER_STEPPING, STEPPING_PARAMETERS
from sarah.control.pattern_generator import SteppingParameters
from sarah.episode.settings import EpisodeConfig
from sarah.episode.tasks import BALANCE, TASKS, Task
from sarah.runs.run_folder import RunFolder
from sarah.training import train as training


@dataclass(frozen=True)
class ShortConfig(EpisodeConfig):
    """Settings with another time limit."""

    time_limit: float = 1.3


@pytest.fixture
def command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., None]]:
    """Runs a command in this process, which knows a task of P1 to P3."""
    task = Task(
        name="three",
        title="P1 to P3",
        parameters=STEPPING_PARAMETERS[:3],
        episode=ShortConfig(),
        controller_parameters=lambda chosen, config: (SteppingParameters(*chosen, 1.0, 1.0), None),
        baseline=PAPER_STEPPING[:3],
        baseline_label="paper",
    )
    monkeypatch.setitem(TASKS, task.name, task)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(training, "SUMMARY_EPISODES", 1)

    def run(*arguments: str) -> None:
        name, *others = arguments
        monkeypatch.setattr("sys.argv", [name, *others])
        {"sarah-train": train, "sarah-eval": eval, "sarah-compare": compare}[name].main()

    yield run


def test_its_own_settings_are_the_defaults(command: Callable[..., None]) -> None:
    command("sarah-train", "--task", "three", "--algo", "random", "--episodes", "2", "--run-dir", "run")
    assert RunFolder.open(Path("run")).config().episode == ShortConfig()
    command("sarah-compare", "race", "--task", "three", "--algorithms", "random", "--seeds", "1", "--episodes", "5")
    (raced,) = Path("race").glob("*/config.yaml")
    assert RunFolder.open(raced.parent).config().episode == ShortConfig()


def test_a_file_of_settings_keeps_what_it_says(command: Callable[..., None]) -> None:
    Path("mine.yaml").write_text("task: three\nepisodes: 2\nalgo: random\nepisode: {reward_form: printed}\n")
    command("sarah-train", "--config", "mine.yaml", "--run-dir", "run")
    assert RunFolder.open(Path("run")).config().episode == ShortConfig(reward_form="printed")


def test_only_the_balance_task_has_a_table_of_robustness(
    command: Callable[..., None], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(TASKS, "three", BALANCE)  # pushed, and yet another task
    with pytest.raises(SystemExit):
        command("sarah-eval", "--task", "three", "--parameters", "0,0,0,0", "--robustness", "table")
    assert "--robustness is for --task balance" in capsys.readouterr().err
