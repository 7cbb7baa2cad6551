"""What ``sarah-train`` and ``sarah-compare`` train with unless somebody says otherwise."""

import re
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

import pytest

from sarah.episode.push import Push
from sarah.episode.settings import EpisodeConfig
from sarah.episode.tasks import BALANCE, STEPPING, BalanceConfig
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder

TRAIN, COMPARE = "sarah-train --task balance", "sarah-compare --out race --task balance"
PUSHED = BalanceConfig(push=Push(newtons=(100.0, 125.0), sagittal_share=0.5), time_limit=10.0)
PAPER = "--episode.push.newtons 0 100 --episode.push.sagittal-share 0 --episode.time-limit 30"
FILE = """
import dataclasses, sarah
MINE = dataclasses.replace(sarah.BALANCE, name="mine")
"""


@pytest.fixture
def begun(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], TrainingConfig]:
    """Settings of the training that a command line begins, which is interrupted before its first episode."""
    monkeypatch.chdir(tmp_path)

    def begin(line: str) -> TrainingConfig:
        settings: list[TrainingConfig] = []

        def train(config: TrainingConfig, *_: object, **__: object) -> None:
            settings.append(config)
            raise KeyboardInterrupt

        monkeypatch.setattr("sarah.training.train.train", train)
        monkeypatch.setattr("sarah.reports.race.train", train)
        command, *arguments = line.split()
        monkeypatch.setattr("sys.argv", [command, *arguments])
        with pytest.raises(SystemExit, match="130"):
            import_module(f"sarah.cli.{command.removeprefix('sarah-')}").main()
        return settings[0]

    return begin


@pytest.mark.parametrize("command", [TRAIN, COMPARE])
def test_balance_is_learned_from_pushes_that_tell_sets_apart(
    command: str, begun: Callable[[str], TrainingConfig]
) -> None:
    config = begun(command)
    assert (config.task, config.episodes, config.episode) == (BALANCE, 300, PUSHED)


@pytest.mark.parametrize("command", [TRAIN, COMPARE])
def test_help_shows_these_defaults(
    command: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    name, *arguments = command.split()
    monkeypatch.setattr("sys.argv", [name, *arguments, "--help"])
    with pytest.raises(SystemExit):
        import_module(f"sarah.cli.{name.removeprefix('sarah-')}").main()
    text = " ".join(capsys.readouterr().out.replace("│", " ").split())
    shown = dict(re.findall(r"--(\S+) (?:INT|FLOAT)(?: \[FLOAT\])? (?:(?!--).)*?\(default: (.*?)\)", text))
    assert shown["episodes"] == "300" and shown["episode.time-limit"] == "10.0"
    assert shown["episode.push.newtons"] == "100.0 125.0" and shown["episode.push.sagittal-share"] == "0.5"


@pytest.mark.parametrize("command", [TRAIN, COMPARE])
def test_an_option_wins(command: str, begun: Callable[[str], TrainingConfig]) -> None:
    config = begun(f"{command} --episodes 7 {PAPER}")
    assert config.episodes == 7 and config.episode == BALANCE.episode


@pytest.mark.parametrize("command", [TRAIN, COMPARE])
def test_all_pushes_point_where_somebody_asks_for(command: str, begun: Callable[[str], TrainingConfig]) -> None:
    push = Push(newtons=(100.0, 125.0), degrees=(0.0, 90.0))
    assert begun(f"{command} --episode.push.degrees 0 90").episode == BalanceConfig(push=push, time_limit=10.0)


@pytest.mark.parametrize("command", ["sarah-train", "sarah-compare --out race"])
@pytest.mark.parametrize(("task", "own"), [("stepping", STEPPING.episode), ("my_task.py:MINE", BALANCE.episode)])
def test_other_tasks_keep_their_own(
    command: str, task: str, own: EpisodeConfig, tmp_path: Path, begun: Callable[[str], TrainingConfig]
) -> None:
    (tmp_path / "my_task.py").write_text(FILE)
    config = begun(f"{command} --task {task}")
    assert (config.episodes, config.episode) == (100, own)


@pytest.mark.parametrize("task", ["", " --task balance"])
def test_what_a_file_does_not_name_is_the_tasks_own(
    task: str, tmp_path: Path, begun: Callable[[str], TrainingConfig]
) -> None:
    (tmp_path / "mine.yaml").write_text("task: balance\nepisode: {push: {degrees: 90, sagittal_share: 0.2}}\n")
    config = begun(f"sarah-train --config mine.yaml{task} --episode.push.degrees 0")
    assert config == TrainingConfig("balance", episode=BalanceConfig(push=Push(degrees=(0.0, 0.0), sagittal_share=0.2)))


def test_a_training_goes_on_with_its_own(tmp_path: Path, begun: Callable[[str], TrainingConfig]) -> None:
    paper = TrainingConfig("balance", episodes=20)
    RunFolder.create(tmp_path / "run", paper)
    for task in ("", " --task balance"):
        assert begun(f"sarah-train --resume run{task}") == paper


def test_what_was_learned_first_gives_legs_and_robot(tmp_path: Path, begun: Callable[[str], TrainingConfig]) -> None:
    legs = (0.4, 1.3, 0.1, 1.0, 1.0)
    longer = {"thigh_length": 0.36}
    first = RunFolder.create(tmp_path / "first", TrainingConfig(episode=STEPPING.config_of(PUSHED, dimensions=longer)))
    first.write_parameters({"parameters": dict(zip(STEPPING.parameter_names, legs, strict=True))})
    config = begun(f"{TRAIN} --from first --episode.push.newtons 110")
    push = Push(newtons=(110.0, 110.0), sagittal_share=0.5)
    assert config.episodes == 300
    assert config.episode == BalanceConfig(stepping=legs, dimensions=longer, push=push, time_limit=10.0)
