"""``sarah-eval``: how good learned, or given, parameters are on unseen seeds."""

from __future__ import annotations

import dataclasses
import json as json_format
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from sarah.cli.options import parse_options, run_command
from sarah.config import PHYSICS, TASKS, EpisodeConfig
from sarah.errors import ConfigurationError, unknown_name
from sarah.pattern_generator import PARAMETER_NAMES

if TYPE_CHECKING:
    from sarah.evaluation import Evaluation

COMMAND = "sarah-eval"


@dataclass(frozen=True)
class EvalOptions:
    """Simulate a run's learned parameters, or given ones, on unseen seeds, and summarise the episodes.

    :param run: folder of a finished training; its episode settings are used
    :param task: of --parameters: ``stepping``, which is the default, as it is the only one yet
    :param parameters: instead of a run: P1 to P5, separated by commas
    :param episodes: how many
    :param first_seed: seed of the first episode; the others follow. Trainings use seeds from 2^31 up
    :param physics: ``standard``, or ``reference``: 1 kHz and 100 solver iterations; by default the run's own
    :param randomisation: whether friction, masses, sensors and so on vary from seed to seed
    :param json: print one JSON object
    """

    run: Annotated[Path | None, tyro.conf.Positional, tyro.conf.arg(metavar="RUN")] = None
    task: str | None = None
    parameters: Annotated[str | None, tyro.conf.arg(metavar="P1,P2,P3,P4,P5")] = None
    episodes: int = 20
    first_seed: int = 0
    physics: Annotated[str | None, tyro.conf.arg(metavar="STR")] = None
    randomisation: bool = True
    json: bool = False

    def __post_init__(self) -> None:
        """Refuse unknown names and impossible numbers."""
        if self.episodes < 1:
            raise ConfigurationError(f"episodes must be at least 1, not {self.episodes!r}")
        if self.first_seed < 0:
            raise ConfigurationError(f"first-seed must not be negative, not {self.first_seed!r}")
        if self.task is not None and self.task not in TASKS:
            raise ConfigurationError(unknown_name("task", self.task, TASKS))
        if self.physics is not None and self.physics not in PHYSICS:
            raise ConfigurationError(unknown_name("physics", self.physics, PHYSICS))


def main() -> None:
    """Run the command with the arguments of the process."""
    run_command(COMMAND, _evaluate)


def _evaluate(arguments: Sequence[str]) -> None:
    options = parse_options(EvalOptions, COMMAND, arguments, EvalOptions())
    task, algorithm, parameters, config = _subject(options)
    if options.physics is not None:
        config = dataclasses.replace(config, physics=PHYSICS[options.physics])
    if not options.randomisation:
        config = dataclasses.replace(config, randomisation=dataclasses.replace(config.randomisation, enabled=False))
    from sarah.episode import EpisodeSpec
    from sarah.evaluation import simulate_all, summarise

    seeds = range(options.first_seed, options.first_seed + options.episodes)
    evaluation = summarise(simulate_all([EpisodeSpec(parameters, seed, task, config) for seed in seeds]))
    named = dict(zip(PARAMETER_NAMES, parameters, strict=True))
    if options.json:
        print(json_format.dumps({"task": task, "algorithm": algorithm, "parameters": named, **vars(evaluation)}))
        return
    for label, text in _rows(named, evaluation):
        print(f"{label:17}{text}")


def _subject(options: EvalOptions) -> tuple[str, str | None, tuple[float, ...], EpisodeConfig]:
    """Task, algorithm, parameters and episode settings of what is evaluated."""
    if (options.run is None) == (options.parameters is None):
        raise ConfigurationError("give either a run folder or --parameters")
    if options.run is not None:
        from sarah.runs import RunFolder

        run = RunFolder.open(options.run)
        training = run.config()
        if options.task not in (None, training.task):
            raise ConfigurationError(f"task is {options.task!r}, but {options.run} learned {training.task!r}")
        return training.task, training.algo, run.parameters(PARAMETER_NAMES), training.episode
    try:
        parameters = tuple(float(value) for value in str(options.parameters).split(","))
    except ValueError:
        raise ConfigurationError(
            f"parameters must be numbers separated by commas, not {options.parameters!r}"
        ) from None
    return options.task or TASKS[0], None, parameters, EpisodeConfig()


def _rows(parameters: dict[str, float], evaluation: Evaluation) -> list[tuple[str, str]]:
    e = evaluation
    return [
        ("parameters", ", ".join(f"{name} = {value:.3f}" for name, value in parameters.items())),
        (
            "score",
            f"{e.score_median:.3f} median, {e.score_mean:.3f} mean, {e.score_std:.3f} std, {e.score_min:.3f} min",
        ),
        (
            "steps per second",
            f"{e.steps_per_second_median:.2f} median, {e.steps_per_second_mean:.2f} mean, "
            f"{e.steps_per_second_std:.2f} std",
        ),
        (
            "drift",
            f"{100 * e.drift_median:.1f} cm median, {100 * e.drift_mean:.1f} cm mean, {100 * e.drift_std:.1f} cm std, "
            f"{100 * e.drift_max:.1f} cm max",
        ),
        ("survival", f"{round(e.survival_rate * e.episodes)} of {e.episodes} episodes"),
        ("by sensors", f"{e.event_driven_shift_mean:.1%} of shifts, {e.event_driven_lift_mean:.1%} of lifts"),
        ("sole clearance", f"{1000 * e.sole_clearance_mean:.1f} mm"),
    ]
