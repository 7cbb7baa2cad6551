"""What is played of a log is near to what the robot did."""

from pathlib import Path

import numpy as np
import pytest
from hand_made import DT
from laboratory import turned
from logged import TARGETS, tick, write

from sarah.control.pattern_generator import Phase
from sarah.episode.episode import simulate
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE
from sarah.errors import ConfigurationError
from sarah.logs.played import Attitude, played, spec_of_log
from sarah.logs.robot_log import RobotLog
from sarah.logs.simulated import log_episode
from sarah.operation.settings import SHIPPED
from sarah.robot.description import describe_robot
from sarah.robot.reading import STANDING, Side


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
