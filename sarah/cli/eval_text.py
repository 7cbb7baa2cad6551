"""What ``sarah-eval`` prints: what was evaluated, under which conditions, and how it did."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

from sarah.cli.options import pushed_words
from sarah.cli.subjects import is_shipped
from sarah.episode.accuracy import physics_warning
from sarah.episode.ending import ending_words
from sarah.episode.evaluation import Evaluation
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.push import PushedConfig, draw_push
from sarah.episode.result import METRICS
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.task_answers import controller_of
from sarah.episode.tasks import BALANCE, Task
from sarah.reports.markdown import plain_text
from sarah.runs.episode_words import changed_settings, differences
from sarah.runs.kinds import RECOGNITION

MOST_ENDINGS = 5
"""Largest number of episodes of which a row says how each has ended."""

Row = tuple[str, str]


def rows_of(
    subject: str,
    own: EpisodeConfig,
    spec: EpisodeSpec,
    seeds: range,
    evaluation: Evaluation,
    baseline: Evaluation | None,
) -> Iterator[Row]:
    """Labels and texts of the rows.

    :param subject: what was evaluated, as it was given
    :param own: settings of its episodes
    :param spec: an episode of it, as the options change it
    :param seeds: seeds of the episodes
    :param evaluation: the episodes
    :param baseline: same episodes with the task's neutral parameters, if it has some
    """
    yield from _subject_rows(subject, spec)
    settings = ", ".join(changed_settings(spec.task, spec.config, own))
    if settings:
        yield "settings", settings
    span = f"{seeds[0]}" if len(seeds) == 1 else f"{seeds[0]} to {seeds[-1]}"
    yield "seeds", f"{span}, which no training has seen"
    named = zip(spec.task.parameter_names, spec.parameters, strict=True)
    yield "parameters", ", ".join(f"{name} = {value:.3f}" for name, value in named)
    yield "survival", f"{evaluation.survivors} of {evaluation.episodes} episodes{_how_they_ended(seeds, evaluation)}"
    yield from _rows_about_pushes(spec.config, seeds, evaluation)
    for name, metric in METRICS.items():
        if metric.statistics:
            values = ((evaluation.statistic(name, how), how) for how in metric.statistics)
            yield metric.label, ", ".join(f"{metric.text(value)} {how}" for value, how in values)
    if baseline is not None:
        yield from _comparison(spec.task, evaluation, baseline)
    warning = physics_warning(spec.task, spec.parameters, spec.config)
    if warning is not None:
        yield "physics", warning


def settings_of_table(subject: str, used: EpisodeConfig, own: EpisodeConfig) -> str:
    """Line about the settings of a table's episodes, of which the table itself has the force of the pushes.

    :param subject: what was evaluated, as it was given
    :param used: settings of episodes of the table
    :param own: settings of the subject's episodes, which the options and the table may change
    """
    changes = ", ".join(line for line in differences(used, own) if not line.startswith("push.newtons "))
    return f"Settings of {plain_text(subject)}{changes and ', but '}{changes}."


def _subject_rows(subject: str, spec: EpisodeSpec) -> Iterator[Row]:
    """What is evaluated, where it runs, and how hard it is pushed."""
    config = spec.config
    yield "subject", f"{subject}, task {spec.task.name}, in {config.engine}, {pushed_words(config)}"
    if is_shipped(subject):
        yield "origin", PARAMETER_SETS[subject].origin
    if RECOGNITION.owns(Path(subject)):
        from sarah.recognition.folder import ONE_FOR_ALL

        yield "origin", ONE_FOR_ALL
    if spec.task is BALANCE:
        stepping, _ = controller_of(spec.task, spec.parameters, config)
        yield "steps with", ", ".join(f"{name} = {value:.3f}" for name, value in asdict(stepping).items())


def _how_they_ended(seeds: Iterable[int], evaluation: Evaluation) -> str:
    """Which episodes ended early, and how."""
    endings = [
        f"seed {seed} {ending_words(result.termination)}"
        for seed, result in zip(seeds, evaluation.results, strict=True)
        if not result.survived
    ]
    more = [f"{len(endings) - MOST_ENDINGS} more"] if len(endings) > MOST_ENDINGS else []
    return "".join(f"; {ending}" for ending in endings[:MOST_ENDINGS] + more)


def _rows_about_pushes(config: EpisodeConfig, seeds: Iterable[int], evaluation: Evaluation) -> Iterator[Row]:
    """How many episodes were pushed, if some ended before."""
    if isinstance(config, PushedConfig) and config.push.newtons[1] > 0.0:
        pushed = sum(
            draw_push(config.push, seed).begin < result.duration
            for seed, result in zip(seeds, evaluation.results, strict=True)
        )
        if pushed < evaluation.episodes:
            yield "pushes", f"in {pushed} of {evaluation.episodes} episodes; the others ended before theirs"


def _comparison(task: Task[Any], evaluation: Evaluation, baseline: Evaluation) -> Iterator[Row]:
    """The baseline: the same episodes with the parameters that do nothing, such as V1 to V4 at zero."""
    score = f"{baseline.median('score'):.3f} median, {baseline.mean('score'):.3f} mean"
    survivors = f"{baseline.survivors} of {baseline.episodes} survive"
    steps = f"{baseline.mean('steps_per_second'):.2f} steps/s"
    yield "baseline (V = 0)" if task is BALANCE else "neutral", f"score {score}, {survivors}, {steps}"
    chatter = "the hips chatter" if evaluation.chatters(baseline) else "no chatter"
    vibration, still = evaluation.median("vibration"), baseline.median("vibration")
    yield "chatter", f"{chatter}: a vibration of {vibration:.1f} m²/s⁴, and of {still:.1f} with the baseline"
