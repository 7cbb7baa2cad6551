"""``sarah-video``: an episode as MP4 or GIF."""

from __future__ import annotations

import dataclasses
import math
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from sarah.cli.episode_options import EpisodeOptions, parse_episode_options
from sarah.cli.former_names import with_out
from sarah.cli.next_steps import passed_on, say_next, to_open, to_see
from sarah.cli.options import as_command, named_task
from sarah.cli.subjects import check_played, episode_of, is_log
from sarah.episode.ending import ending_words
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import EpisodeSpec
from sarah.errors import ConfigurationError
from sarah.ranges import Within
from sarah.runs.run_episodes import RunEpisode

COMMAND = "sarah-video"
NOT_OF_VIEW = ("out", "seconds", "speed")
"""Options that the viewer has not."""


@dataclass(frozen=True)
class VideoOptions(EpisodeOptions):
    """Film an episode: the robot from its front, a close view of its feet, phase, steps per second, score and push.

    :param subject: run folder; numbers separated by commas, P1 to P5 for stepping, or V1 to V4 for the task balance;
        the name of shipped parameters: ``paper``, ``stepping`` or ``balance``; or a log, whose motion is estimated from
        its sensors
    :param out: file to write: MP4, which needs the extra ``video``, or GIF, which is smaller
    :param which: episode of a run folder: ``learned`` for the learned parameters, ``best``, or an index of its
        episodes.csv; by default ``learned``, or ``best`` if the training is not finished
    :param seed: seed of the episode, by which robot, sensors and push vary; by default the episode's own, or 0
    :param seconds: simulated times at which the video begins and ends, in s; by default the whole episode
    :param speed: speed of the video; 0.25 is four times slower than real time
    """

    subject: Annotated[
        str | None, tyro.conf.Positional, tyro.conf.arg(metavar="RUN|NUMBERS|NAME|LOG", help_behavior_hint="(required)")
    ] = None
    out: Annotated[Path | None, tyro.conf.arg(metavar="FILE", help_behavior_hint="(required)")] = None
    which: Annotated[str | None, tyro.conf.arg(metavar="learned|best|INDEX")] = None
    seed: int | None = None
    seconds: Annotated[tuple[float, float], tyro.conf.arg(metavar="BEGIN END")] = (0.0, math.inf)
    speed: Annotated[float, Within(0.01, 10.0)] = 1.0

    def __post_init__(self) -> None:
        """Refuse numbers outside their ranges."""
        super().__post_init__()
        if not self.seconds[0] < self.seconds[1]:
            raise ConfigurationError(f"seconds must be two times in rising order, not {self.seconds!r}")


@as_command(COMMAND)
def main() -> None:
    """Run the command with the arguments of the process."""
    arguments = with_out(COMMAND, sys.argv[1:], bare=1)
    options = parse_episode_options(COMMAND, arguments, VideoOptions())
    if options.subject is None or options.out is None:
        raise ConfigurationError("give a run folder, numbers or a name, and the file to write: --out FILE")
    from sarah.pictures.video import FRAMES_PER_SECOND, check_path, frame_times, frames, write_video
    from sarah.simulation.renderer import check_renderer

    check_path(options.out)
    spec, chosen = _spec(options, options.subject)
    from tqdm import tqdm

    from sarah.episode.episode import simulate

    if chosen.recorded is not None and is_log(options.subject):
        result = chosen.recorded()
    else:
        result = simulate(spec, record_trace=True)
    assert result.trace is not None
    first, last = result.trace.time[0], result.trace.time[-1]
    begin, end = max(options.seconds[0], first), min(options.seconds[1], last)
    if begin >= end:
        ending = ending_words(result.termination)
        raise ConfigurationError(
            f"nothing to film: the episode runs from {first:g} s, when it has stood, to {result.duration:g} s: {ending}"
        )
    if end < options.seconds[1] < math.inf:
        print(f"the episode ends at {result.duration:g} s: {ending_words(result.termination)}", file=sys.stderr)
    check_renderer()
    times = frame_times(begin, end, FRAMES_PER_SECOND[options.out.suffix], options.speed)
    progress = tqdm(times, desc="filming", unit=" frames")
    pictures = frames(result.trace, spec.robot, progress, _caption(spec, result, chosen), spec.ground)
    write_video(pictures, options.out)
    print(options.out)
    say_next(to_open(options.out), to_see(options.subject, *passed_on(arguments, options.subject, *NOT_OF_VIEW)))


def _spec(options: VideoOptions, subject: str) -> tuple[EpisodeSpec, RunEpisode]:
    """Specification of the episode to film, and what it was chosen as."""
    chosen = episode_of(subject, options.which, named_task(options.task))
    seed = chosen.spec.seed if options.seed is None else options.seed
    spec = dataclasses.replace(options.applied_to(chosen.spec), seed=seed)
    check_played(subject, chosen.spec, spec)
    return spec, chosen


def _caption(spec: EpisodeSpec, result: EpisodeResult, chosen: RunEpisode) -> str:
    """Lines about the filmed episode: its parameters and result, and what its pictures leave out."""
    from sarah.runs.episode_words import told_of

    names = spec.task.parameter_names
    learned = ", ".join(f"{name} {value:.2f}" for name, value in zip(names, spec.parameters, strict=True))
    if result.unknown:
        return f"{chosen.label}: {learned}\nmotion estimated from its sensors"
    ending = ending_words(result.termination)
    about = f"{spec.task.name}: {learned}\nseed {spec.seed}, score {result.score:.2f}, {ending}"
    assert result.trace is not None
    is_alone = chosen.recorded is None
    told = [*([] if is_alone else ["from standing, not as the window was"]), *told_of(spec, result.trace)]
    return "\n".join([about, ", ".join(told)] if told else [about])
