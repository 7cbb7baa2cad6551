"""``sarah-transfer``: learned parameters in both physics engines."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from sarah.cli.options import parse_options, pushed_by, run_command
from sarah.episode.tasks import TASKS
from sarah.errors import ConfigurationError

if TYPE_CHECKING:
    from sarah.reports.transfer import LearnedParameters
    from sarah.runs.run_folder import RunFolder

COMMAND = "sarah-transfer"


@dataclass(frozen=True)
class TransferOptions:
    """Simulate the learned parameters of trainings in both physics engines, on the same unseen seeds and pushes.

    A table of mean scores, survival, steps per second and vibration is printed, and written to a folder. A figure shows
    the score in one engine against the score in the other. ``kept`` is the score in the other engine, as a share of
    that in the engine of the training.

    :param runs: run folders of finished trainings, of any engine and task; their episode settings are used
    :param out: folder for the table and the figure; by default ``figures`` in the run folder, if there is one run
    :param episodes: number of episodes in each engine
    :param first_seed: seed of the first episode; the others follow. Trainings use seeds from 2^31 up
    :param push_newtons: force of every push in N, for the task balance; direction and time vary. By default as in the
        training
    :param workers: number of processes on this machine that simulate; with 0, this process does. It changes no result
    :param scheduler: address of a Dask scheduler whose workers simulate instead, such as tcp://10.0.0.1:8786
    """

    runs: Annotated[
        tuple[Path, ...], tyro.conf.Positional, tyro.conf.arg(metavar="RUN...", help_behavior_hint="(required)")
    ] = ()
    out: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None
    episodes: int = 20
    first_seed: int = 0
    push_newtons: Annotated[float | None, tyro.conf.arg(metavar="FLOAT")] = None
    workers: int = 0
    scheduler: Annotated[str | None, tyro.conf.arg(metavar="ADDRESS")] = None


def main() -> None:
    """Run the command with the arguments of the process."""
    run_command(COMMAND, _transfer)


def _transfer(arguments: Sequence[str]) -> None:
    options = parse_options(TransferOptions, COMMAND, arguments, TransferOptions())
    if not options.runs:
        raise ConfigurationError("give at least one run folder")
    if options.out is None and len(options.runs) > 1:
        raise ConfigurationError("several runs need a folder for table and figure: --out DIR")
    if options.episodes < 1:
        raise ConfigurationError(f"episodes must be at least 1, not {options.episodes!r}")
    if options.first_seed < 0:
        raise ConfigurationError(f"first-seed must not be negative, not {options.first_seed!r}")
    from sarah.reports.transfer import ENGINES
    from sarah.simulation.engines import check_engine

    for engine in ENGINES:
        check_engine(engine)
    from sarah.episode.workers import Workers
    from sarah.reports.transfer import as_markdown, transfer
    from sarah.reports.transfer_figure import draw_transfer
    from sarah.runs.run_folder import RunFolder

    runs = [RunFolder.open(path) for path in options.runs]
    learned = [_learned(run, options.push_newtons) for run in runs]
    seeds = range(options.first_seed, options.first_seed + options.episodes)
    with Workers(options.workers, options.scheduler) as workers:
        transfers = transfer(learned, seeds, workers)
    table = as_markdown(transfers)
    print(table)
    out = options.out or runs[0].figures_path
    out.mkdir(parents=True, exist_ok=True)
    (out / "transfer.md").write_text(table + "\n", encoding="utf-8")
    for file in draw_transfer(transfers, out / "transfer"):
        print(file)


def _learned(run: RunFolder, push_newtons: float | None) -> LearnedParameters:
    from sarah.reports.transfer import LearnedParameters

    training = run.config()
    episode = training.episode
    if push_newtons is not None and TASKS[training.task].has_push:
        episode = dataclasses.replace(episode, push=pushed_by(episode, push_newtons))  # type: ignore[call-arg]
    return LearnedParameters(run.path.name, training.task, run.parameters(), episode)
