"""A session whose robot runs by itself, and knows no true score: its folder, and how it goes on."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from operated import KEPT, interrupted_after, quick

from sarah.cli.operate_text import summarise
from sarah.control.parameters import BALANCE_PARAMETERS
from sarah.errors import ResumeError, TrainingInterruptedError
from sarah.operation.window import FELT
from sarah.remote.answers import Answer, Measured, Outcome
from sarah.remote.remote_robot import RemoteRobot
from sarah.remote.requests import Request
from sarah.runs.session import SessionSpec
from sarah.runs.session_episodes import episodes_of_session
from sarah.runs.session_folder import SessionFolder
from sarah.runs.session_robot import SessionRobot
from sarah.training.operate import operate

SPEC = SessionSpec(config=quick(minutes=0.2))
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


def run(path: Path, robot: Formula, stop_after: int | None = None) -> Any:
    folder = SessionFolder.open(path) if path.exists() else SessionFolder.create(path, SPEC, robot=ROBOT)
    stop = interrupted_after(stop_after) if stop_after else lambda: False
    return operate(folder, SPEC, interrupted=stop, make_robot=partial(made, robot))


def test_its_folder_has_observed_rewards_where_there_is_no_score(tmp_path: Path, capsys: Any) -> None:
    robot = Formula()
    result = run(tmp_path / "it", robot)
    folder = SessionFolder.open(tmp_path / "it")
    assert folder.robot == ROBOT and folder.windows() == list(result.windows) and len(result.windows) > 10
    rows = (tmp_path / "it/windows.csv").read_text().splitlines()
    assert all(row.split(",")[rows[0].split(",").index("score")] == "" for row in rows[1:])
    assert (tmp_path / "it/session.png").stat().st_size > 10_000
    left = robot.requests[-1]
    assert left.kind == "push" and tuple(left.values.values()) == result.parameters == folder.parameters()
    assert result.mean_score() == pytest.approx(sum(w.observed_reward for w in result.windows) / len(result.windows))
    summarise(result, None, SPEC, folder.path)
    assert f"observed    {result.mean_score():.3f}: " in capsys.readouterr().out
    _, best, first, *_ = episodes_of_session(folder.path)
    assert "observed reward 0." in first.label and first.recorded is None and first.next_name is None
    assert best.spec.parameters[0] == min(
        (window.parameters[5] for window in result.windows), key=lambda v: abs(v - 1.0)
    )


def test_it_goes_on_where_the_robot_is_and_asks_for_no_known_window_again(tmp_path: Path) -> None:
    whole, robot = run(tmp_path / "whole", Formula()), Formula()
    with pytest.raises(TrainingInterruptedError):
        run(tmp_path / "it", robot, stop_after=4)
    assert [request.kind for request in robot.requests] == ["window"] * 4
    robot.requests.clear()
    assert run(tmp_path / "it", robot) == whole
    assert [request.kind for request in robot.requests] == ["window"] * (len(whole.windows) - 4) + ["push"]
    for name in KEPT:
        assert (tmp_path / "it" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes(), name
    (tmp_path / "it/robot.yaml").unlink()
    with pytest.raises(ResumeError, match=r"robot is not known here, and my_robot.py:ROBOT in this session"):
        run(tmp_path / "it", robot)
