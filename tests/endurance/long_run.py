"""Do memory and open files stay the same in long runs?

Many episodes in one process, and a training with workers. Episodes are short ones: what leaks does so with every world
that is built, not with every second simulated.
"""

import gc
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import psutil
from matplotlib.figure import Figure
from pandas import DataFrame

from benchmarks.timing import Timing
from experiments.experiment import TRAINING
from experiments.record import ResultError, Row
from experiments.shapes import legend, lines, panels
from experiments.tables import shown, table
from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.episode import simulate
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.workers import Workers
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.physics import Physics
from sarah.training.train import train

from .killed_workers import worker_processes

SHORT = EpisodeConfig(time_limit=1.3, physics=Physics(rate=100, solver_iterations=5))
LOOKS = 8
"""Number of looks at memory and open files, after the one at the beginning of a training."""
ALONE = "episodes in one process"


@dataclass(frozen=True)
class LongRun(Timing):
    """Memory and open files along a run.

    :param episodes: number of episodes in one process
    :param budget: number of episodes of the training
    :param largest_growth: growth of a process's memory, in MiB, beyond which it does not stay the same
    """

    depends_on = TRAINING
    episodes: int = 2000
    budget: int = 400
    largest_growth: float = 20.0

    def cases(self) -> list[Row]:
        return [{"run": ALONE}, {"run": "training"}]

    def rows(self, run: str) -> Iterator[Row]:
        found = list(self._episodes() if run == ALONE else self._training())
        grown = growths(DataFrame(found).assign(run=run)).growth_mib.max()
        if grown > self.largest_growth:
            raise ResultError(f"{run}: a process grew by {grown:.0f} MiB")
        yield from found

    def _episodes(self) -> Iterator[Row]:
        for index in range(self.episodes):
            simulate(EpisodeSpec(PAPER_STEPPING, index, config=SHORT))
            if (index + 1) % max(self.episodes // LOOKS, 1) == 0:
                gc.collect()
                yield usage(index + 1, "process", psutil.Process())

    def _training(self) -> list[Row]:
        config, step = TrainingConfig(episodes=self.budget, episode=SHORT), self.budget // LOOKS
        found: list[Row] = []

        def look() -> bool:
            due = step * (len(found) // 3)
            if sum(1 for _ in run.episodes()) >= due:
                processes = [psutil.Process(), *worker_processes(workers)]
                found.extend(map(usage, [due] * 3, ("training", "worker 1", "worker 2"), processes))
            return False  # the training, which asks whether to stop, goes on

        with tempfile.TemporaryDirectory() as folder, Workers(2) as workers:
            run = RunFolder.create(Path(folder) / "run", config)
            train(config, run, workers, interrupted=look)
        return found


FULL = LongRun()
QUICK = LongRun(episodes=16, budget=8, largest_growth=200.0)


def usage(episodes: int, name: str, process: psutil.Process) -> Row:
    """Columns of a process."""
    memory, files = process.memory_info().rss / 2**20, process.num_fds()
    return {"episodes": episodes, "process": name, "memory_mib": memory, "open_files": files}


def growths(rows: DataFrame) -> DataFrame:
    """What each process takes at the first look after the beginning, and at the last."""
    processes = rows[rows.episodes > 0].groupby(["run", "process"], sort=False)
    found = processes.first().join(processes.last().add_prefix("later_")).reset_index()
    return found.assign(growth_mib=found.later_memory_mib - found.memory_mib)


def answer(rows: DataFrame) -> str:
    """By how much processes grow."""
    found = growths(rows)
    files = (found.later_open_files - found.open_files).max()
    return (
        "Processes of long runs hardly grow. From few episodes to many, memory grows by at most "
        f"{shown(found.growth_mib.max(), '.0f')} MiB ({shown((found.growth_mib / found.memory_mib).max(), '.0%')}), "
        f"and {f'the number of open files by at most {files}' if files > 0 else 'no process opens more files'}."
    )


def figure(rows: DataFrame) -> Figure:
    """Memory along the training."""
    drawn, (axis,) = panels(1, 0.3)
    lines(axis, rows[rows.run == "training"], "episodes", "memory_mib", "process")
    axis.set_ylim(bottom=0.0)
    legend(drawn, axis)
    return drawn


def ends(rows: DataFrame) -> str:
    """Memory and open files at both ends."""
    found = growths(rows)
    columns = [column for column in found.columns if column != "growth_mib"]
    return table(found, columns, "Memory and open files of each process, after few episodes and after many.")
