"""The log of a simulated robot says what its record says, and changes nothing."""

import dataclasses
import errno
from io import FileIO
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from laboratory import COARSE_PHYSICS
from operated import quick

from sarah.control.supervisor_settings import SupervisorSettings
from sarah.episode.episode import simulate
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE
from sarah.errors import ConfigurationError
from sarah.logs.reading import Log
from sarah.logs.robot_log import RobotLog
from sarah.logs.simulated import SimulationLog, log_episode
from sarah.logs.summary import summarise
from sarah.logs.topics import TICKS, reading_of, targets_of
from sarah.operation.settings import PARAMETERS, SHIPPED
from sarah.runs.session import SessionSpec
from sarah.training.operate import run_session

SPEC = EpisodeSpec(SHIPPED[5:], 3, BALANCE, BALANCE.config_of(BALANCE.episode, time_limit=2.5, physics=COARSE_PHYSICS))


def test_an_episodes_log_agrees_with_its_trace_and_leaves_its_result(tmp_path: Path) -> None:
    logged = log_episode(SPEC, tmp_path / "a.mcap", "test")
    known = simulate(SPEC, record_trace=True)
    assert logged == known and known.trace is not None
    log = Log(tmp_path / "a.mcap")
    values = [log.values(message) for message in log.messages() if message.topic == TICKS.name]
    readings = [reading_of(one) for one in values]
    assert {one["state"] for one in values[:100]} == {"standing"}
    assert np.allclose([one["seconds"] for one in values[100:]], known.trace.time, rtol=0.0, atol=1e-9)
    for name in ("pressures", "acceleration", "angular_rate"):
        assert np.array_equal([getattr(one, name) for one in readings[100:]], getattr(known.trace, name))
    assert [one["phase"] for one in values[100:]] == list(known.trace.phase)
    assert [one["tilt"] for one in values[100:]] == list(known.trace.tilt)
    targets = [[value for name, value in one.items() if name.startswith("target_")] for one in values[100:]]
    assert np.array_equal(targets, known.trace.targets)
    summary = summarise(log)
    assert summary.steps == known.steps and summary.parameters[0]["seconds"] == 1.0
    assert [summary.parameters[0][one.name] for one in PARAMETERS] == list(SHIPPED)
    states = [(one["seconds"], one["state"], one["reason"]) for one in summary.states]
    assert states[:2] == [(0.0, "standing", "put up"), (1.0, "stepping", "stood for a second")]
    assert states[2] == (2.5, "ended", "ran to the end")


def test_the_states_of_a_supervised_robot_are_its_supervisors(tmp_path: Path) -> None:
    config = dataclasses.replace(SPEC.config, supervisor=SupervisorSettings(enabled=True, stepless_seconds=0.2))
    log_episode(dataclasses.replace(SPEC, config=config), tmp_path / "a.mcap", "test")
    summary = summarise(log := Log(tmp_path / "a.mcap"))
    states = [(one["before"], one["state"]) for one in summary.states]
    assert states == list(pairwise(("", "standing", "stepping", "stopping", "standing", "ended")))
    assert [one["reason"] for one in summary.states[1:4]] == [
        "stood for a second",
        "no step for 0.2 s",
        "stopped: no step for 0.2 s",
    ]
    ticks = [log.values(message) for message in log.messages() if message.topic == TICKS.name]
    stopped = [one for one in ticks if one["seconds"] > summary.states[3]["seconds"]]
    assert {one["state"] for one in stopped} == {"standing"} and not any(targets_of(stopped[-1]) or (1.0,))


def test_a_sessions_log_has_its_windows_and_leaves_them(tmp_path: Path) -> None:
    config = quick(0.15, {"push": {"newtons": (250.0, 250.0)}})
    spec = SessionSpec(SHIPPED, "random", 1, config)
    windows = run_session(spec).windows
    with RobotLog(tmp_path / "a.mcap", {}, waits=True) as log:
        observer = SimulationLog(log, "random")
        logged = run_session(spec, observer.window, observers=[observer]).windows
    assert logged == windows and any(window.fell for window in windows)
    summary = summarise(Log(tmp_path / "a.mcap"), whole=True)
    assert [one["observed_reward"] for one in summary.windows] == [window.observed_reward for window in windows]
    assert [one["seconds"] for one in summary.windows] == [window.end for window in windows]
    assert [one["asked_seconds"] for one in summary.parameters] == [window.begin for window in windows]
    simulated = sum(window.seconds - 2.0 * window.fell for window in windows)  # a fall costs two seconds
    assert summary.ticks == round(100 * simulated)
    fallen = [one["seconds"] for one in summary.states if one["state"] == "fallen"]
    assert fallen == [round(window.end - 2.0, 9) for window in windows if window.fell]


class FullDisk(FileIO):
    """A file that no byte can be written to."""

    def write(self, data: object) -> int:
        raise OSError(errno.ENOSPC, "No space left on device")


def test_a_full_disk_is_said_after_the_episode(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sarah.logs.chunk_file.FileIO", FullDisk)
    with pytest.raises(ConfigurationError, match=r"cannot write .*a.mcap to its end: No space left on device"):
        log_episode(SPEC, tmp_path / "a.mcap", "test")
