"""``sarah-transfer``: learned parameters in both physics engines."""

from __future__ import annotations

import dataclasses
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from sarah.cli.episode_options import UnseenOptions, parse_episode_options
from sarah.cli.next_steps import say_next, to_open
from sarah.cli.options import as_command, named_task
from sarah.cli.subjects import learned_of
from sarah.cli.tables import leave_table, prepare_table
from sarah.episode.spec import EpisodeSpec
from sarah.errors import ConfigurationError
from sarah.simulation.engines import check_engine

COMMAND = "sarah-transfer"


@dataclass(frozen=True)
class TransferOptions(UnseenOptions):
    """Simulate the learned parameters of trainings in both physics engines, on the same unseen seeds and pushes.

    The command prints a table of mean scores, survival, steps per second and vibration, and writes it to a folder. A
    figure shows the score in one engine against the score in the other. ``kept`` is the score in the other engine, as a
    share of that in the engine of the training.

    :param subjects: run folders of finished trainings, of any engine and task; numbers separated by commas; or names of
        shipped parameters. Each keeps its own settings, unless an option changes them
    :param out: folder for the table and the figure; by default ``figures`` in the run folder, if there is one run
    """

    subjects: Annotated[
        tuple[str, ...],
        tyro.conf.Positional,
        tyro.conf.arg(metavar="RUN|NUMBERS|NAME...", help_behavior_hint="(required)"),
    ] = ()
    out: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None


@as_command(COMMAND)
def main() -> None:
    """Run the command with the arguments of the process."""
    arguments = sys.argv[1:]
    options = parse_episode_options(COMMAND, arguments, TransferOptions())
    if not options.subjects:
        raise ConfigurationError("give at least one run folder, numbers or a name")
    from sarah.reports.transfer import ENGINES, as_markdown, transfer

    for engine in ENGINES:
        check_engine(engine)
    first = Path(options.subjects[0])
    if options.out is None and not (len(options.subjects) == 1 and first.is_dir()):
        raise ConfigurationError("anything but one run needs a folder for table and figure: --out DIR")
    from sarah.episode.workers import Workers
    from sarah.reports.transfer_figure import draw_transfer
    from sarah.runs.run_folder import RunFolder

    own = [learned_of(subject, named_task(options.task))[0] for subject in options.subjects]
    learned = [_learned(subject, spec, arguments) for subject, spec in zip(options.subjects, own, strict=True)]
    out = options.out or RunFolder(first).figures_path
    prepare_table(out / "transfer.md")
    with Workers(options.workers, options.scheduler) as workers:
        transfers = transfer(learned, options.seeds, workers)
    table = "\n".join([as_markdown(transfers), "", *_about_settings(learned, own)])
    leave_table(table, out / "transfer.md")
    files = draw_transfer(transfers, out / "transfer")
    for file in files:
        print(file)
    say_next(to_open(files[0]))


def _about_settings(learned: Sequence[tuple[str, EpisodeSpec]], own: Sequence[EpisodeSpec]) -> Iterator[str]:
    """Lines about the settings that an option has changed, or that the other engine does not take as they are."""
    from sarah.reports.markdown import plain_text
    from sarah.reports.transfer import ENGINES
    from sarah.runs.episode_words import differences

    yield "All settings are those of the training, but:"
    for (name, one), trained in zip(learned, own, strict=True):
        for engine in ENGINES:
            changes = differences(dataclasses.replace(one.config, engine=engine), trained.config)
            if words := ", ".join(change for change in changes if not change.startswith("engine ")):
                yield f"- {plain_text(name)} in {engine}: {words}"


def _learned(subject: str, own: EpisodeSpec, arguments: Sequence[str]) -> tuple[str, EpisodeSpec]:
    """Name and episode of one subject; the options change its own settings."""
    options = parse_episode_options(COMMAND, arguments, TransferOptions(), subject)
    return Path(subject).name, options.applied_to(own)
