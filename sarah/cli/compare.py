"""``sarah-compare``: a race of several algorithms."""

from __future__ import annotations

import dataclasses
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from sarah.cli.episode_options import DIRECTIONS, given_options, with_given
from sarah.cli.former_names import with_out
from sarah.cli.next_steps import say_next, to_open, to_see, to_watch
from sarah.cli.options import as_command, parse_options, pushed_words, say_engine
from sarah.cli.tables import leave_table, prepare_table
from sarah.cli.training_defaults import default_training
from sarah.episode.settings import EpisodeConfig
from sarah.episode.tasks import BALANCE, STEPPING, TASKS, Task, load_task
from sarah.errors import ConfigurationError, check_range
from sarah.reports.judging import PUSHED, UNPUSHED, evaluations_of
from sarah.robot.description import describe_robot
from sarah.runs.config import ALGORITHMS
from sarah.runs.kinds import SESSION, TRAINING
from sarah.simulation.engines import check_engine

if TYPE_CHECKING:
    from sarah.reports.race_entry import Entry, RaceCurve

COMMAND = "sarah-compare"
MOST_SEEDS = 1000
SCORES = (0.01, 2.0)
"""Range of best known scores: 1 is the ceiling, which the printed form of the reward can exceed."""


@dataclass(frozen=True)
class CompareOptions:
    """Train several algorithms with several seeds each, and see which one needs the fewest episodes.

    Unseen episodes judge what each training recommends at its end, and after every five episodes along the way. The
    table has the final score with its standard error, and how many trainings end at 95 % of the best known score. It
    also says after how many episodes more than half of the trainings have reached 90 % and 95 % along the way, and held
    it over three evaluations: a multiple of five, or "not reached". The command prints the table, and writes it to the
    folder with a plot. The same command continues a race that was interrupted.

    Judging takes longer than learning. With a push, {pushed_final} episodes judge the end of a training, and
    the first {pushed_along} of them judge after every five of its episodes. Without a push these
    numbers are {still_final} and {still_along}. A recommendation that comes again is judged once. Before it starts, the
    command says how many episodes it will simulate.

    :param out: folder of the race, which also holds its run folders
    :param algorithms: names of different algorithms: {algorithms}
    :param seeds: number of trainings of each algorithm
    :param first_seed: seed of the first training of each algorithm; the others follow
    :param task: task to learn: {tasks}, or that of a file of yours, such as my_task.py:JUMP
    :param episodes: budget of each training, in episodes; by default that of ``sarah-train``
    :param slots: number of episodes in flight in each training
    :param episode: settings of the episodes; by default those of ``sarah-train``, whose help also names the paper's
    :param evaluations: number of unseen episodes that judge every final recommendation; by default {pushed_final} if
        the task has a push, and {still_final} if not
    :param evaluations_along: number of these episodes that judge every recommendation along the way;
        by default {pushed_along} if the task has a push, and {still_along} if not
    :param best_known: score that counts as 100 %; by default that of the best training, which some episodes choose and
        others judge
    :param workers: number of processes on this machine that train, one training each; with 0, this process trains
    :param scheduler: address of a Dask scheduler whose workers train instead; they must share the folder's file system
    """

    out: Annotated[Path | None, tyro.conf.arg(metavar="DIR", help_behavior_hint="(required)")] = None
    algorithms: tuple[str, ...] = ALGORITHMS
    seeds: int = 5
    first_seed: int = 0
    task: Task[Any] = STEPPING
    episodes: Annotated[int, tyro.conf.arg(aliases=["--simulations"])] = 100
    slots: int = 1
    episode: EpisodeConfig = EpisodeConfig()
    evaluations: int | None = None
    evaluations_along: int | None = None
    best_known: float | None = None
    workers: int = 0
    scheduler: Annotated[str | None, tyro.conf.arg(metavar="ADDRESS")] = None


CompareOptions.__doc__ = str(CompareOptions.__doc__).format(  # read by the help
    algorithms=", ".join(ALGORITHMS),
    tasks=", ".join(f"``{name}``" for name in TASKS),
    pushed_final=PUSHED.final,
    pushed_along=PUSHED.along,
    still_final=UNPUSHED.final,
    still_along=UNPUSHED.along,
)


def _defaults(arguments: Sequence[str]) -> CompareOptions:
    """Default options: those of ``sarah-train``, of the type that task and engine take."""
    given = given_options(arguments, "task", "engine", "episode.engine", *DIRECTIONS)
    training = default_training(load_task(given["task"]) if "task" in given else STEPPING)
    episode = with_given(training.episode, arguments, given, is_directed=training.task is BALANCE)
    return CompareOptions(task=training.task, episodes=training.episodes, episode=episode)


@as_command(COMMAND)
def main() -> None:
    """Run the command with the arguments of the process."""
    arguments = with_out(COMMAND, sys.argv[1:], bare=0)
    options = parse_options(CompareOptions, COMMAND, arguments, _defaults(arguments))
    if options.out is None:
        raise ConfigurationError("give a folder for the race: --out DIR")
    for kind in (TRAINING, SESSION):
        if kind.owns(options.out):
            raise ConfigurationError(f"{options.out} is the folder of a {kind.name}: name another for the race")
    check_range("seeds", options.seeds, 1, MOST_SEEDS)
    evaluations = evaluations_of(options.task, options.evaluations, options.evaluations_along)
    if options.best_known is not None:
        check_range("best-known", options.best_known, *SCORES)
    if not options.algorithms or len(set(options.algorithms)) < len(options.algorithms):
        raise ConfigurationError(f"algorithms must be different ones, at least one, not {options.algorithms!r}")
    episode = options.episode
    base = dataclasses.replace(
        default_training(options.task), episodes=options.episodes, slots=options.slots, episode=episode
    )
    describe_robot(episode.dimensions)
    check_engine(episode.engine)
    from sarah.episode.trial import try_task
    from sarah.episode.workers import Workers
    from sarah.reports.race import race
    from sarah.reports.race_entry import entries_of
    from sarah.reports.rankings import as_markdown, rankings, write_csv
    from sarah.reports.training_figures import draw_race

    seeds = range(options.first_seed, options.first_seed + options.seeds)
    entries = entries_of(options.algorithms, seeds, base, evaluations, options.out)
    try_task(options.task, episode)
    prepare_table(options.out / "race.md")
    with Workers(options.workers, options.scheduler) as workers:
        say_engine(episode)
        try:
            curves = race(entries, workers, progress_bar=True)
        except KeyboardInterrupt:
            print(f"\n{COMMAND}: interrupted; the same command goes on with the race", file=sys.stderr)
            raise SystemExit(130) from None
    table = rankings(curves, options.best_known)
    text = "\n".join([*_about(entries, curves[0]), "", as_markdown(table)])
    leave_table(text, options.out / "race.md")
    write_csv(table, options.out / "race.csv")
    files = draw_race(curves, options.out / "race")
    for file in files:
        print(file)
    best = max(range(len(curves)), key=lambda index: fmean(curves[index].final))
    typed = [] if options.task.file is None else ["--task", options.task.reference]
    _, see_best = to_see(entries[best].folder, *typed)
    say_next(to_open(files[0]), ("see its best", see_best), to_watch(options.out))


def _about(entries: Sequence[Entry], curve: RaceCurve) -> Iterator[str]:
    """Lines about what was raced, and about what a budget that is too small cannot show; the curve is of any entry."""
    from sarah.reports.markdown import plain_text
    from sarah.reports.rankings import HELD
    from sarah.runs.episode_words import changed_settings
    from sarah.training.plan import plan_of

    base = entries[0].config
    changes = (line for line in changed_settings(base.task, base.episode) if not line.startswith("time_limit "))
    settings = ", ".join([base.episode.engine, pushed_words(base.episode), *changes])
    budget = f"{base.episodes} episodes in each training, of at most {base.episode.time_limit:g} s"
    yield f"Task {plain_text(base.task.name)} in {settings}: {budget}."
    plans = (plan_of(entry.config) for entry in entries)
    if idle := dict.fromkeys(plan.config.algo for plan in plans if plan.warm_up_episodes >= base.episodes):
        yield f"Nothing was learned by {', '.join(idle)}: the warm-up took all {base.episodes} episodes."
    if (count := len(set(curve.episodes))) < HELD:
        yield f"Nothing can be held: the table asks for {HELD} evaluations in a row, and a training has {count}."
