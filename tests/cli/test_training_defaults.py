"""What ``sarah-train`` and ``sarah-compare`` train with unless somebody says otherwise."""

import dataclasses
from collections.abc import Callable
from pathlib import Path

import pytest

from sarah.episode.push import Push
from sarah.episode.settings import EpisodeConfig
from sarah.episode.tasks import BALANCE, STEPPING, BalanceConfig
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.physics import Physics

TRAIN, COMPARE = "sarah-train --task balance", "sarah-compare --out race --task balance"
PUSHED = BalanceConfig(push=Push(newtons=(100.0, 125.0), sagittal_share=0.5), time_limit=10.0)
PAPER = "--episode.push.newtons 0 100 --episode.push.sagittal-share 0 --episode.time-limit 30"
LEGS = (0.4, 1.3, 0.1, 1.0, 1.0)
FILE = """
import dataclasses, sarah
MINE = dataclasses.replace(sarah.BALANCE, name="mine")
"""


@pytest.mark.parametrize("command", [TRAIN, COMPARE])
def test_balance_is_learned_from_pushes_that_tell_sets_apart(
    command: str, begun: Callable[[str], TrainingConfig]
) -> None:
    config = begun(command)
    assert (config.task, config.episodes, config.episode) == (BALANCE, 300, PUSHED)


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


@pytest.fixture
def first(tmp_path: Path) -> EpisodeConfig:
    """Settings of a First Training on a robot of its own, whose folder is ``first``."""
    own = EpisodeConfig(
        physics=Physics(400, 20, 200), payload=3.0, dimensions={"thigh_length": 0.36}, reward_form="printed"
    )
    run = RunFolder.create(tmp_path / "first", TrainingConfig(episode=own))
    run.write_parameters({"parameters": dict(zip(STEPPING.parameter_names, LEGS, strict=True))})
    return own


def test_what_was_learned_first_gives_legs_and_robot(
    first: EpisodeConfig, begun: Callable[[str], TrainingConfig], capsys: pytest.CaptureFixture[str]
) -> None:
    config = begun(f"{TRAIN} --from first --episode.push.newtons 110 --episode.payload 1")
    push = first.scale.scaled(Push(newtons=(110.0, 110.0), sagittal_share=0.5))  # its mass is the usual one
    assert config.episodes == 300
    assert config.episode == BALANCE.config_of(first, stepping=LEGS, push=push, time_limit=10.0, payload=1.0)
    text = capsys.readouterr().out
    said = [line.strip() for line in text.partition("all settings of its episodes, but\n")[2].splitlines()]
    assert {"payload 1 instead of 3", "time_limit 10 instead of 30"} < set(said) and len(said) == 3
    assert said[-1].startswith("push newtons 110, ") and said[-1].endswith(" instead of none")


def test_a_file_goes_before_what_was_learned_first_and_an_option_before_both(
    first: EpisodeConfig,
    tmp_path: Path,
    begun: Callable[[str], TrainingConfig],
    capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / "mine.yaml").write_text("episode: {payload: 2, physics: {solver_iterations: 30}, push: {degrees: 90}}")
    others = "--episode.physics.control-rate 100 --episode.stepping 1 1 1 1 1"
    config = begun(f"{TRAIN} --from first --config mine.yaml {others}")
    assert "\n  stepping 1, 1, 1, 1, 1 instead of 0.4, 1.3, 0.1, 1, 1\n" in capsys.readouterr().out
    assert config.episode.payload == 2.0 and config.episode.reward_form == "printed"
    assert config.episode.physics == dataclasses.replace(first.physics, solver_iterations=30, control_rate=100)
    push = Push((100.0, 125.0), degrees=(90.0, 90.0), sagittal_share=0.5)
    assert BALANCE.config_of(config.episode).push == first.scale.scaled(push)


def test_another_robot_than_the_first_has_its_own_push_and_the_settings_that_were_recorded(
    first: EpisodeConfig, begun: Callable[[str], TrainingConfig]
) -> None:
    config = begun(f"{TRAIN} --from first --episode.dimensions shank_length 0.5")
    robot = EpisodeConfig(dimensions={"thigh_length": 0.36, "shank_length": 0.5})
    push = robot.scale.scaled(PUSHED.push)
    assert config.episode == BALANCE.config_of(
        dataclasses.replace(first, dimensions=robot.dimensions), stepping=LEGS, push=push, time_limit=10.0
    )
