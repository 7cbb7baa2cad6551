"""``sarah-eval``: the quality of learned, or given, parameters on unseen seeds."""

from __future__ import annotations

import dataclasses
import json as json_format
import shlex
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from sarah.cli.episode_options import UnseenOptions, parse_episode_options
from sarah.cli.former_names import with_out
from sarah.cli.next_steps import Step, passed_on, say_next, to_see
from sarah.cli.options import as_command, named_task, say_engine
from sarah.cli.subjects import learned_of
from sarah.cli.tables import leave_table, prepare_table
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.errors import ConfigurationError
from sarah.ranges import Within
from sarah.runs.kinds import TRAINING
from sarah.streams import check_output

if TYPE_CHECKING:
    from sarah.episode.workers import Workers

COMMAND = "sarah-eval"
NOT_OF_VIEW = (
    "robustness",
    "terrain",
    "out",
    "forces",
    "episodes",
    "first-seed",
    "json",
    "log",
    "workers",
    "scheduler",
)
"""Options that the viewer has not."""
REPLACED = {
    "robustness": (
        *("--episode.push.newtons", "--episode.push.at-seconds", "--episode.push.sagittal-share"),
        "--episode.time-limit",
    ),
    "terrain": ("--episode.terrain.", "--episode.push.", "--episode.time-limit"),
}
"""Beginnings of the options that a table replaces, by the option that asks for it."""


@dataclass(frozen=True)
class EvalOptions(UnseenOptions):
    """Simulate learned, given or shipped parameters on unseen seeds, and summarise the episodes.

    :param subject: run folder of a finished training; numbers separated by commas, P1 to P5 for stepping, or V1 to V4
        for the task balance; or the name of shipped parameters: ``paper``, ``stepping`` or ``balance``
    :param robustness: whether to write a table and a polar plot of survival by force and direction of the push, for
        these parameters and the baseline
    :param forces: forces of the pushes of --robustness, in N; by default 25 to 150 N for the default robot, and in
        proportion to its weight for another
    :param terrain: whether to write a table and a picture of score, steps and survival on slopes, bumps and slippery
        ground. Each robot runs for 10 s, once without a push and once with one at 2 to 3 s, of 75 N for 30 kg
    :param out: folder for the table and the picture of --robustness or --terrain
    :param json: whether to print one JSON object
    :param log: MCAP file for a log of the first episode, which must be new; sarah-log reads it
    """

    subject: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="[RUN|NUMBERS|NAME]")] = "balance"
    robustness: bool = False
    terrain: bool = False
    out: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None
    forces: tuple[Annotated[float, Within(0.01, 10_000.0, "N")], ...] = ()
    json: bool = False
    log: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None

    def __post_init__(self) -> None:
        """Refuse numbers outside their ranges, and outputs that exclude each other."""
        super().__post_init__()
        tables = [f"--{name}" for name in self._table_names]
        if self.json and tables:
            raise ConfigurationError(f"{tables[0]} prints a table, not JSON: leave --json out")
        if tables and self.out is None:
            raise ConfigurationError(f"{tables[0]} needs a folder for table and picture: --out DIR")
        if tables and self.log is not None:
            raise ConfigurationError(f"{tables[0]} has no first episode to log: leave --log out")
        if self.out is not None and not tables:
            raise ConfigurationError("--out is the folder of --robustness or --terrain: give one of them")

    @property
    def tables(self) -> list[Path]:
        """Paths of the tables that are asked for."""
        return [] if self.out is None else [self.out / f"{name}.md" for name in self._table_names]

    @property
    def _table_names(self) -> list[str]:
        return [name for name in REPLACED if getattr(self, name)]


@as_command(COMMAND)
def main() -> None:
    """Run the command with the arguments of the process."""
    former = {option: f"{option} --out" for option in ("--robustness", "--terrain")}
    arguments = with_out(COMMAND, sys.argv[1:], former)
    options = parse_episode_options(COMMAND, arguments, EvalOptions())
    own, algorithm = learned_of(options.subject, named_task(options.task))
    spec = options.applied_to(own)
    _check_replaced_options(options, arguments)
    if options.robustness and spec.task is not BALANCE:
        raise ConfigurationError(
            f"--robustness needs parameters of task {BALANCE.name!r}, and these are of {spec.task.name!r}"
        )
    from tqdm import tqdm

    from sarah.cli.eval_text import rows_of
    from sarah.episode.evaluation import evaluate
    from sarah.episode.workers import Workers
    from sarah.logs.simulated import log_episode
    from sarah.runs.config_files import settings_by_key

    for path in options.tables:
        prepare_table(path)
    if options.log is not None:
        log_episode(dataclasses.replace(spec, seed=options.first_seed), options.log, COMMAND)
    with Workers(options.workers, options.scheduler) as workers:
        if options.robustness:
            _show_robustness(own.config, spec, options, workers)
        if options.terrain:
            _show_terrain(own.config, spec, options, workers, shlex.join([COMMAND, *arguments]))
        if options.out is not None:
            say_next(*_next_steps(options, arguments))
            return
        say_engine(spec.config)
        shown = partial(tqdm, total=options.episodes, unit=" episodes", leave=False, disable=None)
        evaluation = evaluate(spec.task, spec.parameters, spec.config, options.seeds, workers, shown)
        neutral = spec.task.neutral
        baseline = evaluation if neutral == spec.parameters else None
        if baseline is None and neutral is not None:
            baseline = evaluate(spec.task, neutral, spec.config, options.seeds, workers, shown)
    if options.json:
        named = dict(zip(spec.task.parameter_names, spec.parameters, strict=True))
        content: dict[str, object] = {"task": spec.task.reference, "algorithm": algorithm, "parameters": named}
        content |= {"first_seed": options.first_seed, "engine": spec.config.engine}
        content |= {"episode": settings_by_key(spec.config), **evaluation.summary()}
        if baseline is not None:
            content |= {"chatters": evaluation.chatters(baseline), "baseline": baseline.summary()}
        content["endings"] = [result.termination for result in evaluation.results]
        print(json_format.dumps(content))
    else:
        for label, text in rows_of(options.subject, own.config, spec, options.seeds, evaluation, baseline):
            print(f"{label:17}{text}")
    check_output()
    if not options.json:
        say_next(*_next_steps(options, arguments))


def _next_steps(options: EvalOptions, arguments: Sequence[str]) -> Iterator[Step]:
    first = ("--seed", str(options.first_seed))
    if options.log is not None:
        yield "read its log", ("sarah-log", options.log)
    yield to_see(options.subject, *passed_on(arguments, options.subject, *NOT_OF_VIEW), *first)
    if TRAINING.owns(Path(options.subject)):
        typed = [] if options.task is None else ["--task", options.task]
        yield "have it on one page", ("sarah-report", options.subject, *typed)


def _show_robustness(own: EpisodeConfig, spec: EpisodeSpec, options: EvalOptions, workers: Workers) -> None:
    """Print the table as Markdown, and write the table and the polar plot."""
    from sarah.cli.eval_text import settings_of_table
    from sarah.reports.robustness import forces_for, push_many, pushed_settings, robustness_table, wilson_interval
    from sarah.reports.training_figures import draw_survival

    folder, neutral, parameters, config = options.out, BALANCE.neutral, spec.parameters, spec.config
    assert folder is not None and neutral is not None and isinstance(config, BalanceConfig)
    say_engine(config)
    names = ("V = 0", f"V = ({', '.join(f'{value:.2f}' for value in parameters)})")
    forces = options.forces or forces_for(config.scale)
    pushed = push_many((neutral, parameters), config, workers, forces, options.episodes, options.first_seed)
    head = "".join(f" {name}: survival | score | drift | vibration |" for name in names)
    about = settings_of_table(options.subject, pushed_settings(config, max(forces)), own)
    lines = [about, "", f"| push | direction | episodes |{head}", "|---" * (3 + 4 * len(names)) + "|"]
    tables = [robustness_table(episodes) for episodes in pushed]
    for newtons, direction in tables[0]:
        evaluations = [table[newtons, direction] for table in tables]
        cells = "".join(
            " {:.2f} ({:.2f} to {:.2f})".format(found.survival_rate, *wilson_interval(found.survivors, found.episodes))
            + f" | {found.median('score'):.2f} | {100 * found.median('drift'):.1f} cm "
            + f"| {found.median('vibration'):.1f} |"
            for found in evaluations
        )
        lines.append(f"| {newtons:g} N | {direction} | {evaluations[0].episodes} |{cells}")
    lines += [
        "",
        "- survival: share of the episodes (its 95 % interval)",
        "- score, drift, vibration: medians; vibration is in m²/s⁴, of the torso's acceleration from 20 to 50 Hz",
        "- lateral: pushes that point within 45° of the robot's right or left; sagittal: the others",
    ]
    table = "\n".join(lines)
    leave_table(table, folder / "robustness.md")
    for file in draw_survival(dict(zip(names, pushed, strict=True)), folder / "robustness"):
        print(file)


def _check_replaced_options(options: EvalOptions, arguments: Sequence[str]) -> None:
    """Refuse what the table that is asked for would replace, and forces of pushes that no table has."""
    given = [argument.partition("=")[0].replace("_", "-") for argument in arguments]
    if not options.robustness and "--forces" in given:
        raise ConfigurationError("--forces is for --robustness; one evaluation takes --episode.push.newtons")
    for table, replaced in REPLACED.items():
        mistaken = [option for option in given if option.startswith(replaced)]
        if getattr(options, table) and mistaken:
            own = "pushes and a time limit" if table == "robustness" else "ground, pushes and a time limit"
            raise ConfigurationError(f"--{table} has {own} of its own: leave {mistaken[0]} out")


def _show_terrain(own: EpisodeConfig, spec: EpisodeSpec, options: EvalOptions, workers: Workers, command: str) -> None:
    """Print the table as Markdown, and write the table and the picture. The command says what was asked for."""
    from tqdm import tqdm

    from sarah.cli.eval_text import settings_of_table
    from sarah.reports.terrain import as_markdown, situations, try_terrain
    from sarah.reports.terrain_figure import draw_terrain

    folder = options.out
    assert folder is not None
    say_engine(spec.config)
    tried = list(situations(spec.config.scale))
    progress = partial(tqdm, total=len(tried) * options.episodes, unit=" episodes")
    evaluations = try_terrain(spec.task, spec.parameters, spec.config, options.seeds, workers, tried, progress)
    values = ", ".join(f"{value:g}" for value in spec.parameters)
    about = f"{spec.task.name} ({values}) in {spec.config.engine}, seeds {options.seeds[0]} to {options.seeds[-1]}"
    pushed_on_level = next(situation for situation in tried if situation.newtons).config(spec.task, spec.config)
    settings = settings_of_table(options.subject, pushed_on_level, own)
    text = f"{about}:\n\n    {command}\n\n{settings}\n\n{as_markdown(evaluations)}"
    legend = [
        "- uphill: direction from the robot in which a slope rises",
        "- bumps: height over and under the mean plane; friction: coefficient under both feet",
        "- score, steps/s: means",
        "- SHIFT by sensors: mean share of the SHIFT phases that sensors ended",
        "- survival: share of the episodes (its 95 % interval)",
    ]
    leave_table("\n".join([text, "", *legend]), folder / "terrain.md")
    for file in draw_terrain(evaluations, folder / "terrain"):
        print(file)
