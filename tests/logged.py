"""A log of known numbers, which tests of reading and of the command share."""

from pathlib import Path

import pytest
from hand_made import DT, rocking

from sarah.control.pattern_generator import Phase, PhaseChange
from sarah.logs.robot_log import RobotLog
from sarah.operation.settings import PARAMETERS, SHIPPED
from sarah.operation.window import FELT, Window
from sarah.robot.reading import SensorReading, Side

TARGETS = (0.01, 0.02, 0.03, 0.04, 0.005, 0.006)
NAMED = {parameter.name: value for parameter, value in zip(PARAMETERS, SHIPPED, strict=True)}


def tick(log: RobotLog, number: int, reading: SensorReading | None = None, late: float = 0.0) -> None:
    """Log a tick of a robot that steps."""
    seconds, reading = number * DT, reading or rocking(number)
    log.tick(seconds, reading, seconds - 0.001, TARGETS, "stepping", Phase.SHIFT, Side.LEFT, 0.5, -0.25, late)


def write(path: Path, ticks: int = 100) -> Path:
    """Write a log of some ticks, with a chunk for each message, and a step in each quarter of a second.

    The clock ended the first step, and the eighth tick was late.
    """
    with pytest.MonkeyPatch.context() as patch, RobotLog(path, {"program": "a test"}, waits=True) as log:
        patch.setattr("sarah.logs.chunk_file.CHUNK_SECONDS", 0.0)
        log.state(0.0, "stepping", "", "stood for a second")
        log.parameters(0.0, NAMED, 0.0, "careful", True, "")
        for number in range(ticks):
            seconds = number * DT
            tick(log, number, late=0.003 if number == 7 else 0.0001)
            if number % 25 == 24:
                log.phase_change(seconds, PhaseChange(Phase.LAND, by_sensors=number > 24, is_step=True), Side.RIGHT)
        log.parameters(seconds, {"P1": 9.0}, 0.1, "someone", False, "P1 must be between 0 and 2, not 9.0")
        window = Window(0, 0.0, seconds, 0, SHIPPED, 0.9, 0.8, False, tuple(map(float, range(len(FELT)))))
        log.window(seconds, window.plain())
    return path
