"""How late are the ticks of sarah-robot, and what does a tick cost?

A loop that only waits for the same deadlines runs in turn with the loops of a simulated robot, in the same process and
scheduling class. A tick is late if it begins more than 2 ms after its deadline.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

from pandas import DataFrame

from benchmarks.timing import Timing
from experiments.experiment import EPISODE
from experiments.record import Row
from experiments.tables import table
from sarah.drivers.loop import LoopTick
from sarah.drivers.real_time import LATE_SECONDS, RealTime, undisturbed
from sarah.drivers.simulated_robot import simulated_loop
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.push import NO_PUSH
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE
from sarah.logs.controller_log import log_loop
from sarah.logs.robot_log import RobotLog

SHIPPED = PARAMETER_SETS["balance"].spec
BARE, PLAIN, SUPERVISED, LOGGED = "waits only", "controller", "with supervisor", "with supervisor and log"


class Lateness(NamedTuple):
    """Ticks of a loop, and how late they were."""

    ticks: int
    late: int
    worst: float  # s


@dataclass(frozen=True)
class RealTimeLoops(Timing):
    """Ticks of a simulated robot's control loop in real time.

    :param rounds: number of turns that each loop has
    :param seconds: duration of a turn, in s
    """

    depends_on = (*EPISODE, "sarah/drivers", "sarah/logs")
    rounds: int = 20
    seconds: float = 30.0

    def cases(self) -> list[Row]:
        """All loops at once, as they take turns."""
        return [{"turn_seconds": self.seconds}]

    def rows(self, turn_seconds: float) -> Iterator[Row]:
        """Lateness of each loop.

        :param turn_seconds: duration of a turn, in s
        """
        loops = (BARE, PLAIN, SUPERVISED, LOGGED)
        turns: dict[str, list[Lateness]] = {name: [] for name in loops}
        for number in range(self.rounds):
            for name in loops:
                turns[name].append(_bare(turn_seconds) if name == BARE else _robot(name, turn_seconds, number))
        for name, found in turns.items():
            ticks = sum(one.ticks for one in found)
            yield {
                "loop": name,
                "ticks": ticks,
                "late": sum(one.late for one in found),
                "worst_ms": 1000.0 * max(one.worst for one in found),
            }


def _bare(seconds: float) -> Lateness:
    """A loop that only waits."""
    dt = SHIPPED.config.physics.control_dt
    with undisturbed():
        pacing, late = RealTime(dt), []
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            late.append(pacing.wait())
    return _lateness(late)


def _robot(name: str, seconds: float, seed: int) -> Lateness:
    """The loop of a simulated robot."""
    usual = BALANCE.config_of(SHIPPED.config, push=NO_PUSH, time_limit=seconds, box_half_width=100.0)
    supervisor = replace(usual.supervisor, enabled=name != PLAIN)
    spec = EpisodeSpec(SHIPPED.parameters, seed, BALANCE, replace(usual, supervisor=supervisor))
    late: list[float] = []

    def observe(tick: LoopTick) -> None:
        late.append(tick.late_seconds)

    robot, loop = simulated_loop(spec, pacing=RealTime(usual.physics.control_dt), observers=[observe])
    with tempfile.TemporaryDirectory() as folder:
        log = RobotLog(Path(folder) / "log.mcap", {}) if name == LOGGED else None
        if log is not None:
            log_loop(loop, log, "benchmark")
        with undisturbed():
            loop.run()
        if log is not None:
            log.close()
    robot.close()
    return _lateness(late)


def _lateness(late: list[float]) -> Lateness:
    return Lateness(len(late), sum(one > LATE_SECONDS for one in late), max(late))


FULL = RealTimeLoops()
QUICK = RealTimeLoops(rounds=1, seconds=1.5)


def lateness(rows: DataFrame) -> str:
    """Late ticks of each loop."""
    rows = rows.assign(late_share=rows["late"] / rows["ticks"])
    caption = (
        f"Ticks of control loops in real time that began more than {1000 * LATE_SECONDS:g} ms late. Each loop had "
        f"{FULL.rounds} turns of {FULL.seconds:g} s."
    )
    return table(rows, ["loop", "ticks", "late", "late_share", "worst_ms"], caption, late_share=".3%", worst_ms=".1f")
