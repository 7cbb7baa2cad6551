"""The report of a training as one HTML file: results beside the paper's, video, figures, settings and commands."""

from __future__ import annotations

import tempfile
from base64 import b64encode
from dataclasses import replace
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path

from jinja2 import Environment, StrictUndefined
from tqdm import tqdm

from sarah.episode.accuracy import physics_warning
from sarah.episode.episode import simulate
from sarah.episode.evaluation import Evaluation
from sarah.episode.result import METRICS, EpisodeResult
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, Task
from sarah.episode.workers import Executor
from sarah.errors import ConfigurationError
from sarah.files import check_file, quoted, replace_text
from sarah.pictures.colours import algorithm_label
from sarah.pictures.style import only_png
from sarah.pictures.video import FRAMES_PER_SECOND, frame_times, frames, write_video
from sarah.reports.all_figures import draw_all_figures
from sarah.reports.training_figures import figures_of
from sarah.runs.config import TrainingConfig
from sarah.runs.episode_words import told_of
from sarah.runs.run_episodes import learned_episode
from sarah.runs.run_record import RunRecord
from sarah.simulation.renderer import check_renderer

PAPER_CAPTIONS = {
    "figure_4_reward_and_frequency": "Return and step frequency of every episode (the paper's Figure 4)",
    "figure_5_parameters": "Parameters of every episode (the paper's Figure 5); dotted: the paper's values",
    "figure_6_reward_and_position": "Return and final position of every episode (the paper's Figure 6)",
    "figure_7_parameters": "Parameters of every episode (the paper's Figure 7)",
}
"""Captions of the paper's figures of trainings."""


Row = tuple[str, str, str, str]
"""Label of a metric or parameter, its values with the learned parameters and with the baseline, and the paper's."""


def write_report(
    run: RunRecord, path: Path, executor: Executor, episodes: int = 10, seconds: tuple[float, float] = (1.0, 5.0)
) -> None:
    """Write the page.

    :param run: record of a finished training
    :param path: path of the HTML file
    :param executor: executor that simulates the episodes of the table
    :param episodes: number of episodes on unseen seeds for the table
    :param seconds: simulated times at which the video begins and ends, in s
    :raises RunFolderError: if a file in the run folder is missing or damaged
    :raises ConfigurationError: if the page cannot be written
    """
    check_file(path)
    config, learned = run.config, learned_episode(run).spec
    settings, versions = run.folder.config_text(), run.folder.versions()  # before the long simulation
    task = config.task
    of, shown = _evaluations(run, learned, episodes, executor)
    with tempfile.TemporaryDirectory() as name, only_png():
        folder = Path(name)
        drawn = {file.stem: file for file in draw_all_figures([run], folder, shown)}
        figures = [
            (text, _address(drawn[stem].read_bytes(), "image/png"))
            for stem, text in _captions(task).items()
            if stem in drawn
        ]
        film, caption = _film(learned, shown, folder, seconds)
    neutral = None if task.neutral is None else of[task.neutral]
    shortcomings = of[learned.parameters].shortcomings(task.must_step, neutral)
    physics = physics_warning(task, learned.parameters, learned.config)
    page = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True).from_string(
        (files("sarah.reports") / "report.html").read_text(encoding="utf-8")
    )
    text = page.render(
        title=task.title,
        run=str(run.folder.path),
        config=config,
        algorithm=algorithm_label(config.algo),
        episodes=episodes,
        rows=_parameter_rows(learned) + _result_rows(config, of[learned.parameters], of[task.baseline]),
        baseline=task.baseline_label,
        warnings=[f"{warning[:1].upper()}{warning[1:]}." for warning in (*shortcomings, physics) if warning],
        figures=figures,
        film=film,
        film_caption=caption,
        settings=settings,
        settings_address=_address(settings.encode(), "text/yaml"),
        commands=_commands(config),
        versions=versions,
    )
    replace_text(path, text)


def _evaluations(
    run: RunRecord, learned: EpisodeSpec, episodes: int, executor: Executor
) -> tuple[dict[tuple[float, ...], Evaluation], EpisodeResult]:
    """Evaluations of learned, baseline and neutral parameters, and the first of the learned ones' episodes, traced.

    What the training has evaluated on as many episodes is not simulated again.
    """
    task, least_clearance = learned.task, learned.config.least_clearance
    noted = {learned.parameters: run.evaluation("evaluation", episodes)}
    if task.neutral is not None:
        noted.setdefault(task.neutral, run.evaluation("baseline", episodes))
    of = {one: evaluation for one, evaluation in noted.items() if evaluation is not None}
    values = [one for one in dict.fromkeys([learned.parameters, task.baseline, *noted]) if one not in of]
    shown = simulate(learned, record_trace=True)
    specs = [replace(learned, parameters=one, seed=seed) for one in values for seed in range(episodes)]
    left = [spec for spec in specs if spec != learned]
    others = tqdm(executor.simulate_all(left), desc="simulating", unit=" episodes", total=len(left)) if left else ()
    results = [*[shown] * (len(specs) - len(left)), *others]  # the learned parameters come first, with seed 0
    parts = (tuple(results[first : first + episodes]) for first in range(0, len(specs), episodes))
    of |= {one: Evaluation(part, least_clearance) for one, part in zip(values, parts, strict=True)}
    return of, shown


def _captions(task: Task) -> dict[str, str]:
    """Caption of each figure, in the order of the page."""
    outcome, parameters = figures_of(task)
    return {
        outcome: PAPER_CAPTIONS.get(outcome, "Return and step frequency of every episode"),
        parameters: PAPER_CAPTIONS.get(parameters, "Parameters of every episode"),
        f"gait_cycle_{task.name}": "One step with each leg, with the learned parameters",
        "figure_3_pattern_generator": "The pattern generator (the paper's Figure 3), drawn from the code",
        "figure_2_robot": "The robot (the paper's Figure 2)",
    }


def _parameter_rows(learned: EpisodeSpec) -> list[Row]:
    task = learned.task
    return [
        (parameter.label, f"{ours:.2f}", f"{theirs:.2f}", parameter.paper)
        for parameter, ours, theirs in zip(task.parameters, learned.parameters, task.baseline, strict=True)
    ]


def _result_rows(config: TrainingConfig, learned: Evaluation, baseline: Evaluation) -> list[Row]:
    ours, theirs = (f"{evaluation.survivors} of {evaluation.episodes}" for evaluation in (learned, baseline))
    rows = [(f"episodes that lasted {config.episode.time_limit:g} s", ours, theirs, "30 s end a good episode")]
    for name, metric in METRICS.items():
        for how in metric.statistics[:1]:
            ours, theirs = (metric.text(evaluation.statistic(name, how)) for evaluation in (learned, baseline))
            rows.append((f"{metric.label}, {how}", ours, theirs, metric.paper))
    return rows


def _film(spec: EpisodeSpec, result: EpisodeResult, folder: Path, seconds: tuple[float, float]) -> tuple[str, str]:
    """Film a part of an episode with a trace, if the renderer is installed, and write a line about it."""
    try:
        check_renderer()
    except ConfigurationError as missing:
        return "", f"No video: {missing}."
    name, kind = ("film.mp4", "video/mp4") if find_spec("imageio_ffmpeg") else ("film.gif", "image/gif")
    path = folder / name
    trace = result.trace
    assert trace is not None
    end = min(seconds[1], trace.time[-1])
    begin = min(max(seconds[0], trace.time[0]), end)
    times = frame_times(begin, end, FRAMES_PER_SECOND[path.suffix])
    progress = tqdm(times, desc="filming", unit=" frames")
    write_video(frames(trace, spec.robot, progress, ground=spec.ground), path)
    caption = f"The learned parameters on seed {spec.seed}, from {begin:.1f} to {end:.1f} s of {result.duration:.1f} s"
    caption = f"{': '.join(filter(None, (caption, ', '.join(told_of(spec, trace)))))}."
    return _address(path.read_bytes(), kind), caption


def _commands(config: TrainingConfig) -> list[str]:
    again = f"{config.algo}-s{config.seed}-again"
    task = "" if config.task.file is None else f" --task {quoted(config.task.reference)}"
    extra = ["sarah-eval RUN --robustness --out tables"] if config.task is BALANCE else ["sarah-video RUN --out a.mp4"]
    commands = [f"sarah-train --config config.yaml --out {again}", "sarah-eval RUN", "sarah-figures RUN", *extra]
    return [command.replace("RUN", again) + task for command in [*commands, "sarah-report RUN"]]


def _address(content: bytes, kind: str) -> str:
    """Data address that contains its content."""
    return f"data:{kind};base64,{b64encode(content).decode()}"
