"""A session as a whole: its specification determines it, and its folder goes on, also with a robot of metal."""

import dataclasses
import json
import random
import shutil
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from operated import KEPT, interrupted_after, quick
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

from sarah.cli.operate_text import summarise
from sarah.control.parameters import BALANCE_PARAMETERS
from sarah.episode.reward import highest_return
from sarah.errors import ConfigurationError, ResumeError, RunFolderError, TrainingInterruptedError
from sarah.operation.settings import SHIPPED, Change
from sarah.operation.window import FELT
from sarah.remote.answers import Answer, Measured, Outcome
from sarah.remote.remote_robot import RemoteRobot
from sarah.remote.requests import Request
from sarah.robot.description import describe_robot
from sarah.runs.config_files import read_config
from sarah.runs.session import SessionSpec
from sarah.runs.session_episodes import episodes_of_session, learned_of_session
from sarah.runs.session_folder import SessionFolder
from sarah.runs.session_robot import SessionRobot
from sarah.training.operate import SessionResult, operate, run_session
from sarah.training.session_learners import LEARNERS

KICKED = {"push": {"newtons": 400.0, "duration": 0.3}}
CONFIG = quick(minutes=0.3, robot=KICKED, changes=(Change(0.15, {"payload": 2.0}),))
USUAL = {"minutes": 0.3, "settle_seconds": 2.0, "measure_seconds": 4.0}
"""Times of windows that can be compared with those of the shipped recognition."""
SPEC = SessionSpec(SHIPPED, "careful", 3, CONFIG)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, SessionResult]:
    """The folder of a session with falls and a change, and its result."""
    path = tmp_path_factory.mktemp("sessions") / "whole"
    result = operate(SessionFolder.create(path, SPEC), SPEC)
    assert result.falls > 0 and result.windows[-1].changes == 1
    return path, result


@pytest.mark.parametrize("learner", LEARNERS)
def test_a_session_repeats_and_goes_on_from_half_of_its_journal(learner: str, tmp_path: Path) -> None:
    """The generators of the process are afterwards as before."""
    times: dict[str, Any] = dict(USUAL) if learner == "recognise" else {"minutes": 0.2}
    spec = dataclasses.replace(SPEC, learner=learner, config=dataclasses.replace(CONFIG, **times))
    folder = SessionFolder.create(tmp_path / "session", spec)
    states = (random.getstate, lambda: str(np.random.get_state()), lambda: torch.get_rng_state().tolist())
    before = [state() for state in states]
    with np.errstate(all="raise"):
        result = operate(folder, spec)
    assert [state() for state in states] == before
    assert run_session(spec) == result
    content = folder.journal_path.read_bytes()
    folder.journal_path.write_bytes(content[: len(content) // 2])
    assert operate(folder, spec) == result
    assert folder.journal_path.read_bytes() == content


def test_windows_that_are_known_are_not_simulated_again(
    whole: tuple[Path, SessionResult], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = SessionFolder(shutil.copytree(whole[0], tmp_path / "copy"))
    folder.result_path.unlink()
    monkeypatch.setattr("sarah.operation.robot_in_operation.RunningRobot", lambda *_: pytest.fail("it is known"))
    monkeypatch.setattr("sarah.pictures.session_figure.draw_session", lambda *_: None)
    assert operate(folder, SPEC) == whole[1]


def test_the_folder_has_a_table_a_picture_and_parameters(whole: tuple[Path, SessionResult]) -> None:
    path, result = whole
    assert len((path / "windows.csv").read_text().splitlines()) == 1 + len(result.windows)
    assert (path / "session.png").stat().st_size > 10_000
    left = json.loads((path / "parameters.json").read_text())
    assert left["control_rate"] == SPEC.config.robot.physics.control_rate
    assert tuple(left["parameters"].values()) == result.parameters == SessionFolder(path).parameters()
    assert SessionFolder.open(path).spec() == SPEC
    tags = sorted(EventAccumulator(str(path)).Reload().Tags()["scalars"])
    assert list(dict.fromkeys(tag.split("/")[0] for tag in tags))[:2] == ["operation", "parameters"]
    assert "operation/score" in tags


def test_damaged_files_are_named(whole: tuple[Path, SessionResult], tmp_path: Path) -> None:
    copy = shutil.copytree(whole[0], tmp_path / "copy")
    (copy / "parameters.json").write_text('{"parameters": null}')
    with pytest.raises(RunFolderError, match=r"parameters.json does not hold learned parameters"):
        SessionFolder(copy).parameters()
    head, _, *rows = (copy / "windows.csv").read_text().splitlines(keepends=True)
    mistakes = (([head], "has no windows to show yet"), ([head, *rows], "cannot be read: .*they are not in order"))
    for table, words in mistakes:
        (copy / "windows.csv").write_text("".join(table))
        for look in (learned_of_session, episodes_of_session):
            with pytest.raises(RunFolderError, match=words):
                look(copy)


def test_every_window_is_an_episode_to_look_at(whole: tuple[Path, SessionResult]) -> None:
    path, result = whole
    episodes = episodes_of_session(path)
    assert [episode.name for episode in episodes[:3]] == ["learned", "best", "0"]
    last = episodes[-1].spec
    assert (*last.config.stepping, *last.parameters) == result.windows[-1].parameters  # type: ignore[attr-defined]
    assert last.config.payload == 2.0
    learned = learned_of_session(path).spec
    assert (*learned.config.stepping, *learned.parameters) == result.parameters  # type: ignore[attr-defined]
    # A window names the one that goes on where it ends
    first, second = episodes[-2:]
    assert first.next_name == second.name and second.next_name is episodes[0].next_name is None
    assert first.of(dataclasses.replace(first.spec, seed=first.spec.seed + 1)).next_name is None


def test_every_window_can_be_played_as_it_was(whole: tuple[Path, SessionResult]) -> None:
    """In order and backwards, after a fall, and after the change: the recording disturbs nothing."""
    path, result = whole
    episodes = {episode.name: episode for episode in episodes_of_session(path)}
    assert SessionFolder(path).windows() == list(result.windows)
    for window in (*result.windows, *reversed(result.windows)):
        recorded = episodes[str(window.index)].recorded
        assert recorded is not None
        played = recorded()
        assert played.score == window.score and (played.termination == "fell") == window.fell
        assert played.trace is not None
        before = result.windows[window.index - 1] if window.index else None
        stands = before is None or before.fell or before.changes != window.changes
        assert played.trace.time[0] - window.begin == pytest.approx(1.0 if stands else 0.0)
        assert played.trace.time[-1] < window.end
        ceiling = highest_return(describe_robot().standing_height, CONFIG.measure_seconds)
        assert played.episode_return / ceiling == pytest.approx(window.score)
        assert played.duration == pytest.approx(len(played.trace) / 100)
        assert window.fell or played.duration == CONFIG.settle_seconds + CONFIG.measure_seconds


def test_a_change_that_never_came_is_none_in_the_end(tmp_path: Path) -> None:
    changes = (Change(0.05, {"payload": 5.0}), Change(0.1, {"payload": 60.0}))
    spec = SessionSpec(learner="none", config=quick(changes=changes))
    folder = SessionFolder.create(tmp_path / "late", spec)
    assert operate(folder, spec).windows[-1].changes == 1
    assert learned_of_session(folder.path).spec.config.payload == 5.0


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("learner: carefull", "unknown learner 'carefull', did you mean 'careful'?"),
        ("config: {changes: [{minute: 1}]}", "config.changes must hold minute and settings"),
        ("parameters: [1, 2]", "parameters must be 9 numbers"),
    ],
)
def test_mistakes_in_its_file_are_named(tmp_path: Path, content: str, words: str) -> None:
    path = tmp_path / "session.yaml"
    path.write_text("learner: gp")  # the former name of the careful learner
    assert read_config(SessionSpec, path).learner == SessionSpec().learner == "careful"
    path.write_text(content)
    with pytest.raises(ConfigurationError) as found:
        read_config(SessionSpec, path)
    assert words in str(found.value) and str(path) in str(found.value)


OF_METAL = SessionSpec(config=quick(minutes=0.2))
ROBOT = SessionRobot(endpoint="tcp/127.0.0.1:1", learner="me", robot="my_robot.py:ROBOT", host="desk")


class Formula:
    """A robot of metal, which is a formula: it earns more, the nearer V1 is to 1."""

    def __init__(self) -> None:
        self.requests: list[Request] = []

    def window(self, request: Request, seconds: float) -> Iterator[Answer | Measured]:
        self.requests.append(request)
        yield Answer(Outcome.APPLIED, "", False)
        if request.kind == "window":
            reward = 1.0 - abs(request.values["V1"] - 1.0) / BALANCE_PARAMETERS[0].width
            yield Measured(reward, None, False, (0.0,) * len(FELT), 1.02, 3.0, 300, 100)

    def close(self) -> None:
        pass


def made(robot: Formula, config: Any, seed: int, watch: Any, journal: Any, observers: Any) -> RemoteRobot:
    return RemoteRobot(config, lambda: robot, "me", watch, journal)


def with_robot(path: Path, robot: Formula, stop_after: int | None = None) -> Any:
    folder = SessionFolder.open(path) if path.exists() else SessionFolder.create(path, OF_METAL, robot=ROBOT)
    stop = interrupted_after(stop_after) if stop_after else lambda: False
    return operate(folder, OF_METAL, interrupted=stop, make_robot=partial(made, robot))


def test_its_folder_has_observed_rewards_where_there_is_no_score(tmp_path: Path, capsys: Any) -> None:
    robot = Formula()
    result = with_robot(tmp_path / "it", robot)
    folder = SessionFolder.open(tmp_path / "it")
    assert folder.robot == ROBOT and folder.windows() == list(result.windows) and len(result.windows) > 10
    rows = (tmp_path / "it/windows.csv").read_text().splitlines()
    assert all(row.split(",")[rows[0].split(",").index("score")] == "" for row in rows[1:])
    assert (tmp_path / "it/session.png").stat().st_size > 10_000
    left = robot.requests[-1]
    assert left.kind == "push" and tuple(left.values.values()) == result.parameters == folder.parameters()
    assert result.mean_score() == pytest.approx(sum(w.observed_reward for w in result.windows) / len(result.windows))
    summarise(result, None, OF_METAL, folder.path)
    assert f"observed    {result.mean_score():.3f}: " in capsys.readouterr().out
    _, best, first, *_ = episodes_of_session(folder.path)
    assert "observed reward 0." in first.label and first.recorded is None and first.next_name is None
    assert best.spec.parameters[0] == min(
        (window.parameters[5] for window in result.windows), key=lambda v: abs(v - 1.0)
    )


def test_it_goes_on_where_the_robot_is_and_asks_for_new_windows(tmp_path: Path) -> None:
    whole, robot = with_robot(tmp_path / "whole", Formula()), Formula()
    with pytest.raises(TrainingInterruptedError):
        with_robot(tmp_path / "it", robot, stop_after=4)
    assert [request.kind for request in robot.requests] == ["window"] * 4
    robot.requests.clear()
    assert with_robot(tmp_path / "it", robot) == whole
    assert [request.kind for request in robot.requests] == ["window"] * (len(whole.windows) - 4) + ["push"]
    for name in KEPT:
        assert (tmp_path / "it" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes(), name
    (tmp_path / "it/robot.yaml").unlink()
    with pytest.raises(ResumeError, match=r"robot is not known here, and my_robot.py:ROBOT in this session"):
        with_robot(tmp_path / "it", robot)
