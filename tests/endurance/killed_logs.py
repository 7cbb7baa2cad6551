"""What does a log lose when its process is killed?

A process forked from this one runs a loop of 100 ticks per second that logs, until it is killed (SIGKILL) at a random
moment. Its log is then read.
"""

import multiprocessing
import random
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from multiprocessing.sharedctypes import Synchronized
from pathlib import Path

from pandas import DataFrame

from benchmarks.timing import Timing
from experiments.record import ResultError, Row
from experiments.tables import table
from sarah.control.pattern_generator import Phase
from sarah.logs.reading import Log
from sarah.logs.robot_log import RobotLog
from sarah.logs.summary import summarise
from sarah.robot.reading import STANDING, Side

LONGEST = 3.0
"""Latest moment of a kill after the beginning, in s."""
MOST_LOST = 1.1
"""Time before a kill that may be lost, in s: a chunk, and what is on its way."""
DT = 0.01
FORK = multiprocessing.get_context("fork")


@dataclass(frozen=True)
class KilledLogs(Timing):
    """Processes that log, each killed at a random moment.

    :param kills: number of processes
    """

    depends_on = ("sarah/logs",)
    kills: int = 100

    def cases(self) -> list[Row]:
        return [{"ticks_per_second": round(1.0 / DT)}]

    def rows(self, ticks_per_second: int) -> Iterator[Row]:
        lost = [seconds_lost(seed) for seed in range(self.kills)]
        yield {"kills": self.kills, "mean_lost_s": sum(lost) / len(lost), "most_lost_s": max(lost)}


FULL = KilledLogs()
QUICK = KilledLogs(kills=1)


def seconds_lost(seed: int) -> float:
    """Time that is missing at the end of the log of a killed process, in s."""
    logged: Synchronized[int] = FORK.Value("q", 0)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "run.mcap")
        process = FORK.Process(target=_log, args=(path, logged))
        process.start()
        while logged.value == 0:
            time.sleep(DT)
        time.sleep(random.Random(seed).uniform(0.0, LONGEST))
        process.kill()
        process.join()
        summary = summarise(Log(path), whole=True)
    lost = DT * (logged.value - summary.ticks)
    if summary.missing.total() or lost > MOST_LOST:
        raise ResultError(f"seed {seed}: {lost:.2f} s are lost, and {summary.missing.total()} messages are missing")
    return lost


def _log(path: Path, logged: "Synchronized[int]") -> None:
    """Log ticks by absolute deadlines until something kills the process."""
    with RobotLog(path, {}) as log:
        begin = time.monotonic()
        while True:
            seconds = DT * logged.value
            time.sleep(max(0.0, begin + seconds - time.monotonic()))
            log.tick(seconds, STANDING, seconds, STANDING.joints, "standing", Phase.STAND, Side.LEFT, 0.0, 0.0, 0.0)
            logged.value += 1


def losses(rows: DataFrame) -> str:
    """What the logs of killed processes lost."""
    caption = "Processes that were killed while they logged, and what their logs lack at their end."
    columns = ["ticks_per_second", "kills", "mean_lost_s", "most_lost_s"]
    return table(rows, columns, caption, mean_lost_s=".2f", most_lost_s=".2f")
