"""``sarah-eval``: the quality of learned, or given, parameters on unseen seeds."""

from __future__ import annotations

import json as json_format
import shlex
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from sarah.cli.episode_options import EpisodeOptions, parse_episode_options
from sarah.cli.options import named_task, run_command, say_engine
from sarah.cli.subjects import episode_of, is_shipped, learner_of
from sarah.episode.push import PushedConfig
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import FIRST_EVALUATION_SEED, EpisodeSpec
from sarah.episode.tasks import BALANCE, BalanceConfig, Task
from sarah.errors import ConfigurationError, check_range
from sarah.simulation.terrain import Terrain

if TYPE_CHECKING:
    from sarah.episode.evaluation import Evaluation
    from sarah.episode.workers import Workers

COMMAND = "sarah-eval"
LARGEST_SEED = 2**32 - 1
MOST_EPISODES = 1_000_000
SMALLEST_FORCE, LARGEST_FORCE = 1.0, 10_000.0
"""Range of the forces of pushes, in N."""
REPLACED_BY_TERRAIN = ("--episode.terrain.", "--episode.push.", "--episode.time-limit", "--forces")
"""Beginnings of the options that ``--terrain`` replaces."""


@dataclass(frozen=True)
class EvalOptions(EpisodeOptions):
    """Simulate learned, given or shipped parameters on unseen seeds, and summarise the episodes.

    :param subject: run folder of a finished training, numbers separated by commas (P1 to P5 for stepping, or V1 to V4
        for the task balance), or the name of shipped parameters: ``paper``, ``stepping`` or ``balance``, which comes
        back from a push
    :param robustness: folder for a table and a polar plot of survival by force and direction of the push, for these
        parameters and the baseline. --episodes is the number at each force
    :param forces: forces of the pushes of --robustness, in N
    :param terrain: folder for a table and a picture of score, steps and survival on slopes, bumps and slippery ground,
        for 10 s without a push, and with one of 75 N at 2 to 4 s. --episodes is the number on each ground
    :param episodes: number of episodes
    :param first_seed: seed of the first episode; the others follow. No training has seen the default: trainings draw
        seeds from 2^31 up, and their summaries begin at 0
    :param json: whether to print one JSON object
    :param workers: number of processes on this machine that simulate; with 0, this process does. It changes no result
    :param scheduler: address of a Dask scheduler whose workers simulate instead, such as tcp://10.0.0.1:8786
    """

    subject: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="[RUN|NUMBERS|NAME]")] = "balance"
    robustness: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None
    terrain: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None
    forces: Annotated[tuple[float, ...], tyro.conf.arg(metavar="FLOAT...")] = (25.0, 50.0, 75.0, 100.0, 125.0, 150.0)
    episodes: int = 20
    first_seed: int = FIRST_EVALUATION_SEED
    json: bool = False
    workers: int = 0
    scheduler: Annotated[str | None, tyro.conf.arg(metavar="ADDRESS")] = None

    def __post_init__(self) -> None:
        """Refuse numbers outside their ranges, and outputs that exclude each other."""
        check_range("episodes", self.episodes, 1, MOST_EPISODES)
        check_range("first-seed", self.first_seed, 0, LARGEST_SEED)
        for newtons in self.forces:
            check_range("forces", newtons, SMALLEST_FORCE, LARGEST_FORCE, "N")
        for option in ("robustness", "terrain"):
            if self.json and getattr(self, option) is not None:
                raise ConfigurationError(f"--{option} prints a table, not JSON: leave --json out")

    @property
    def seeds(self) -> range:
        """Seeds of the episodes."""
        return range(self.first_seed, self.first_seed + self.episodes)


def main() -> None:
    """Run the command with the arguments of the process."""
    run_command(COMMAND, _evaluate)


def _evaluate(arguments: Sequence[str]) -> None:
    options = parse_episode_options(COMMAND, arguments, EvalOptions())
    spec, algorithm = _subject(options)
    if options.terrain is not None:
        _check_terrain_options(arguments)
    if options.robustness is not None and spec.task is not BALANCE:
        raise ConfigurationError(
            f"--robustness needs parameters of task {BALANCE.name!r}, and these are of {spec.task.name!r}"
        )
    from tqdm import tqdm

    from sarah.episode.accuracy import physics_warning
    from sarah.episode.evaluation import evaluate
    from sarah.episode.workers import Workers

    with Workers(options.workers, options.scheduler) as workers:
        if options.robustness is not None:
            _show_robustness(spec.parameters, spec.config, options, workers)
        if options.terrain is not None:
            command = shlex.join([COMMAND, *arguments])
            _show_terrain(spec, options.terrain, options, workers, command)
        if options.robustness is not None or options.terrain is not None:
            return
        say_engine(spec.config, options.engine)
        shown = partial(tqdm, total=options.episodes, unit=" episodes", leave=False, disable=None)
        evaluation = evaluate(spec.task, spec.parameters, spec.config, options.seeds, workers, shown)
        neutral = spec.task.neutral
        baseline = None if neutral is None else evaluate(spec.task, neutral, spec.config, options.seeds, workers, shown)
    named = dict(zip(spec.task.parameter_names, spec.parameters, strict=True))
    if options.json:
        content: dict[str, object] = {"task": spec.task.reference, "algorithm": algorithm, "parameters": named}
        content |= {"first_seed": options.first_seed, "engine": spec.config.engine}
        content |= {"terrain": asdict(spec.config.terrain), **evaluation.summary()}
        if baseline is not None:
            content |= {"chatters": evaluation.chatters(baseline), "baseline": baseline.summary()}
        print(json_format.dumps(content))
        return
    ground = [("ground", _described(spec.config.terrain))] if spec.config.terrain != Terrain() else []
    seeds = f"{options.seeds[0]} to {options.seeds[-1]}, which no training has seen"
    for label, text in [
        *_subject_rows(options.subject, spec),
        *ground,
        ("seeds", seeds),
        *_rows(named, evaluation),
    ]:
        print(f"{label:17}{text}")
    if baseline is not None:
        for label, text in _comparison(spec.task, evaluation, baseline):
            print(f"{label:17}{text}")
    warning = physics_warning(spec.task, spec.parameters, spec.config)
    if warning is not None:
        print(f"{'physics':17}{warning}")


def _subject(options: EvalOptions) -> tuple[EpisodeSpec, str | None]:
    """Episode to evaluate, on any seed, and the algorithm that learned its parameters."""
    task = named_task(options.task)
    algorithm = learner_of(options.subject, task)
    spec = episode_of(options.subject, None, task).spec
    return options.applied_to(spec), algorithm


def _subject_rows(subject: str, spec: EpisodeSpec) -> list[tuple[str, str]]:
    """Rows about what is evaluated, where it runs, and how hard it is pushed."""
    from sarah.episode.parameter_sets import PARAMETER_SETS
    from sarah.episode.tasks import controller_of

    config = spec.config
    low, high = config.push.newtons if isinstance(config, PushedConfig) else (0.0, 0.0)
    newtons = f"{low:g} N" if low == high else f"{low:g} to {high:g} N"
    pushed = f"pushed by {newtons}" if high else "not pushed"
    rows = [("subject", f"{subject}, task {spec.task.name}, in {config.engine}, {pushed}")]
    if is_shipped(subject):
        rows.append(("origin", PARAMETER_SETS[subject].origin))
    if spec.task is BALANCE:
        stepping, _ = controller_of(spec.task, spec.parameters, config)
        rows.append(("steps with", ", ".join(f"{name} = {value:.3f}" for name, value in asdict(stepping).items())))
    return rows


def _described(terrain: Terrain) -> str:
    """Settings of the ground that are not the default."""
    given = [(item.name, getattr(terrain, item.name)) for item in fields(terrain)]
    changed = [(name, ends) for name, ends in given if ends != getattr(Terrain(), name)]
    return ", ".join(f"{name} {low:g}" + (f" to {high:g}" if high != low else "") for name, (low, high) in changed)


def _rows(parameters: dict[str, float], evaluation: Evaluation) -> list[tuple[str, str]]:
    from sarah.episode.result import METRICS

    diverged = f"; {evaluation.diverged} diverged: their simulation gave no finite state" if evaluation.diverged else ""
    return [
        ("parameters", ", ".join(f"{name} = {value:.3f}" for name, value in parameters.items())),
        ("survival", f"{evaluation.survivors} of {evaluation.episodes} episodes{diverged}"),
        *(
            (
                metric.label,
                ", ".join(f"{metric.text(evaluation.statistic(name, how))} {how}" for how in metric.statistics),
            )
            for name, metric in METRICS.items()
            if metric.statistics
        ),
    ]


def _comparison(task: Task[Any], evaluation: Evaluation, baseline: Evaluation) -> list[tuple[str, str]]:
    """Rows about the baseline: the same episodes with the parameters that do nothing, such as V1 to V4 at zero."""
    score = f"{baseline.median('score'):.3f} median, {baseline.mean('score'):.3f} mean"
    survivors = f"{baseline.survivors} of {baseline.episodes} survive"
    chatter = "the hips chatter" if evaluation.chatters(baseline) else "no chatter"
    vibration, still = evaluation.median("vibration"), baseline.median("vibration")
    return [
        (
            "baseline (V = 0)" if task is BALANCE else "neutral",
            f"score {score}, {survivors}, {baseline.mean('steps_per_second'):.2f} steps/s",
        ),
        ("chatter", f"{chatter}: a vibration of {vibration:.1f} m²/s⁴, and of {still:.1f} with the baseline"),
    ]


def _show_robustness(
    parameters: tuple[float, ...], config: EpisodeConfig, options: EvalOptions, workers: Workers
) -> None:
    """Print the table as Markdown, and write the table and the polar plot."""
    from sarah.reports.robustness import push_many, robustness_table
    from sarah.reports.training_figures import draw_survival

    folder, neutral = options.robustness, BALANCE.neutral
    assert folder is not None and neutral is not None and isinstance(config, BalanceConfig)
    _make_folder(folder)
    say_engine(config, options.engine)
    names = ("V = 0", f"V = ({', '.join(f'{value:.2f}' for value in parameters)})")
    pushed = push_many((neutral, parameters), config, workers, options.forces, options.episodes, options.first_seed)
    head = "".join(f" {name}: survival | score | drift | vibration |" for name in names)
    lines = [f"| push | direction | episodes |{head}", "|---" * (3 + 4 * len(names)) + "|"]
    for rows in zip(*map(robustness_table, pushed), strict=True):
        cells = "".join(
            f" {row.survival:.2f} ({row.survival_low:.2f} to {row.survival_high:.2f}) | {row.score_median:.2f} "
            f"| {100 * row.drift_median:.1f} cm | {row.vibration_median:.1f} |"
            for row in rows
        )
        lines.append(f"| {rows[0].newtons:.0f} N | {rows[0].direction} | {rows[0].episodes} |{cells}")
    table = "\n".join(lines)
    print(table)
    (folder / "robustness.md").write_text(table + "\n", encoding="utf-8")
    for file in draw_survival(dict(zip(names, pushed, strict=True)), folder / "robustness"):
        print(file)


def _check_terrain_options(arguments: Sequence[str]) -> None:
    """Refuse what ``--terrain`` would replace."""
    for argument in arguments:
        option = argument.partition("=")[0].replace("_", "-")
        if option.startswith(REPLACED_BY_TERRAIN):
            raise ConfigurationError(f"--terrain has grounds, pushes and a time limit of its own: leave {option} out")


def _show_terrain(spec: EpisodeSpec, folder: Path, options: EvalOptions, workers: Workers, command: str) -> None:
    """Print the table as Markdown, and write the table and the picture. The command says what was asked for."""
    from tqdm import tqdm

    from sarah.reports.terrain import as_markdown, situations, try_terrain
    from sarah.reports.terrain_figure import draw_terrain

    _make_folder(folder)
    say_engine(spec.config, options.engine)
    tried = list(situations())
    progress = partial(tqdm, total=len(tried) * options.episodes, unit=" episodes")
    rows = try_terrain(spec.task, spec.parameters, spec.config, options.seeds, workers, tried, progress)
    values = ", ".join(f"{value:g}" for value in spec.parameters)
    about = f"{spec.task.name} ({values}) in {spec.config.engine}, seeds {options.seeds[0]} to {options.seeds[-1]}"
    table = f"{about}: {command}\n\n{as_markdown(rows)}"
    print(table)
    (folder / "terrain.md").write_text(table + "\n", encoding="utf-8")
    for file in draw_terrain(rows, folder / "terrain"):
        print(file)


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ConfigurationError(f"cannot write folder {folder}: {error.strerror}") from error
