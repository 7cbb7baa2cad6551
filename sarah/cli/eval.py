"""``sarah-eval``: the quality of learned, or given, parameters on unseen seeds."""

from __future__ import annotations

import json as json_format
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from sarah.cli.options import changed_episodes, numbers, parse_options, run_command, say_engine
from sarah.episode.settings import EpisodeConfig
from sarah.episode.tasks import BALANCE, STEPPING, TASKS, BalanceConfig
from sarah.errors import ConfigurationError, check_range, unknown_name

if TYPE_CHECKING:
    from sarah.episode.evaluation import Evaluation
    from sarah.episode.workers import Workers

COMMAND = "sarah-eval"
LARGEST_SEED = 2**32 - 1
MOST_EPISODES = 1_000_000


@dataclass(frozen=True)
class EvalOptions:
    """Simulate learned parameters of a training, or given ones, on unseen seeds, and summarise the episodes.

    :param run: run folder of a finished training; its episode settings are used
    :param task: task of --parameters: ``stepping`` (the default), or ``balance``, in which the robot is pushed
    :param parameters: parameters to simulate instead of a run folder's, separated by commas: P1 to P5, or V1 to V4
        with --task balance
    :param stepping: P1 to P5 for the task balance, separated by commas; by default those of the run folder, or trained
        ones
    :param push_newtons: force of every push, in N; direction and time vary. By default as in the training, or
        0 to 100 N
    :param robustness: folder for a table and a polar plot of survival by force and direction of the push, for these
        parameters and the baseline. --episodes is the number at each force: 25, 50, 75, 100, 125 and 150 N, or at the
        force of --push-newtons only
    :param episodes: number of episodes
    :param first_seed: seed of the first episode; the others follow. Trainings use seeds from 2^31 up
    :param physics: ``standard``, or ``reference``: 1 kHz and 100 solver iterations; by default as in the training
    :param engine: physics engine, ``pybullet`` or ``mujoco``; by default as in the training
    :param randomisation: friction, masses, sensors and so on stay as designed, instead of varying by seed
    :param json: whether to print one JSON object
    :param workers: number of processes on this machine that simulate; with 0, this process does. It changes no result
    :param scheduler: address of a Dask scheduler whose workers simulate instead, such as tcp://10.0.0.1:8786
    """

    run: Annotated[Path | None, tyro.conf.Positional, tyro.conf.arg(metavar="[RUN]")] = None
    task: Annotated[str | None, tyro.conf.arg(metavar="STR")] = None
    parameters: Annotated[str | None, tyro.conf.arg(metavar="NUMBERS")] = None
    stepping: Annotated[str | None, tyro.conf.arg(metavar="P1,P2,P3,P4,P5")] = None
    push_newtons: Annotated[float | None, tyro.conf.arg(metavar="FLOAT")] = None
    robustness: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None
    episodes: int = 20
    first_seed: int = 0
    physics: Annotated[str | None, tyro.conf.arg(metavar="STR")] = None
    engine: Annotated[str | None, tyro.conf.arg(metavar="STR")] = None
    randomisation: Annotated[bool, tyro.conf.arg(help_behavior_hint="(default: they vary)")] = True
    json: bool = False
    workers: int = 0
    scheduler: Annotated[str | None, tyro.conf.arg(metavar="ADDRESS")] = None

    def __post_init__(self) -> None:
        """Refuse unknown names, and numbers outside their ranges."""
        check_range("episodes", self.episodes, 1, MOST_EPISODES)
        check_range("first-seed", self.first_seed, 0, LARGEST_SEED)
        if self.task is not None and self.task not in TASKS:
            raise ConfigurationError(unknown_name("task", self.task, TASKS))
        if self.json and self.robustness is not None:
            raise ConfigurationError("--robustness prints a table, not JSON: leave --json out")
        if self.robustness is not None and self.push_newtons == 0:
            raise ConfigurationError("--robustness needs a push: --push-newtons must be above 0")


def main() -> None:
    """Run the command with the arguments of the process."""
    run_command(COMMAND, _evaluate)


def _evaluate(arguments: Sequence[str]) -> None:
    options = parse_options(EvalOptions, COMMAND, arguments, EvalOptions())
    task, algorithm, parameters, config = _subject(options)
    config = _changed(config, options, task)
    from sarah.episode.workers import Workers

    with Workers(options.workers, options.scheduler) as workers:
        if options.robustness is not None:
            _show_robustness(parameters, config, options, workers)
            return
        say_engine(config, options.engine)
        evaluation = _evaluation(task, parameters, config, options, workers)
        neutral = TASKS[task].neutral
        baseline = None if neutral is None else _evaluation(task, neutral, config, options, workers)
    named = dict(zip(TASKS[task].parameter_names, parameters, strict=True))
    if options.json:
        content = {"task": task, "algorithm": algorithm, "parameters": named, **evaluation.summary()}
        if baseline is not None:
            content |= {"chatters": evaluation.chatters(baseline), "baseline": baseline.summary()}
        print(json_format.dumps(content))
        return
    for label, text in _rows(named, evaluation):
        print(f"{label:17}{text}")
    if baseline is not None:
        for label, text in _comparison(evaluation, baseline):
            print(f"{label:17}{text}")


def _evaluation(
    task: str, parameters: tuple[float, ...], config: EpisodeConfig, options: EvalOptions, workers: Workers
) -> Evaluation:
    from sarah.episode.evaluation import evaluate

    seeds = range(options.first_seed, options.first_seed + options.episodes)
    return evaluate(task, parameters, config, seeds, workers)


def _subject(options: EvalOptions) -> tuple[str, str | None, tuple[float, ...], EpisodeConfig]:
    """Task, algorithm, parameters and episode settings to evaluate."""
    if (options.run is None) == (options.parameters is None):
        raise ConfigurationError("give either a run folder or --parameters")
    if options.run is not None:
        from sarah.runs.run_folder import RunFolder

        run = RunFolder.open(options.run)
        training = run.config()
        if options.task not in (None, training.task):
            raise ConfigurationError(f"task is {options.task!r}, but {options.run} learned {training.task!r}")
        return training.task, training.algo, run.parameters(), training.episode
    task = options.task or STEPPING.name
    return task, None, TASKS[task].checked(numbers("parameters", str(options.parameters))), TASKS[task].episode


def _changed(config: EpisodeConfig, options: EvalOptions, task: str) -> EpisodeConfig:
    """Episode settings with the changes that the options ask for."""
    if options.robustness is not None and task != BALANCE.name:
        raise ConfigurationError(f"--robustness is for --task {BALANCE.name}")
    return changed_episodes(
        config, options.stepping, options.push_newtons, options.physics, options.randomisation, options.engine
    )


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


def _comparison(evaluation: Evaluation, baseline: Evaluation) -> list[tuple[str, str]]:
    """Rows about the baseline: the same episodes with V1 to V4 at zero."""
    score, steps = baseline.median("score"), baseline.mean("steps_per_second")
    chatter = "the hips chatter" if evaluation.chatters(baseline) else "no chatter"
    return [
        (
            "baseline (V = 0)",
            f"score {score:.3f} median, {baseline.survivors} of {baseline.episodes} survive, {steps:.2f} steps/s",
        ),
        ("", f"vibration {baseline.median('vibration'):.1f} m²/s⁴: {chatter}"),
    ]


def _show_robustness(
    parameters: tuple[float, ...], config: EpisodeConfig, options: EvalOptions, workers: Workers
) -> None:
    """Print the table as Markdown, and write the table and the polar plot."""
    from sarah.reports.robustness import FORCES, push_many, robustness_table
    from sarah.reports.training_figures import draw_survival

    folder, neutral = options.robustness, BALANCE.neutral
    assert folder is not None and neutral is not None and isinstance(config, BalanceConfig)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ConfigurationError(f"cannot write folder {folder}: {error.strerror}") from error
    say_engine(config, options.engine)
    names = ("V = 0", f"V = ({', '.join(f'{value:.2f}' for value in parameters)})")
    forces = FORCES if options.push_newtons is None else (options.push_newtons,)
    pushed = push_many((neutral, parameters), config, workers, forces, options.episodes, options.first_seed)
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
