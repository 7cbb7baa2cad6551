"""The log of a control loop: which parameters its robot had, and who gave them to it."""

from pathlib import Path

from hand_made import BALANCE, DT, heard
from listening import Rocking

from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import SteppingParameters
from sarah.control.supervisor import Supervisor
from sarah.control.watches import SupervisorSettings
from sarah.drivers.driver import TimedReading
from sarah.drivers.loop import ControlLoop, Lockstep, LoopTick
from sarah.logs.controller_log import log_loop
from sarah.logs.reading import Log
from sarah.logs.robot_log import RobotLog
from sarah.logs.topics import PARAMETER_CHANGES


class Stalling(Rocking):
    """A robot that stands still after nine seconds."""

    def read(self) -> TimedReading:
        self.ticks += 1
        return TimedReading(heard(self.ticks, still=self.ticks > 900), self.now())


def test_parameters_from_outside_and_those_put_back_are_logged(tmp_path: Path) -> None:
    own, others = SteppingParameters(*PAPER_STEPPING), SteppingParameters(2.0, 2.0, 2.0, 2.0, 2.0)
    supervisor = Supervisor(own, BALANCE, DT, settings=SupervisorSettings(enabled=True))

    def push(tick: LoopTick) -> None:
        if round(tick.seconds / DT) == 850:
            supervisor.set_parameters(others)

    loop = ControlLoop(Stalling(), supervisor, own, BALANCE, DT, Lockstep(), [push])
    path = tmp_path / "run.mcap"
    with RobotLog(path, {}, waits=True) as log:
        log_loop(loop, log, "sarah-robot")
        for _ in range(1250):
            loop.tick()
    log_read = Log(path)
    found = [log_read.values(one) for one in log_read.messages() if one.topic == PARAMETER_CHANGES.name]
    assert [(one["by"], one["P1"], one["V1"]) for one in found] == [
        ("sarah-robot", 0.4, BALANCE.V1),
        ("push", 2.0, BALANCE.V1),
        ("supervisor", 0.4, BALANCE.V1),
    ]
    assert [round(one["seconds"], 6) for one in found[:2]] == [1.0, 8.5]
    assert found[2]["reason"] == "the parameters before are back: no step for 2.0 s"
