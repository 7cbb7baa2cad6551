"""The log of a robot says what it did, and what is played of it is near to that."""

import dataclasses
import errno
from io import FileIO
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hand_made import DT, heard
from laboratory import COARSE_PHYSICS, NEEDS_PYBULLET, turned
from listening import Rocking, steps
from logged import TARGETS, tick, write
from operated import quick

from sarah.control.pattern_generator import Phase, SteppingParameters
from sarah.control.supervisor_settings import SupervisorSettings
from sarah.drivers.driver import TimedReading
from sarah.drivers.loop import ControlLoop, Lockstep, LoopTick
from sarah.episode.episode import simulate
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE
from sarah.errors import ConfigurationError
from sarah.logs.controller_log import log_loop
from sarah.logs.played import Attitude, played, spec_of_log
from sarah.logs.reading import Log
from sarah.logs.robot_log import RobotLog
from sarah.logs.simulated import SimulationLog, log_episode
from sarah.logs.summary import summarise
from sarah.logs.topics import PARAMETER_CHANGES, TICKS, reading_of, targets_of
from sarah.operation.settings import PARAMETERS, SHIPPED
from sarah.robot.description import describe_robot
from sarah.robot.reading import STANDING, Side
from sarah.runs.session import SessionSpec
from sarah.training.operate import run_session

SPEC = EpisodeSpec(SHIPPED[5:], 3, BALANCE, BALANCE.config_of(BALANCE.episode, time_limit=2.5, physics=COARSE_PHYSICS))


def test_an_episodes_log_agrees_with_trace_and_leaves_the_result(tmp_path: Path) -> None:
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
    assert states[:2] == [(0.0, "standing", "set upright"), (1.0, "stepping", "stood for a second")]
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


@NEEDS_PYBULLET
def test_a_logged_robot_is_seen_as_it_moved(tmp_path: Path) -> None:
    config = BALANCE.config_of(BALANCE.episode, time_limit=6.0, dimensions={"torso_mass": 12.0})
    spec = EpisodeSpec(SHIPPED[5:], 3, BALANCE, config)
    path = tmp_path / "a.mcap"
    log_episode(spec, path, "test")
    logged = spec_of_log(path)
    assert logged.parameters == spec.parameters and logged.robot == spec.robot
    settings = vars(logged.config)
    assert settings["stepping"] == config.stepping and settings["push"].newtons == (0.0, 0.0)
    seen, known = played(path, logged.robot), simulate(spec, record_trace=True)
    assert seen.trace is not None and known.trace is not None and seen.trace.time[0] == 0.0
    estimated, true = (
        {name: getattr(trace, name)[-len(known.trace) :] for name in vars(trace)} for trace in (seen.trace, known.trace)
    )
    for name in ("targets", "pressures", "acceleration", "tilt", "rate", "phase", "stance"):
        assert np.array_equal(estimated[name], true[name]), name
    assert np.array_equal(estimated["steps_per_second"][200:], true["steps_per_second"][200:])
    turned = 2.0 * np.degrees(np.arccos(np.abs((estimated["orientation"] * true["orientation"]).sum(axis=1))))
    assert np.sqrt((turned**2).mean()) < 2.0
    moved = [one["position"] - (*one["position"][0, :2], 0.0) for one in (estimated, true)]
    assert np.abs(moved[0] - moved[1]).max(axis=0) == pytest.approx(0.0, abs=0.03)
    assert not seen.trace.push.any() and seen.steps_per_second == pytest.approx(seen.steps / 5.99)
    assert seen.steps == known.steps and seen.shifts_by_sensors == known.shifts_by_sensors
    assert "score" in seen.unknown and "steps" not in seen.unknown


def test_a_torso_is_pitched_and_then_rolled() -> None:
    attitude = Attitude([STANDING], 0.01)
    attitude.roll, attitude.pitch = 0.5, 0.3
    assert attitude.orientation == pytest.approx(turned(0.5, 0.3), abs=1e-12)


def test_a_robot_that_was_put_up_anew_begins_at_its_place(tmp_path: Path) -> None:
    with RobotLog(tmp_path / "a.mcap", {}, waits=True) as log:
        for number in (*range(29_900, 30_050), *range(30_300, 30_350)):
            tick(log, number)
    trace = played(tmp_path / "a.mcap", describe_robot()).trace
    assert trace is not None and np.any(trace.position[149, :2]) and not np.any(trace.position[150, :2])


def test_a_log_that_cannot_be_played_says_why(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write(tmp_path / "a.mcap")
    monkeypatch.setattr("sarah.logs.played.LONGEST_SECONDS", 0.5)
    with pytest.raises(ConfigurationError, match=r"longer than 0.5 s: play a part of it, by .*a.mcap --cut 0"):
        played(path, describe_robot())
    with RobotLog(tmp_path / "b.mcap", {}, waits=True) as log:
        for number in range(3):
            log.tick(number * DT, None, 0.0, TARGETS, "standing", Phase.STAND, Side.LEFT, 0.0, 0.0, 0.0)
    with pytest.raises(ConfigurationError, match=r"b\.mcap has no readings to play"):
        played(tmp_path / "b.mcap", describe_robot())
    with pytest.raises(ConfigurationError, match=r"b\.mcap does not say which P1 the robot had"):
        spec_of_log(tmp_path / "b.mcap")


class Stalling(Rocking):
    """A robot that stands still after nine seconds."""

    def read(self) -> TimedReading:
        self.ticks += 1
        return TimedReading(heard(self.ticks, still=self.ticks > 900), self.now())


def test_parameters_from_outside_and_those_put_back_are_logged(tmp_path: Path) -> None:
    supervisor, others = steps(), SteppingParameters(2.0, 2.0, 2.0, 2.0, 2.0)
    own, balance = supervisor.asked

    def push(tick: LoopTick) -> None:
        if round(tick.seconds / DT) == 850:
            supervisor.set_parameters(others)

    loop = ControlLoop(Stalling(), supervisor, own, balance, DT, Lockstep(), [push])
    path = tmp_path / "run.mcap"
    with RobotLog(path, {}, waits=True) as log:
        log_loop(loop, log, "sarah-robot")
        for _ in range(1250):
            loop.tick()
    log_read = Log(path)
    found = [log_read.values(one) for one in log_read.messages() if one.topic == PARAMETER_CHANGES.name]
    assert [(one["by"], one["P1"], one["V1"]) for one in found] == [
        ("sarah-robot", 0.4, balance.V1),
        ("push", 2.0, balance.V1),
        ("supervisor", 0.4, balance.V1),
    ]
    assert [round(one["seconds"], 6) for one in found[:2]] == [1.0, 8.5]
    assert found[2]["reason"] == "the parameters before are back: no step for 2.0 s"
