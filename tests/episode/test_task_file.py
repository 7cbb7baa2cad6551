"""What a task owns; one of the user's file is as good, in any process, and its mistakes are one line."""

import dataclasses
from pathlib import Path
from typing import Any

import pytest
from laboratory import COARSE_PHYSICS

import sarah
from sarah import EpisodeConfig, EpisodeSpec
from sarah.envs.sarah_env import SarahEnv
from sarah.episode import tasks
from sarah.episode.tasks import BALANCE, STEPPING, TASKS, BalanceConfig, tasks_in
from sarah.episode.trial import try_task
from sarah.episode.workers import Workers, begin_episode, close_waiting_episodes, finish_episode
from sarah.errors import ConfigurationError, SarahError

THRIFTY = """
import dataclasses
import sarah

def reward(tick, config):
    return sarah.equation_2(tick, config) - 0.01 * tick.power

def ending(tick, config):
    return "far_away" if abs(tick.x) > 0.02 else sarah.paper_ending(tick, config)

THRIFTY = dataclasses.replace(sarah.STEPPING, name="thrifty", reward=reward)
NARROW = dataclasses.replace(sarah.STEPPING, name="narrow", ending=ending)
"""
PARAMETERS = (0.41, 0.52, 0.62, 1.17, 1.37)
SHORT = sarah.EpisodeConfig(time_limit=3.0, physics=COARSE_PHYSICS)


def written(folder: Path, text: str = THRIFTY) -> str:
    path = folder / "my_task.py"
    path.write_text(text)
    return str(path)


def test_reward_and_ending_are_those_of_the_file(tmp_path: Path) -> None:
    thrifty, narrow = (sarah.load_task(f"{written(tmp_path)}:{name}") for name in ("THRIFTY", "NARROW"))
    config = dataclasses.replace(SHORT, time_limit=6.0)
    own, paper = (sarah.simulate(sarah.EpisodeSpec(PARAMETERS, 0, task, config)) for task in (thrifty, sarah.STEPPING))
    # The mean power over the ticks is the metric's, but for one tick at either end.
    assert own.episode_return == pytest.approx(paper.episode_return - 0.01 * paper.actuator_power * 5.0, rel=0.02)
    assert own.steps == paper.steps
    result = sarah.simulate(sarah.EpisodeSpec(PARAMETERS, 0, narrow))
    assert result.termination == "far_away" and not result.survived and 0.02 < abs(result.final_position[0]) < 0.03


def test_same_bytes_in_another_process(tmp_path: Path, workers: Workers) -> None:
    task = sarah.load_task(f"{written(tmp_path)}:THRIFTY")
    specs = [sarah.EpisodeSpec(PARAMETERS, seed, task, SHORT) for seed in range(2)]
    here = [sarah.simulate(spec) for spec in specs]
    Path(tmp_path, "my_task.py").unlink()  # workers have the text, and need no file
    assert list(workers.simulate_all(specs)) == here


def test_workers_refuse_the_task_of_a_script(workers: Workers) -> None:
    task = dataclasses.replace(sarah.STEPPING, name="mine", reward=lambda tick, config: 1.0)
    with pytest.raises(ConfigurationError, match="load_task"):
        list(workers.simulate_all([sarah.EpisodeSpec(PARAMETERS, 0, task, SHORT)]))


REPLACED = "import dataclasses, sarah\nJUMP = dataclasses.replace(sarah.STEPPING, name="
SHORT_SCALE = "import sarah\nP = sarah.Parameter('P', 0, 1, '', 'a', 'b', length_scale=0)\n"
ODD = "import sarah\nP = sarah.Parameter('P', 0.0, 1.0, '$m$', 'a', 'b')\n"
OWN = "import sarah\nclass Own(sarah.EpisodeConfig): pass\n"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("JUMP = 1\n", "unknown task in my_task.py 'JUMP'"),
        ("import sarah\nJUMP = sarah.STEPPING\nJUMB = nothing\n", "my_task.py, line 3: NameError: name 'nothing'"),
        ("def (:\n", "my_task.py, line 1: SyntaxError"),
        ("import not_installed_anywhere\n", "my_task.py, line 1: ModuleNotFoundError"),
        ("import sarah\nJUMP = sarah.STEPPING\n", "is that of a task of this package"),
        (f"{ODD}{REPLACED}'j', parameters=(P,), baseline=(0.5,))\n", "unit and meaning of parameter P must be plain"),
        (
            f"{SHORT_SCALE}{REPLACED}'j', parameters=(P,), baseline=(0,))\n",
            "P must be a number from 0.01 to 100, not 0.0",
        ),
        (f"\ufeff{REPLACED}'a b')\n", "a task's name must be letters, digits, - and _, not 'a b'"),
        (f"{REPLACED}'j', baseline=(1, 1))\n", r"baseline must be 5 numbers \(P1 to P5\), not 2"),
        (f"{OWN}{REPLACED}'j', episode=Own())\n", "must be one of EpisodeConfig, PushedConfig, BalanceConfig, not Own"),
    ],
)
def test_mistakes_of_a_file_are_one_line(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(ConfigurationError, match=words) as caught:
        sarah.load_task(f"{written(tmp_path, text)}:JUMP")
    assert "\n" not in str(caught.value)


NOT_STEPPING = "controller_parameters must return finite SteppingParameters"
SILENT = "type('Odd', (Exception,), {'__str__': lambda e: 1 / 0})"


@pytest.mark.parametrize(
    ("function", "words"),
    [
        ("reward=lambda tick, _: tick.powr", "my_task.py, line 2: AttributeError: 'Tick' object has no attribute"),
        ("reward=lambda *_: float('nan')", "my_task.py:JUMP: its reward must be a finite number, not nan"),
        ("reward=lambda *_: [1.0]", r"its reward must be a finite number, not \[1.0\]"),
        ("reward=lambda *_: throw(ValueError('one\\ntwo'))", "^my_task.py, line 1: ValueError: one two$"),
        ("reward=lambda *_: throw(SystemExit(0))", "my_task.py, line 1: SystemExit: 0"),
        (f"reward=lambda *_: throw({SILENT})", "an exception without a message"),
        ("reward=lambda *_: seen.append(1) or len(seen)", "its functions must depend on their arguments only"),
        ("ending=lambda *_: 'it fell'", "a short name of its own such as 'jumped', not 'it fell'"),
        ("ending=lambda *_: 'time_limit'", "a short name of its own such as 'jumped', not 'time_limit'"),
        ("draw_push=lambda *_: 5", "draw_push must return a DrawnPush or None, not 5"),
        ("controller_parameters=lambda *_: 5", NOT_STEPPING),
        ("controller_parameters=lambda *_: (sarah.SteppingParameters(*[float('nan')] * 5), None)", NOT_STEPPING),
        ("disturbances=lambda spec: 1 / 0", "my_task.py, line 2: ZeroDivisionError: division by zero"),
        ("disturbances=lambda spec: {1.0}", "JUMP: disturbances must return a tuple of finite numbers, not {1.0}"),
        ("disturbances=lambda spec: (1.0, float('nan'))", r"a tuple of finite numbers, not \(1.0, nan\)"),
        ("disturbances=lambda spec: (len(seen), seen.append(1))[:1]", "disturbances must depend on its argument only"),
        ("disturbances=lambda spec: spec.parameters", "must not depend on the parameters, which are what is learned"),
        ("disturbances=lambda spec: [0.0] * (1 + (spec.seed > 9))", "as many numbers for every episode, not 1 and 2"),
    ],
)
def test_a_trial_finds_mistakes_of_functions(tmp_path: Path, function: str, words: str) -> None:
    text = "import dataclasses, sarah; seen = []; throw = lambda error: (_ for _ in ()).throw(error)\n"
    text += f"JUMP = dataclasses.replace(sarah.STEPPING, name='jump', {function})\n"
    with pytest.raises(SarahError, match=words) as caught:
        try_task(sarah.load_task(f"{written(tmp_path, text)}:JUMP"), SHORT)
    assert "\n" not in str(caught.value)


def test_two_tasks_of_a_script_with_one_name_do_not_mix() -> None:
    one, two = (dataclasses.replace(sarah.STEPPING, name="same", reward=lambda *_, r=r: r) for r in (1.0, 2.0))
    begin_episode(sarah.EpisodeSpec(PARAMETERS, 0, one, SHORT))
    outcome = finish_episode(sarah.EpisodeSpec(PARAMETERS, 0, two, SHORT))
    close_waiting_episodes()
    assert outcome.result.episode_return == pytest.approx(4.0)


def test_everything_that_a_tick_knows() -> None:
    seen: list[sarah.Tick] = []

    def reward(tick: sarah.Tick, config: sarah.EpisodeConfig) -> float:
        seen.append(tick)
        return 1.0

    task = dataclasses.replace(sarah.STEPPING, name="watched", reward=reward, best_reward=1.0)
    result = sarah.simulate(sarah.EpisodeSpec(PARAMETERS, 0, task, SHORT), record_trace=True)
    assert result.score == pytest.approx(1.0)  # one per second is the best
    assert result.trace is not None
    assert [tick.time for tick in seen] == pytest.approx([time + 0.01 for time in result.trace.time])
    assert {tick.phase.value for tick in seen} == set(result.trace.phase) | {seen[-1].phase.value}
    assert seen[-1].steps == result.steps
    assert (seen[-1].x, seen[-1].y, seen[-1].height) == pytest.approx(result.final_position)
    assert all(len(tick.joint_speeds) == len(tick.efforts) == 6 and tick.power >= 0.0 for tick in seen)
    assert all(len(tick.pads) == 4 and len(tick.velocity) == 3 and tick.tilt < 0.3 for tick in seen)


OTHERS = {"stepping": BalanceConfig(), "balance": EpisodeConfig()}
"""Settings that are not the task's."""


@pytest.mark.parametrize("task", OTHERS)
@pytest.mark.parametrize("make", [lambda task, config: EpisodeSpec(TASKS[task].baseline, 0, task, config), SarahEnv])
def test_another_tasks_settings_are_refused_in_one_line(make: Any, task: str) -> None:
    own, other = type(TASKS[task].episode).__name__, type(OTHERS[task]).__name__
    with pytest.raises(ConfigurationError, match=f"^task '{task}' takes settings of type {own}, not {other}$"):
        make(task, OTHERS[task])


def test_settings_go_to_another_task_with_all_that_they_share() -> None:
    assert BALANCE.has_push and not STEPPING.has_push and STEPPING.draw_push(STEPPING.episode, 1) is None
    config = BalanceConfig(time_limit=7.0, stepping=(0.1,) * 5)
    assert STEPPING.config_of(config) == EpisodeConfig(time_limit=7.0)
    assert BALANCE.config_of(EpisodeConfig(time_limit=7.0), stepping=(0.1,) * 5) == config


def test_a_file_beside_the_others_is_a_task(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "lasting.py").write_text(
        "import dataclasses\n"
        "from sarah.episode.tasks.stepping import STEPPING\n"
        "LASTING = dataclasses.replace(STEPPING, name='lasting', reward=lambda tick, config: 1.0)\n"
    )
    monkeypatch.setattr(tasks, "__path__", [*tasks.__path__, str(tmp_path)])
    assert [*tasks_in(tasks.__path__)] == [*TASKS, "lasting"]
