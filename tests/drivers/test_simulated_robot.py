"""The simulated robot as a driver: the loop is outside of it, and the episode is the same."""

import contextlib
import dataclasses
import itertools
import re
from typing import Any

import numpy as np
import pytest
from laboratory import need

from sarah.control.supervisor import State, Supervisor
from sarah.drivers.driver import Driver, TimedReading
from sarah.drivers.driver_file import read_driver
from sarah.drivers.faults import FAULTS
from sarah.drivers.loop import ControlLoop, Lockstep, LoopTick, controller_for
from sarah.drivers.real_time import RealTime
from sarah.drivers.simulated_robot import NO_FAULT, FaultPlan, SimulatedRobot, simulated_loop
from sarah.episode.episode import simulate
from sarah.episode.push import NO_PUSH, Push
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import EpisodeSpec
from sarah.episode.task_answers import controller_of
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.errors import ConfigurationError
from sarah.robot.reading import STANDING, SensorReading, Targets

V = (0.7, 0.4, 0.7, -0.4)


def supervised(config: BalanceConfig) -> BalanceConfig:
    return dataclasses.replace(config, supervisor=dataclasses.replace(config.supervisor, enabled=True))


def run(config: BalanceConfig, plan: FaultPlan = NO_FAULT) -> tuple[SimulatedRobot, list[LoopTick]]:
    ticks: list[LoopTick] = []
    robot, loop = simulated_loop(EpisodeSpec(V, 3, BALANCE, config), plan, None, [ticks.append], record_trace=True)
    loop.run()
    robot.close()
    return robot, ticks


def test_in_lockstep_it_is_the_episode_to_the_last_byte(engine: Any) -> None:
    config = BalanceConfig(engine=engine, push=Push(newtons=60.0), time_limit=4.0)
    expected: EpisodeResult = simulate(EpisodeSpec(V, 3, BALANCE, config), record_trace=True)
    for one in (config, supervised(config)):
        found = run(one)[0].result()
        assert found.trace is not None and expected.trace is not None
        for name, values in vars(expected.trace).items():
            assert values.tobytes() == vars(found.trace)[name].tobytes(), name
        assert dataclasses.replace(found, trace=None) == dataclasses.replace(expected, trace=None)


def test_a_supervised_episode_is_the_same_where_nothing_fails(engine: Any) -> None:
    config = BalanceConfig(engine=engine, push=NO_PUSH, time_limit=4.0)
    perfect = dataclasses.replace(config, randomisation=dataclasses.replace(config.randomisation, enabled=False))
    for one in (config, perfect):  # signals without noise are not taken for frozen ones
        assert simulate(EpisodeSpec(V, 0, BALANCE, supervised(one))) == simulate(EpisodeSpec(V, 0, BALANCE, one))


def test_without_its_gyroscope_it_stops_and_stays_in_place() -> None:
    need("mujoco")
    config = supervised(BalanceConfig(engine="mujoco", push=NO_PUSH, time_limit=12.0))
    robot, ticks = run(config, FaultPlan(FAULTS["rate about y: stuck"], 2.0))
    changes = {tick.seconds: tick.controller.state for tick in ticks if isinstance(tick.controller, Supervisor)}
    assert robot.ended == "time_limit" and list(changes.values())[-1] is State.STANDING
    x, y, _ = robot.result().final_position
    assert abs(x) < 0.15 and abs(y) < 0.15


def test_a_missed_tick_keeps_the_targets_and_time_goes_on() -> None:
    need("mujoco")
    config = BalanceConfig(engine="mujoco", push=NO_PUSH, time_limit=3.0)
    robot, ticks = run(config, FaultPlan(FAULTS["ten ticks are missed, once"], 1.0))
    seconds = [tick.seconds for tick in ticks]
    gaps = [round(later - now, 9) for now, later in itertools.pairwise(seconds)]
    assert sorted(gaps)[-2:] == [0.01, 0.11] and seconds[gaps.index(0.11)] == pytest.approx(1.99)
    trace = robot.result().trace
    assert trace is not None and len({tuple(row) for row in trace.targets[99:110]}) == 1


class Clock:
    """A clock that stands still unless somebody sleeps, or looks at it."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        self.now += 1e-5
        return self.now

    def sleep(self, seconds: float) -> None:
        self.now += seconds


def test_deadlines_do_not_drift_and_passed_ones_are_left_out() -> None:
    clock = Clock()
    pacing = RealTime(0.01, clock, clock.sleep)
    lateness = []
    for tick in range(100):
        lateness.append(pacing.wait())
        clock.sleep(0.025 if tick == 50 else 0.004)  # the work
    assert clock.now == pytest.approx(0.99 + 0.004 + 0.01, abs=1e-3)  # one of 102 deadlines is gone
    assert [tick for tick, late in enumerate(lateness) if late > 0.001] == [51]
    assert lateness[51] == pytest.approx(0.015, abs=1e-3)


class Robot(Driver):
    """A robot of somebody's, which takes a while to read its first signals."""

    limits = ((-0.5, 0.5),) * 6

    def __init__(self) -> None:
        self.sent: list[Targets] = []
        self.ticks = 0

    def now(self) -> float:
        return 0.01 * self.ticks

    def read(self) -> TimedReading | None:
        self.ticks += 1
        if self.ticks > 300:
            self.ended = "emergency stop"
        noise = 0.001 * (self.ticks % 7)
        reading: SensorReading = STANDING._replace(acceleration=(noise, noise, 9.81 + noise), angular_rate=(noise,) * 3)
        return TimedReading(reading, self.now()) if self.ticks > 20 else None

    def send(self, targets: Targets) -> None:
        self.sent.append(targets)


def drive(robot: Robot, *observers: Any, is_read_only: bool = False) -> None:
    config = supervised(BalanceConfig())
    stepping, balance = controller_of(BALANCE, V, config)
    assert balance is not None
    controller = controller_for(config, robot.limits)
    ControlLoop(robot, controller, stepping, balance, 0.01, Lockstep(), observers, is_read_only=is_read_only).run()


def test_a_robot_of_ones_own_needs_to_read_and_to_send() -> None:
    for is_read_only in (False, True):
        drive(robot := Robot(), is_read_only=is_read_only)
        assert len(robot.sent) == (0 if is_read_only else 300)


def test_a_clock_that_jumps_back_turns_no_time_of_the_loop_back(monkeypatch: pytest.MonkeyPatch) -> None:
    robot, ticks = Robot(), list[LoopTick]()
    monkeypatch.setattr(robot, "now", lambda: np.float64(0.01 * robot.ticks - (1000.0 if robot.ticks > 150 else 0.0)))
    drive(robot, ticks.append)
    assert [tick.seconds for tick in ticks] == pytest.approx([0.01 * index for index in range(300)])
    assert {type(tick.seconds) for tick in ticks} == {float}


def test_a_driver_is_found_in_a_file(tmp_path: Any) -> None:
    file = tmp_path / "my_robot.py"
    lines = ("from sarah.drivers.driver import Driver", "class Mine(Driver):", "    def read(self): return None",
             "    def send(self, targets): pass", "ROBOT, FREE = Mine(), Mine()",
             "ROBOT.limits = [(-1, 1)] * 6")  # fmt: skip
    file.write_text("\n".join(lines))
    assert isinstance(read_driver(f"{file}:ROBOT"), Driver)
    file.with_name("broken.py").write_text("import nothing_of_that_name")
    for reference, words in (
        (f"{file}:ROBOTT", f"unknown driver in {file} 'ROBOTT', did you mean 'ROBOT'?"),
        (f"{file}:FREE", f"{file}:FREE needs limits: lowest and highest position of each of left_hip_abduction, "),
        (str(file), "--driver must be a file and a name, such as my_robot.py:ROBOT, not"),
        ("none.py:ROBOT", "there is no file none.py with a driver"),
        (f"{tmp_path}/broken.py:ROBOT", f"{tmp_path}/broken.py, line 1: ModuleNotFoundError"),
    ):
        with pytest.raises(ConfigurationError, match=re.escape(words)):
            read_driver(reference)


def test_one_that_goes_on_is_put_up_and_steps_again_when_asked(engine: Any) -> None:
    config = supervised(BalanceConfig(engine=engine, push=Push(newtons=800.0, at_seconds=(2.0, 2.0)), time_limit=2.5))
    robot, loop = simulated_loop(EpisodeSpec(V, 3, BALANCE, config), goes_on=True)
    lay, states = list[bool](), list[State]()
    with contextlib.closing(robot):
        for tick in range(900):
            assert loop.tick()
            assert isinstance(loop.controller, Supervisor)
            lay.append(robot.has_fallen)
            states.append(loop.controller.state)
            if tick == 600:
                assert loop.controller.state is State.FALLEN and loop.controller.is_upright
                loop.controller.step()
    assert not any(lay[:200]) and any(lay) and not any(lay[600:])
    assert states[250] is State.FALLEN and states[-1] is State.STEPPING and robot.position[2] > 0.5


def test_one_that_goes_on_ends_when_there_are_no_ticks_any_more() -> None:
    need("mujoco")
    plan = FaultPlan(FAULTS["no tick any more, targets stay"], 0.1)
    config = supervised(BalanceConfig(engine="mujoco", time_limit=1.5))
    robot, loop = simulated_loop(EpisodeSpec(V, 3, BALANCE, config), plan, goes_on=True)
    with contextlib.closing(robot):
        loop.run()
    assert loop.ticks == 110 and robot.ended
