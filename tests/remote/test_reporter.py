"""Telemetry by hand-made ticks: when it is due, and what it counts."""

from types import SimpleNamespace
from typing import Any

import pytest
from hand_made import BALANCE

from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import Phase, PhaseChange, SteppingParameters
from sarah.control.supervisor import State, StateChange
from sarah.drivers.loop import LoopTick
from sarah.remote.reporter import Reporter
from sarah.robot.reading import STANDING, Side

STEP = PhaseChange(Phase.LAND, by_sensors=True, is_step=True)


def test_it_is_due_twenty_times_a_second_and_counts_steps_and_late_ticks() -> None:
    supervisor: Any = SimpleNamespace(
        state=State.STEPPING,
        phase=Phase.LIFT,
        stance=Side.LEFT,
        tilt=1.23456,
        asked=(SteppingParameters(*PAPER_STEPPING), BALANCE),
    )
    now, due = 0.0, []
    reporter = Reporter(lambda: now)
    for number in range(500):
        now = 0.01 * number
        supervisor.state_change = StateChange(State.STEPPING, State.STANDING, "stood") if number == 100 else None
        change = STEP if number % 50 == 0 else None
        tick = LoopTick(now, None, 0.0, supervisor, change, 0.003 if number in (7, 8) else 0.001)
        if reporter.tick(tick, supervisor):
            due.append(now)
    assert len(due) == pytest.approx(100, abs=1) and due[0] == 0.0
    telemetry = reporter.telemetry(tick, supervisor)
    assert (telemetry.tick, telemetry.seconds, telemetry.late_ticks) == (499, 4.99, 2)
    assert (telemetry.steps_per_second, telemetry.tilt) == (2.0, 1.2346)
    assert (telemetry.state, telemetry.reason, telemetry.phase) == ("stepping", "stood", "lift")
    assert telemetry.parameters["P2"] == 1.3 and telemetry.parameters["V1"] == BALANCE.V1
    assert telemetry.stance == -1 and telemetry.reading is None
    read = reporter.telemetry(tick._replace(reading=STANDING), supervisor).reading
    assert read is not None and read["acceleration"] == [0.0, 0.0, 9.81] and len(read["joints"]) == 6
    now = 100.0  # after a pause, what was not sent is not made up for
    assert [reporter.tick(tick, supervisor) for _ in range(3)] == [True, False, False]
