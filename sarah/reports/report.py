"""A run as one HTML page that needs nothing else: results beside the paper's, video, figures, settings and commands."""

from __future__ import annotations

import shlex
import tempfile
from base64 import b64encode
from collections.abc import Callable
from dataclasses import dataclass
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path

from jinja2 import Environment, StrictUndefined
from tqdm import tqdm

from sarah.control.pattern_generator import PAPER_PARAMETERS
from sarah.episode.episode import simulate
from sarah.episode.evaluation import Evaluation
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, STEPPING, TASKS
from sarah.episode.workers import Executor
from sarah.files import replace_text
from sarah.pictures.video import FRAMES_PER_SECOND, frame_times, frames, write_video
from sarah.reports.all_figures import draw_all_figures
from sarah.reports.training_figures import ALGORITHM_LABELS
from sarah.robot.description import describe_robot
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.training.recommendation import Parameters
from sarah.training.train import evaluate

TITLES = {STEPPING.name: "The First Training: stepping in place", BALANCE.name: "The Second Training: after a push"}
PAPER_SAYS = {
    "P1": "about 0.4",
    "P2": "1.3",
    "P3": "about 0.1",
    "P4": "hardly matters",
    "P5": "hardly matters",
    "V1": "matters more than V2 and V4",
    "V2": "a constant that may be needed",
    "V3": "matters more than V2 and V4",
    "V4": "a constant that may be needed",
}
"""Of the parameters. The paper gives V1 to V4 in no numbers."""
UNITS = {"P1": "rad/s", "P2": "m/s²", "P3": "rad/s", "V2": "m/s²"}
CAPTIONS = {
    "figure_4_reward_and_frequency": "Return and step frequency of every simulation (the paper's Figure 4)",
    "figure_5_parameters": "Parameters of every simulation (the paper's Figure 5); dotted: where the paper's settled",
    "figure_6_reward_and_position": "Return and final position of every simulation (the paper's Figure 6)",
    "figure_7_parameters": "Parameters of every simulation (the paper's Figure 7)",
    "gait_cycle_stepping": "One step with each leg, with the learned parameters",
    "gait_cycle_balance": "One step with each leg, with the learned parameters",
    "figure_3_pattern_generator": "The pattern generator (the paper's Figure 3), drawn from the code",
    "figure_2_robot": "The robot (the paper's Figure 2)",
}
"""Of each figure, in the order of the page."""


@dataclass(frozen=True)
class Row:
    """A line of the table of results.

    :param name: what is compared, with its unit
    :param learned: of the run
    :param rival: of what it is compared with
    :param paper: what the paper says of it
    """

    name: str
    learned: str
    rival: str
    paper: str = ""


def write_report(
    run: RunFolder, path: Path, executor: Executor, episodes: int = 10, seconds: tuple[float, float] = (1.0, 9.0)
) -> None:
    """Write the page.

    :param run: a finished training
    :param path: of the page
    :param executor: that simulates the episodes of the table
    :param episodes: unseen seeds that the table is of
    :param seconds: simulated time at which the video begins and ends
    :raises RunFolderError: if something in the run folder is missing or damaged
    """
    config, learned = run.config(), run.parameters()
    task = TASKS[config.task]
    rival = PAPER_PARAMETERS if task.neutral is None else task.neutral
    ours, theirs = (evaluate(parameters, config, range(episodes), executor) for parameters in (learned, rival))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        drawn = {file.stem: file for file in draw_all_figures([run], folder) if file.suffix == ".png"}
        figures = [
            (text, _address(drawn[stem].read_bytes(), "image/png")) for stem, text in CAPTIONS.items() if stem in drawn
        ]
        video = folder / ("episode.mp4" if find_spec("imageio_ffmpeg") else "episode.gif")
        caption = _film(EpisodeSpec(learned, 0, config.task, config.episode), video, seconds)
        is_mp4 = video.suffix == ".mp4"
        film = _address(video.read_bytes(), "video/mp4" if is_mp4 else "image/gif")
    page = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True).from_string(
        (files("sarah.reports") / "report.html").read_text(encoding="utf-8")
    )
    text = page.render(
        title=TITLES[config.task],
        run=str(run.path),
        config=config,
        algorithm=ALGORITHM_LABELS[config.algo],
        episodes=episodes,
        rows=_parameter_rows(config, learned, rival) + _result_rows(config, ours, theirs),
        rival="the paper's parameters, simulated here" if task.neutral is None else "without the hip law (V = 0)",
        warnings=_warnings(ours, None if task.neutral is None else theirs),
        figures=figures,
        film=film,
        is_mp4=is_mp4,
        film_caption=caption,
        settings=run.config_text(),
        settings_address=_address(run.config_text().encode(), "text/yaml"),
        commands=_commands(run, config),
        versions=run.versions(),
    )
    replace_text(path, text)


def _parameter_rows(config: TrainingConfig, learned: Parameters, rival: Parameters) -> list[Row]:
    names = TASKS[config.task].parameter_names
    return [
        Row(f"{name} ({UNITS[name]})" if name in UNITS else name, f"{ours:.2f}", f"{theirs:.2f}", PAPER_SAYS[name])
        for name, ours, theirs in zip(names, learned, rival, strict=True)
    ]


def _result_rows(config: TrainingConfig, learned: Evaluation, rival: Evaluation) -> list[Row]:
    is_pushed = config.task == BALANCE.name

    def row(name: str, text: Callable[[Evaluation], str], paper: str = "") -> Row:
        return Row(name, text(learned), text(rival), paper)

    return [
        row("score, median (1 is the ceiling)", lambda e: f"{e.score_median:.3f}", "reported as reward, no scale"),
        row("steps per second, median", lambda e: f"{e.steps_per_second_median:.2f}", "3 to 5, a human's"),
        row(
            f"episodes that lasted {config.episode.time_limit:g} s",
            lambda e: f"{round(e.survival_rate * e.episodes)} of {e.episodes}",
            "no share given" if is_pushed else "30 s ends a simulation that does well",
        ),
        row(
            "distance from the start at the end, median (cm)",
            lambda e: f"{100 * e.drift_median:.1f}",
            "returns to its initial position" if is_pushed else "below 25, or the simulation ends",
        ),
        row(
            "SHIFT, LIFT phases that sensors ended (%)",
            lambda e: f"{100 * e.event_driven_shift_mean:.0f}, {100 * e.event_driven_lift_mean:.0f}",
        ),
        row("clearance of the soles, mean (mm)", lambda e: f"{1000 * e.sole_clearance_mean:.0f}"),
        row("vibration above 20 Hz, median (m²/s⁴)", lambda e: f"{e.vibration_median:.1f}"),
        row("power of the actuators, mean (W)", lambda e: f"{e.actuator_power_mean:.0f}"),
    ]


def _warnings(learned: Evaluation, without: Evaluation | None) -> list[str]:
    found = []
    if not learned.is_gait:
        found.append("This is not a gait: it steps to a clock, or does not lift its feet.")
    if without is not None and learned.chatters(without):
        found.append("The hips chatter: no real robot could do that.")
    return found


def _film(spec: EpisodeSpec, path: Path, seconds: tuple[float, float]) -> str:
    """Film a part of an episode, and say in a line what there is to see."""
    result = simulate(spec, record_trace=True)
    trace = result.trace
    assert trace is not None
    end = min(seconds[1], trace.time[-1])
    begin = min(max(seconds[0], trace.time[0]), end)
    times = frame_times(begin, end, FRAMES_PER_SECOND[path.suffix])
    progress = tqdm(times, desc="filming", unit=" frames")
    write_video(frames(trace, describe_robot(spec.config.dimensions), progress), path)
    return f"The learned parameters on seed {spec.seed}, from {begin:.1f} to {end:.1f} s of {result.duration:.1f} s."


def _commands(run: RunFolder, config: TrainingConfig) -> list[str]:
    again = f"{config.algo}-s{config.seed}-again"
    extra = ["sarah-video RUN out.mp4"] if config.task == STEPPING.name else ["sarah-eval RUN --robustness tables"]
    commands = [f"sarah-train --config config.yaml --run-dir {again}", "sarah-eval RUN", "sarah-figures RUN", *extra]
    return [command.replace("RUN", shlex.quote(again)) for command in [*commands, "sarah-report RUN"]]


def _address(content: bytes, kind: str) -> str:
    """An address that holds what it leads to."""
    return f"data:{kind};base64,{b64encode(content).decode()}"
