"""What a task owns: its parameters, its settings and its push. A third one is a file, and as good as the two."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

import sarah
from sarah.control.parameters import STEPPING_PARAMETERS
from sarah.control.pattern_generator import SteppingParameters
from sarah.envs.sarah_env import SarahEnv
from sarah.episode import tasks
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, STEPPING, TASKS, BalanceConfig, Task, task_named, tasks_in
from sarah.errors import ConfigurationError

OTHERS = {"stepping": BalanceConfig(), "balance": EpisodeConfig()}
"""Settings that are not the task's."""


@pytest.mark.parametrize("task", OTHERS)
def test_another_tasks_settings_are_refused_in_one_line(task: str) -> None:
    own, other = type(TASKS[task].episode).__name__, type(OTHERS[task]).__name__
    with pytest.raises(ConfigurationError) as refused:
        EpisodeSpec(TASKS[task].baseline, 0, task, OTHERS[task])
    assert str(refused.value) == f"task '{task}' takes settings of type {own}, not {other}"
    with pytest.raises(ConfigurationError, match=f"takes settings of type {own}, not {other}"):
        SarahEnv(task, OTHERS[task])


def test_only_the_balance_task_has_a_push_and_given_legs() -> None:
    assert BALANCE.has_push and not STEPPING.has_push
    assert STEPPING.draw_push(STEPPING.episode, 1) is None
    assert not hasattr(STEPPING.episode, "push") and not hasattr(STEPPING.episode, "stepping")


def test_settings_go_to_another_task_with_all_that_they_share() -> None:
    config = BalanceConfig(time_limit=7.0, stepping=(0.1,) * 5)
    assert STEPPING.config_of(config) == EpisodeConfig(time_limit=7.0)
    again = BALANCE.config_of(EpisodeConfig(time_limit=7.0), stepping=(0.1,) * 5)
    assert again == config


@dataclasses.dataclass(frozen=True)
class HurriedConfig(EpisodeConfig):
    """Settings of a task that gives P3 to P5."""

    rest: tuple[float, float, float] = (0.1, 1.0, 1.0)


HURRIED = Task(
    name="hurried",
    title="Two parameters instead of five",
    parameters=tuple(dataclasses.replace(parameter, high=1.5) for parameter in STEPPING_PARAMETERS[:2]),
    episode=HurriedConfig(time_limit=2.0),
    controller_parameters=lambda chosen, config: (SteppingParameters(*chosen, *config.rest), None),
    baseline=(0.4, 1.3),
    baseline_label="the paper's P1 and P2",
)


def test_a_third_task_is_as_good_as_the_two(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(TASKS, HURRIED.name, HURRIED)
    assert task_named("hurried") is HURRIED
    env = SarahEnv("hurried")
    assert env.action_space.shape == (2,)
    for action in (np.zeros(2, np.float32), np.ones(2, np.float32)):
        env.reset(seed=3)
        _, reward, terminated, _, info = env.step(action)
        assert terminated and info["parameters"] == pytest.approx(tuple(0.75 * (action + 1.0)))
        spec = EpisodeSpec(info["parameters"], info["seed"], "hurried", HURRIED.episode)
        assert info["result"] == sarah.simulate(spec) and reward == info["result"].episode_return
    given = EpisodeSpec((*info["parameters"], 0.1, 1.0, 1.0), info["seed"], config=EpisodeConfig(time_limit=2.0))
    assert sarah.simulate(given) == info["result"]  # P1 to P5 given by hand are the same episode
    env.close()


def test_a_file_beside_the_others_is_a_task(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "lasting.py").write_text(
        "import dataclasses\n"
        "from sarah.episode.tasks.stepping import STEPPING\n"
        "LASTING = dataclasses.replace(STEPPING, name='lasting', reward=lambda tick, config: 1.0)\n"
    )
    monkeypatch.setattr(tasks, "__path__", [*tasks.__path__, str(tmp_path)])
    assert [*tasks_in(tasks.__path__)] == [*TASKS, "lasting"]
